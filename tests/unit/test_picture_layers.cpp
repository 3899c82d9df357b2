#include <doctest/doctest.h>

#include <string>
#include <vector>

#include "film/picture_layers.hpp"

using namespace vitrum;

namespace {

/// One pixel whose channels have the values 0, 1, 2, ... in the order of their names, in layers; as text, as in
/// "beauty=012 depth=3", with a '*' behind what is no colour.
std::string layers_of(const std::vector<std::string>& names) {
  PictureChannels picture{1, 1, true, names, {}};
  for (size_t i = 0; i < names.size(); ++i) picture.values.push_back(float(i));
  std::string text;
  for (const PictureLayer& layer : in_layers(picture).layers) {
    CHECK(layer.values.size() == size_t(layer.channels));
    text += (text.empty() ? "" : " ") + layer.name + "=";
    for (const float value : layer.values) text += std::to_string(int(value));
    if (!layer.is_colour) text += "*";
  }
  return text;
}

}  // namespace

TEST_CASE("channels are sorted into layers by their names") {
  CHECK(layers_of({"R", "G", "B"}) == "beauty=012");
  CHECK(layers_of({"B", "G", "R"}) == "beauty=210");  // the order of EXR files
  CHECK(layers_of({"R", "G", "B", "A"}) == "beauty=012 A=3*");
  CHECK(layers_of({"Y", "A"}) == "beauty=000 A=1*");
  CHECK(layers_of({"B", "G", "R", "albedo.B", "albedo.G", "albedo.R", "depth.Z", "normal.X", "normal.Y", "normal.Z"}) ==
        "beauty=210 albedo=543 depth=6* normal=789*");
  CHECK(layers_of({"caustics.R", "caustics.G", "caustics.B"}) == "caustics=012");
  CHECK(layers_of({"mask.Y"}) == "mask=0");
}

TEST_CASE("channels of other kernels") {
  CHECK(layers_of({"View.Combined.R", "View.Combined.G", "View.Combined.B", "View.Combined.A", "View.Depth.Z"}) ==
        "View.Combined=012 View.Combined.A=3* View.Depth=4*");
  CHECK(layers_of({"X", "Y", "Z"}) == "XYZ=012*");
  CHECK(layers_of({"R", "G"}) == "R=0* G=1*");
  CHECK(layers_of({"v.R", "v.G", "v.B", "v.X", "v.Y", "v.Z"}) == "v=012 v.X=3* v.Y=4 v.Z=5*");
  CHECK(layers_of({"R", "G", "B", "beauty.R", "beauty.G", "beauty.B"}) ==
        "beauty=012 beauty.R=3* beauty.G=4* beauty.B=5*");
  CHECK(layers_of({"channel 1", "", "."}) == "channel 1=0* =1* .=2*");
}
