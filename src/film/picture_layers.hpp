#pragma once
// Which channels of a file belong together. Pure functions.

#include <string>
#include <vector>

#include "film/images.hpp"

namespace vitrum {

/// All that a file holds, as it lies there.
struct PictureChannels {
  int width = 0, height = 0;
  bool is_float = false;                    ///< else integers, read as 0..1
  std::vector<std::string> names;           ///< of the channels: "R", "normal.X", ...
  std::vector<float> values;                ///< width * height * names.size(), interleaved, row 0 at the top
};

/// Sorts the channels into layers, as read_layers (images.hpp) says.
LayeredPicture in_layers(const PictureChannels& picture);

}  // namespace vitrum
