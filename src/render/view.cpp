#include "render/view.hpp"

#include <vector>

#include "core/error.hpp"
#include "core/suggest.hpp"

namespace vitrum {
namespace {

constexpr View all_views[] = {View::beauty, View::photons, View::caustics, View::albedo, View::normal,
                              View::depth,  View::error,   View::cut,      View::bias};

}  // namespace

const char* view_name(View view) {
  switch (view) {
    case View::beauty: return "beauty";
    case View::photons: return "photons";
    case View::caustics: return "caustics";
    case View::albedo: return "albedo";
    case View::normal: return "normal";
    case View::depth: return "depth";
    case View::error: return "error";
    case View::cut: return "cut";
    case View::bias: return "bias";
  }
  return "";
}

View view_of_name(const std::string& name) {
  for (View view : all_views)
    if (name == view_name(view)) return view;
  std::vector<std::string> names;
  for (View view : all_views) names.push_back(view_name(view));
  throw Error({"--view " + name}, "there is no such view", suggestion(name, names, "views"));
}

}  // namespace vitrum
