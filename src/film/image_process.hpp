#pragma once
// The process for pictures (the program vitrum_images), as the rest of vitrum sees it. It reads them all, and writes all
// but EXR (exr_file.hpp). OpenImageIO lives there since it loads some 260 libraries, for .2 s under the dynamic loader's lock,
// which would keep the OpenCL driver from loading kernels; and since a picture that crashes its reader then costs an error
// message, not vitrum.
//
// The process is started once, ends with vitrum at the latest, and answers one request at a time. One that has been
// ended while it had nothing to do is replaced.

#include <span>
#include <string>
#include <string_view>

#include "core/error.hpp"
#include "film/images.hpp"
#include "film/picture_layers.hpp"
#include "film/vitrum_images/protocol.hpp"

namespace vitrum {

struct ImageAnswer {
  image_protocol::Status status = image_protocol::Status::ok;
  std::string message;  ///< one line of why it failed, or ""
};

/// Decodes the file at `path` into `picture`, as RGB or with all its channels, unless it has more than 2^28 pixels, or
/// that would be more than 3 * 2^28 values. Thread-safe.
/// Throws Error at `asked_by` if there is no process, or if it ends meanwhile; std::bad_alloc if there is no room.
ImageAnswer decode_picture(const std::string& path, const SourceLocation& asked_by, Picture& picture);
ImageAnswer decode_picture(const std::string& path, const SourceLocation& asked_by, PictureChannels& picture);

/// Encodes a picture as `file`; `texts` and `values` are those that image_protocol::EncodeRequest lists. Thread-safe.
/// Throws Error at {path} if there is no process, or if it ends meanwhile.
ImageAnswer encode_picture(const std::string& path, const image_protocol::EncodeRequest& request,
                           std::string_view texts, std::span<const float> values, std::string& file);

}  // namespace vitrum
