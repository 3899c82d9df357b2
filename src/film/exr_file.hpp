#pragma once
// OpenEXR files, written by OpenEXR itself: the process for pictures (image_process.hpp) takes longer to start than a small
// picture takes to render.

#include <map>
#include <span>
#include <string>
#include <vector>

namespace vitrum {

/// An EXR file of 32-bit floats, compressed without loss. `values`: those of each pixel by `channels`, row 0 at the top.
/// `texts` are attributes of its header. The same input gives the same bytes. Throws std::exception.
std::string exr_file(int width, int height, const std::vector<std::string>& channels, std::span<const float> values,
                     const std::map<std::string, std::string>& texts);

}  // namespace vitrum
