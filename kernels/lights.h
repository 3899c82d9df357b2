// Lights: places on them and what they send out there. Photons and shadow rays start from the same description.
#ifndef VITRUM_LIGHTS_H
#define VITRUM_LIGHTS_H

#include "sampler.h"
#include "scene.h"

typedef struct {
  Vec3 x, y;                   // unit vectors across the axis
} Frame;

// Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
FUNCTION Frame frame_around(const Vec3 z) {
  const Float sign = z.z >= 0.0f ? (Float)1.0f : (Float)-1.0f;
  const Float a = -1.0f / (sign + z.z);
  const Float b = z.x * z.y * a;
  Frame frame;
  frame.x = make_vec3(fma(sign * z.x, z.x * a, (Float)1.0f), sign * b, -sign * z.x);
  frame.y = make_vec3(b, fma(z.y, z.y * a, sign), -z.y);
  return frame;
}

FUNCTION Vec3 in_frame(const Frame frame, const Vec3 axis, Float x, Float y, Float along) {
  return along3(along3(scale3(x, frame.x), y, frame.y), along, axis);
}

typedef struct {
  Vec3 position;               // [m]
  Vec3 normal;                 // unit length; directional: the way the light travels; point: any
  Vec3 emitted;                // intensity [W/sr], irradiance [W/m2] or radiance [W/(m2 sr)], by the kind of light
  Float area;                  // 1 / density of the place on the light [m2]; 1 for lights that have none
} LightPoint;

// A place on the light, uniform by area, of a mesh on the face given. u, v in [0,1).
FUNCTION LightPoint point_on_light(const Scene scene, __global const LightData* light, Float u, Float v, Uint face) {
  LightPoint p;
  p.position = uniform3(light->position);
  p.normal = uniform3(light->normal);
  p.emitted = uniform3(light->emitted);
  p.area = light->area;
#if LIGHT_KINDS & (1 << LIGHT_QUAD)
  if (light->kind == LIGHT_QUAD) p.position = along3(along3(p.position, u, uniform3(light->u)), v, uniform3(light->v));
#endif
#if LIGHT_KINDS & (1 << LIGHT_DISC)
  if (light->kind == LIGHT_DISC) {
    Float s, c;
    sin_cos_turn(v, &s, &c);
    const Float r = sqrt(u);
    p.position = along3(along3(p.position, r * c, uniform3(light->u)), r * s, uniform3(light->v));
  }
#endif
#if LIGHT_KINDS & (1 << LIGHT_SPHERE)
  if (light->kind == LIGHT_SPHERE) {
    Float s, c;
    sin_cos_turn(v, &s, &c);
    const Float one_minus_cos = 2.0f * u;
    const Float r = sqrt(one_minus_cos * (2.0f - one_minus_cos));
    p.normal = make_vec3(r * c, r * s, 1.0f - one_minus_cos);
    p.position = along3(p.position, light->radius, p.normal);
  }
#endif
#if LIGHT_KINDS & (1 << LIGHT_MESH)
  if (light->kind == LIGHT_MESH) {
    __global const LightFace* faces = scene.faces + light->first_face;
    const Uint triangle = FIELD(Uint, uint, faces, triangle, face);
    const Uint ia = 3 * FIELD(Uint, uint, scene.triangles, position[0], triangle);
    const Uint ib = 3 * FIELD(Uint, uint, scene.triangles, position[1], triangle);
    const Uint ic = 3 * FIELD(Uint, uint, scene.triangles, position[2], triangle);
    const Vec3 a = GATHER3(scene.positions, ia);
    const Vec3 ab = subtract3(GATHER3(scene.positions, ib), a);
    const Vec3 ac = subtract3(GATHER3(scene.positions, ic), a);
    const Float root = sqrt(u);
    p.position = along3(along3(a, root * (1.0f - v), ab), root * v, ac);
    const Vec3 normal = cross3(ab, ac);
    const Float twice_area = length3(normal);
    p.normal = scale3(1.0f / twice_area, normal);
    p.emitted = FIELD3(faces, radiance, face);
    p.area = 0.5f * twice_area / FIELD(Float, float, faces, selection, face);
  }
#endif
  return p;
}

// A face of a mesh light, by area times radiance: Walker's alias table, the place within the slot decides between the
// slot's own face and its alias. 0 for other lights.
FUNCTION Uint face_of_light(const Scene scene, __global const LightData* light, Float u) {
#if LIGHT_KINDS & (1 << LIGHT_MESH)
  if (light->kind == LIGHT_MESH) {
    __global const LightFace* faces = scene.faces + light->first_face;
    const Float place = u * (float)light->face_count;
    const Int last = (int)light->face_count - 1;
    const Int raw = TO_INT(place);
    const Int slot = raw > last ? last : raw;
    const Mask stays = place - TO_FLOAT(slot) < FIELD(Float, float, faces, probability, AS_UINT(slot));
    return stays ? AS_UINT(slot) : FIELD(Uint, uint, faces, alias, AS_UINT(slot));
  }
#endif
  return (Uint)0;
}

#endif
