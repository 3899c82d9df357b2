// The scene's buffers as kernels take them: one list of parameters, one struct. What the scene lacks is not there.
//
// A kernel lists `SCENE_PARAMETERS` first and starts with `const Scene scene = SCENE;`. The host sets the arguments in
// the same order (src/device/device_scene.cpp).
#ifndef VITRUM_SCENE_H
#define VITRUM_SCENE_H

#include "switches.h"
#include "fresnel.cl"
#include "types.h"
#if HAS_MESH
#include "tree_types.h"
#endif

typedef struct {
  __global const SphereData* spheres;
  __global const FlatData* flats;
  __global const MaterialData* materials;
  __global const MediumData* media;
  __global const InterfaceData* interfaces;  // [from * n_media + into]
  __global const LightData* lights;
  uint n_spheres, n_flats, n_media;
#if HAS_MESH
  __global const TreeNode* nodes;
  __global const TreeLeaf* leaves;
  __global const BodyData* bodies;
  __global const TriangleData* triangles;
  __global const float* positions;
  __global const float* normals;
  __global const float* texcoords;
  __global const uint* normal_corners;       // of meshes that have normals, 3 a triangle; NO_INDEX in the first: flat
  __global const uint* texcoord_corners;     // of those that have texture coordinates; NO_INDEX in the first: none
  __global const LightFace* faces;
#endif
#if HAS_TEXTURES
  __global const TextureData* textures;
  __global const float* texels;
#endif
} Scene;

#if HAS_MESH
#define MESH_PARAMETERS                                                                                              \
  , __global const TreeNode *nodes, __global const TreeLeaf *leaves, __global const BodyData *bodies,                \
      __global const TriangleData *triangles, __global const float *positions, __global const float *normals,        \
      __global const float *texcoords, __global const uint *normal_corners, __global const uint *texcoord_corners,   \
      __global const LightFace *faces
#define MESH_MEMBERS                                                                                                 \
  , nodes, leaves, bodies, triangles, positions, normals, texcoords, normal_corners, texcoord_corners, faces
#else
#define MESH_PARAMETERS
#define MESH_MEMBERS
#endif

#if HAS_TEXTURES
#define TEXTURE_PARAMETERS , __global const TextureData *textures, __global const float *texels
#define TEXTURE_MEMBERS , textures, texels
#else
#define TEXTURE_PARAMETERS
#define TEXTURE_MEMBERS
#endif

#define SCENE_PARAMETERS                                                                                             \
  __global const SphereData *spheres, __global const FlatData *flats, __global const MaterialData *materials,        \
      __global const MediumData *media, __global const InterfaceData *interfaces, __global const LightData *lights,  \
      const uint n_spheres, const uint n_flats, const uint n_media MESH_PARAMETERS TEXTURE_PARAMETERS
#define SCENE                                                                                                        \
  {                                                                                                                  \
    spheres, flats, materials, media, interfaces, lights, n_spheres, n_flats, n_media MESH_MEMBERS TEXTURE_MEMBERS   \
  }

// The same vector in every lane.
FUNCTION Vec3 uniform3(__global const float* values) { return make_vec3(values[0], values[1], values[2]); }

#endif
