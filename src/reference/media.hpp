#pragma once
// The media that a ray is in, and which of them fills the place (Schmidt and Budge, "Simple Nested Dielectrics in Ray
// Traced Images", 2002).

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <vector>

#include "scene/scene.hpp"

namespace vitrum::reference {

/// Materials of the bodies that contain a place, once for each body, in the order they were entered. Empty: vacuum.
using Media = std::vector<uint32_t>;

/// The one that fills the place: of the highest priority, of equal ones the one entered last, so that a body inside of
/// another needs no priority. `none` for vacuum.
inline uint32_t filling(const Scene& scene, const Media& media) {
  uint32_t best = none;
  for (const uint32_t medium : media)
    if (best == none || scene.materials[medium].priority >= scene.materials[best].priority) best = medium;
  return best;
}

/// A ray's way into a body of glass, or out of it.
struct Passage {
  uint32_t material = none;
  bool entering = true;
};

/// What a ray finds at a place where it passes surfaces of glass: one interface from medium `from` to `to` (none at all
/// where both are the same), behind which it is in `after`.
struct Crossing {
  uint32_t from = none, to = none;
  Media after;
};

/// Crosses everything that lies at one place, so that bodies that touch share one interface. Leaving a body that was
/// never entered (an open sheet, seen from below) counts as if it had been.
inline Crossing crossing(const Scene& scene, Media before, const std::vector<Passage>& passages) {
  Media after = before;
  for (const Passage& passage : passages)
    if (passage.entering) after.push_back(passage.material);
  for (const Passage& passage : passages) {
    if (passage.entering) continue;
    if (const auto last = std::find(after.rbegin(), after.rend(), passage.material); last != after.rend())
      after.erase(std::next(last).base());
    else
      before.push_back(passage.material);
  }
  return {filling(scene, before), filling(scene, after), std::move(after)};
}

inline double index_of(const Scene& scene, uint32_t medium) {
  return medium == none ? 1.0 : scene.materials[medium].index.value;
}

inline Spectrum absorption_of(const Scene& scene, uint32_t medium) {
  return medium == none ? Spectrum(0.0) : scene.materials[medium].absorption;
}

}  // namespace vitrum::reference
