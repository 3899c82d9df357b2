#pragma once
// Decodes and encodes pictures by OpenImageIO. No exception leaves it.

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "film/vitrum_images/protocol.hpp"

namespace vitrum::image_protocol {

struct Outcome {
  Status status = Status::ok;
  std::string message;  ///< one line in OpenImageIO's words; "" if it has none
};

/// Takes what will be decoded, and the names of its channels.
using TakeContents = std::function<void(const PictureContents&, const std::vector<std::string>&)>;

/// Decodes the file at `path`, or its first picture if it has several. The contents go to `take_contents` before any
/// pixel is read, then the values of the rows from the top to `take_rows`, some rows at a time.
Outcome decode(const std::string& path, const DecodeRequest& request, const TakeContents& take_contents,
               const std::function<void(std::span<const float>)>& take_rows);

/// Encodes a picture in memory, as `file`. `texts` are those that EncodeRequest lists. `give_rows` fills in the values
/// of the next rows. The same picture gives the same bytes.
Outcome encode(const EncodeRequest& request, const std::vector<std::string>& texts,
               const std::function<void(std::span<float>)>& give_rows, std::vector<unsigned char>& file);

}  // namespace vitrum::image_protocol
