#pragma once
// What a picture may show.

#include <string>

namespace vitrum {

/// What a picture shows.
enum class View {
  beauty,
  photons,                      ///< the photon map as white dots
  caustics,                     ///< what of the beauty the photon map gives
  albedo, normal, depth,        ///< of what the eye meets first
  error,                        ///< standard error of each value of the beauty, from the scatter of the replicates
  cut,                          ///< radiance that the limits of depth and weight took, at most (radiance_limit.hpp)
  bias,                         ///< by how much the radius of the photon estimate makes the caustics too bright
};

/// Name of a view, as after --view; and the view of a name. The latter throws Error for a name that is none.
const char* view_name(View view);
View view_of_name(const std::string& name);

}  // namespace vitrum
