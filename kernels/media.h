// The media that a ray is in: a stack of four, packed into one uint, lowest byte the one that fills the place.
//
// Where media overlap, the one with the highest priority fills the place (Schmidt and Budge, "Simple Nested Dielectrics
// in Ray Traced Images", 2002); among equals the one entered last. The stack is kept sorted, so its lowest byte decides.
// Byte values are indices into the table of media; 0 is the outside. A fifth medium pushes out the lowest.
#ifndef VITRUM_MEDIA_H
#define VITRUM_MEDIA_H

#include "scene.h"

FUNCTION uint top_medium(const uint stack) { return stack & 0xffu; }

FUNCTION uint entered(const Scene scene, const uint stack, const uint medium) {
#if HAS_MEDIA_STACK
  uint shift = 0;
  while (shift < 24) {
    const uint other = (stack >> shift) & 0xffu;
    if (other == 0 || scene.media[other].priority <= scene.media[medium].priority) break;
    shift += 8;
  }
  const uint below = (1u << shift) - 1u;
  return (stack & below) | (medium << shift) | ((stack & ~below) << 8);
#else
  return medium;
#endif
}

// Takes the topmost entry of `medium` out; a medium that was never entered leaves the stack as it is.
FUNCTION uint left(const uint stack, const uint medium) {
#if HAS_MEDIA_STACK
  for (uint shift = 0; shift < 32; shift += 8) {
    if (((stack >> shift) & 0xffu) != medium) continue;
    const uint below = (1u << shift) - 1u;
    const uint above = shift == 24 ? 0u : (stack >> (shift + 8u)) << shift;
    return (stack & below) | above;
  }
  return stack;
#else
  return 0;
#endif
}

// What a ray meets at the border of a medium.
typedef struct {
  uint before, after;          // stacks
  uint from, into;             // the media that fill the place on either side; equal: no border is felt
} Crossing;

FUNCTION Crossing crossing(const Scene scene, const uint stack, const uint medium, const int entering) {
  Crossing c;
  // A ray that leaves what it never entered has been inside all along: a light or an eye in an unnoticed place.
#if HAS_MEDIA_STACK
  c.before = entering || left(stack, medium) != stack ? stack : entered(scene, stack, medium);
#else
  c.before = entering ? 0u : medium;
#endif
  c.after = entering ? entered(scene, c.before, medium) : left(c.before, medium);
  c.from = top_medium(c.before);
  c.into = top_medium(c.after);
  return c;
}

// The one transmittance of camera rays and photons: what is left after `distance` in the medium that fills the place.
FUNCTION Vec3 media_transmittance(const Scene scene, const uint stack, const Float free_path) {
  __global const float* sigma_a = scene.media[top_medium(stack)].sigma_a;
  // A ray that meets nothing goes far, but 0 times infinity is no number.
  const Float distance = smaller(free_path, 3e38f);
  return make_vec3(transmittance(sigma_a[0], distance), transmittance(sigma_a[1], distance),
                   transmittance(sigma_a[2], distance));
}

// What is left and what is taken after `distance`.
FUNCTION void media_attenuation(const Scene scene, const uint stack, const Float distance, Vec3* left_over, Vec3* taken) {
  __global const float* sigma_a = scene.media[top_medium(stack)].sigma_a;
  const Attenuation red = attenuation(sigma_a[0], distance);
  const Attenuation green = attenuation(sigma_a[1], distance);
  const Attenuation blue = attenuation(sigma_a[2], distance);
  *left_over = make_vec3(red.left, green.left, blue.left);
  *taken = make_vec3(red.taken, green.taken, blue.taken);
}

#endif
