// The pinhole camera: from places in the picture to directions, and back.
#ifndef VITRUM_VIEW_H
#define VITRUM_VIEW_H

#include "scene.h"

// Of the ray from the eye through a place of the picture, in pixels from its upper left corner.
FUNCTION Vec3 direction_through(__global const CameraData* camera, const Float column, const Float row) {
  const Float x = fma(column, (Float)camera->step_x, (Float)camera->left);
  const Float y = fma(row, (Float)-camera->step_y, (Float)camera->top);
  return normalize3(along3(along3(uniform3(camera->forward), x, uniform3(camera->right)), y, uniform3(camera->up)));
}

// Where a place in space is seen.
typedef struct {
  Float x, y;                  // in the picture [pixels]
  Float depth;                 // along the camera's axis [m]; 0 or less: behind the eye
  Uint outside;                // bits: left of the view, right of it, above, below
  Mask clear;                  // well in front of the eye: not within .01 of a right angle to the axis
} Seen;

FUNCTION Seen seen_at(__global const CameraData* camera, const Vec3 place) {
  const Vec3 d = subtract3(place, uniform3(camera->eye));
  const Float right = dot3(d, uniform3(camera->right));
  const Float up = dot3(d, uniform3(camera->up));
  Seen s;
  s.depth = dot3(d, uniform3(camera->forward));
  const Float from_left = fma(-camera->left, s.depth, right);
  const Float from_top = fma(camera->top, s.depth, -up);
  const Float width = camera->step_x * (float)camera->width * s.depth;
  const Float height = camera->step_y * (float)camera->height * s.depth;
  s.outside = (from_left < 0.0f ? (Uint)1 : (Uint)0) | (from_left > width ? (Uint)2 : (Uint)0) |
              (from_top < 0.0f ? (Uint)4 : (Uint)0) | (from_top > height ? (Uint)8 : (Uint)0);
  s.clear = s.depth > 0.01f * largest3(d);
  const Float inverse = 1.0f / (s.clear ? s.depth : (Float)1.0f);
  s.x = from_left * inverse / camera->step_x;
  s.y = from_top * inverse / camera->step_y;
  return s;
}

#endif
