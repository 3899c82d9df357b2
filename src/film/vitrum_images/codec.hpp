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

/// Decodes the file at `path` as RGB; grey is spread. The size goes to `take_size` before any pixel is read, then the
/// rows from the top to `take_rows`, some at a time, 3 * width floats each. Refuses pictures of more than `max_pixels`.
Outcome decode(const std::string& path, uint64_t max_pixels, const std::function<void(PictureSize)>& take_size,
               const std::function<void(std::span<const float>)>& take_rows);

/// Encodes a picture in memory, as `file`. `texts` are those that EncodeRequest lists. `give_rows` fills in the values
/// of the next rows. The same picture gives the same bytes.
Outcome encode(const EncodeRequest& request, const std::vector<std::string>& texts,
               const std::function<void(std::span<float>)>& give_rows, std::vector<unsigned char>& file);

}  // namespace vitrum::image_protocol
