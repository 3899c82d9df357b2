#include "film/images.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <exception>
#include <filesystem>
#include <new>
#include <string_view>

#include "core/version.hpp"
#include "core/whole_file.hpp"
#include "film/exr_file.hpp"
#include "film/image_process.hpp"

namespace vitrum {
namespace {

using image_protocol::append_text;
using image_protocol::Status;

/// A picture, as RGB (Picture) or with all its channels (PictureChannels). Throws Error at `asked_by`.
template <typename Decoded>
Decoded decoded(const std::string& path, const SourceLocation& asked_by) {
  check_readable(path, asked_by);
  Decoded picture;
  ImageAnswer answer;
  try {
    answer = decode_picture(path, asked_by, picture);
  } catch (const std::bad_alloc&) {
    answer = {Status::too_large, "out of memory"};
  }
  if (answer.status == Status::ok) return picture;
  const std::string reason = answer.message.empty() ? "" : " (" + answer.message + ")";
  if (answer.status == Status::too_large) {
    throw Error(asked_by, "the picture '" + path + "' is too large" + reason,
                "use one of at most 2^28 pixels and 3 * 2^28 values");
  }
  if (answer.status == Status::not_a_picture) {
    throw Error(asked_by, "the file '" + path + "' is no picture that can be read" + reason,
                "use a PNG, JPEG, TIFF, EXR or another common picture");
  }
  throw Error(asked_by, "the picture '" + path + "' is damaged or cut short" + reason, "put a sound copy in its place");
}

struct Format {
  std::string extension;
  bool is_linear = false;      ///< floats, without the display transform
  bool takes_layers = false;
  bool takes_grey = true;      ///< else grey is spread over R, G, B
};

/// The format that the name asks for. Throws Error at {path}.
Format format_of(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return char(std::tolower(c)); });
  static const std::array<Format, 8> formats{{{"exr", true, true, true},
                                              {"hdr", true, false, false},
                                              {"png", false, false, true},
                                              {"jpg", false, false, true},
                                              {"jpeg", false, false, true},
                                              {"tif", false, false, true},
                                              {"tiff", false, false, true},
                                              {"bmp", false, false, true}}};
  for (const Format& format : formats) {
    if (extension == "." + format.extension) return format;
  }
  const std::string problem = extension.empty() ? "the name has no ending that tells the format of the picture"
                                                : "vitrum does not write pictures of the kind '" + extension + "'";
  throw Error({path}, problem, "let the name end in .exr, .hdr, .png, .jpg, .tif or .bmp");
}

/// Names that viewers of EXR understand: RGB for colours, XYZ for vectors, Z for the depth.
std::vector<std::string> channel_names(const PictureLayer& layer) {
  const bool is_beauty = layer.name.empty() || layer.name == "beauty";
  const std::string prefix = is_beauty ? "" : layer.name + ".";
  if (layer.channels == 3 && layer.is_colour) return {prefix + "R", prefix + "G", prefix + "B"};
  if (layer.channels == 3) return {prefix + "X", prefix + "Y", prefix + "Z"};
  if (layer.is_colour) return {prefix + "Y"};
  return {prefix + (layer.name == "depth" ? "Z" : "X")};
}

/// The layers' values side by side, as a file has them.
struct Channels {
  std::vector<std::string> names;
  std::vector<float> values;
};

Channels interleaved(const std::vector<PictureLayer>& layers, size_t pixels) {
  Channels all;
  for (const PictureLayer& layer : layers) {
    for (std::string& name : channel_names(layer)) all.names.push_back(std::move(name));
  }
  all.values.resize(pixels * all.names.size());
  size_t offset = 0;
  for (const PictureLayer& layer : layers) {
    const size_t count = size_t(layer.channels);
    for (size_t i = 0; i < pixels; ++i) {
      std::copy_n(&layer.values[i * count], count, &all.values[i * all.names.size() + offset]);
    }
    offset += count;
  }
  return all;
}

/// The layer as a screen is to show it.
PictureLayer for_display(PictureLayer layer, const DisplaySettings& display) {
  if (layer.is_colour) {
    display_in_place(layer.values, layer.channels, display);
  } else {
    show_data_in_place(layer.values, layer.channels);
  }
  return layer;
}

PictureLayer spread_grey(PictureLayer layer) {
  if (layer.channels == 3) return layer;
  std::vector<float> grey = std::move(layer.values);
  layer.values.clear();
  for (const float value : grey) layer.values.insert(layer.values.end(), 3, value);
  layer.channels = 3;
  return layer;
}

/// The only layer of a format without layers, by the plain names of colours.
PictureLayer alone(PictureLayer layer) {
  layer.name.clear();
  layer.is_colour = true;
  return layer;
}

/// What a file of that format is to hold.
Channels file_channels(const Format& format, const std::vector<PictureLayer>& layers, const DisplaySettings& display,
                       size_t pixels) {
  if (format.takes_layers) return interleaved(layers, pixels);
  PictureLayer layer = format.is_linear ? layers.front() : for_display(layers.front(), display);
  if (!format.takes_grey) layer = spread_grey(std::move(layer));
  layer = alone(std::move(layer));
  return {channel_names(layer), std::move(layer.values)};
}

}  // namespace

void check_readable(const std::string& path, const SourceLocation& asked_by) {
  const std::string picture = "the picture '" + path + "' ";
  // Without O_NONBLOCK, opening a FIFO waits for a writer.
  const int descriptor = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (descriptor < 0) {
    if (errno == ENOENT) throw Error(asked_by, picture + "does not exist", "check the name, or put the file there");
    throw Error(asked_by, picture + "cannot be opened: " + std::strerror(errno), "check its name and permissions");
  }
  struct stat status {};
  std::array<char, 64> start{};
  const bool has_status = ::fstat(descriptor, &status) == 0;
  const bool is_file = has_status && S_ISREG(status.st_mode);
  const ssize_t length = is_file ? ::read(descriptor, start.data(), start.size()) : 0;
  ::close(descriptor);
  if (has_status && S_ISDIR(status.st_mode)) throw Error(asked_by, picture + "is a folder", "name a file");
  if (!is_file) throw Error(asked_by, picture + "is not an ordinary file", "name a file");
  if (length <= 0) throw Error(asked_by, picture + "is empty", "put a picture in its place");
  if (std::string_view(start.data(), size_t(length)).starts_with("version https://git-lfs")) {
    throw Error(asked_by, picture + "is not here: the file is a pointer of Git LFS", "fetch it with 'git lfs pull'");
  }
}

Picture read_picture(const std::string& path, const SourceLocation& asked_by) {
  return decoded<Picture>(path, asked_by);
}

LayeredPicture read_layers(const std::string& path, const SourceLocation& asked_by) {
  return in_layers(decoded<PictureChannels>(path, asked_by));
}

bool takes_image_process(const std::string& path) { return !format_of(path).takes_layers; }

void check_writable(const std::string& path) {
  format_of(path);
  check_whole_file(path);
}

std::string picture_file(const std::string& path, int width, int height, const std::vector<PictureLayer>& layers,
                         const DisplaySettings& display, const std::map<std::string, std::string>& metadata) {
  assert(width > 0 && height > 0 && !layers.empty());
  const size_t pixels = size_t(width) * size_t(height);
  for ([[maybe_unused]] const PictureLayer& layer : layers) {
    assert((layer.channels == 1 || layer.channels == 3) && layer.values.size() == pixels * size_t(layer.channels));
  }
  const Format format = format_of(path);
  const Channels channels = file_channels(format, layers, display, pixels);
  if (format.takes_layers) {
    std::map<std::string, std::string> header{{"Software", std::string("vitrum ") + version()}};
    for (const auto& [key, value] : metadata) header["vitrum:" + key] = value;
    try {
      return exr_file(width, height, channels.names, channels.values, header);
    } catch (const std::exception& error) {
      throw Error({path}, std::string("the picture cannot be encoded: ") + error.what(), "choose another format, or free memory");
    }
  }

  std::string texts;
  append_text(texts, format.extension);
  append_text(texts, std::string("vitrum ") + version());
  for (const std::string& name : channels.names) append_text(texts, name);
  for (const auto& [key, value] : metadata) {
    append_text(texts, key);
    append_text(texts, value);
  }
  image_protocol::EncodeRequest request{};
  request.width = width;
  request.height = height;
  request.channels = int(channels.names.size());
  request.is_float = format.is_linear;
  request.is_srgb = !format.is_linear && display.srgb && layers.front().is_colour;
  request.texts_bytes = uint32_t(texts.size());
  std::string file;
  const ImageAnswer answer = encode_picture(path, request, texts, channels.values, file);
  if (answer.status != Status::ok) {
    throw Error({path}, "the picture cannot be encoded: " + answer.message, "choose another format");
  }
  return file;
}

void write_picture(const std::string& path, int width, int height, const std::vector<PictureLayer>& layers,
                   const DisplaySettings& display, const std::map<std::string, std::string>& metadata) {
  write_whole_file(path, picture_file(path, width, height, layers, display, metadata));
}

}  // namespace vitrum
