// Stage photon_emit: fills a queue with photons of one pair of light and caster.
// Reads: the scene's lights, the casters, the sequences. Writes: queue rays [0, count), outcomes.
// After: every photon is alive, has met no surface, and carries its power.
#include "emission.h"
#include "outcome.h"

__kernel void photon_emit(SCENE_PARAMETERS, __global const CasterData* casters, const uint n_casters,
                          __global const SequenceData* sequences, const uint light_index, const uint caster,
                          const float share, const float upstream, const uint count, const uint stride,
                          __global float* rays, __global uint* outcomes) {
  const uint i = get_global_id(0) * WIDTH;
  if (i >= count) return;
  const Scene scene = SCENE;
  __global const LightData* light = &scene.lights[light_index];
  const Uint index = LANES + i;

  Float u[4];
  u[0] = sequence_float(&sequences[0], index);
  u[1] = sequence_float(&sequences[1], index);
  u[2] = 0.0f;
  u[3] = 0.0f;
  Uint face = 0;
#if LIGHT_KINDS & ~((1 << LIGHT_POINT) | (1 << LIGHT_DIRECTIONAL))
  u[2] = sequence_float(&sequences[3], index);
  u[3] = sequence_float(&sequences[4], index);
  face = face_of_light(scene, light, sequence_float(&sequences[5], index));
#endif
  const Emission photon = emit(scene, light, casters, n_casters, caster, u, face, upstream);

  store3(rays, RAY_ORIGIN, stride, i, photon.origin);
  store3(rays, RAY_DIRECTION, stride, i, photon.direction);
  store1(rays, RAY_T_MIN, stride, i, light->clearance);
  store3(rays, RAY_WEIGHT, stride, i, scale3(share, photon.power));
  store_bits(rays, RAY_MEDIA, stride, i, light->media);
  store_bits(rays, RAY_FROM, stride, i, light->shape);
  store_bits(rays, RAY_PATH, stride, i, sequence_bits(&sequences[2], index));
  store_bits(rays, RAY_SLOT, stride, i, 0);
  STORE(outcomes, i, (Uint)OUTCOME_ALIVE);
}
