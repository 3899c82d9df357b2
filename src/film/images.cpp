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
#include <filesystem>
#include <new>
#include <string_view>

#include "core/version.hpp"
#include "core/whole_file.hpp"
#include "film/image_module.hpp"
#include "film/picture_layers.hpp"

namespace vitrum {
namespace {

constexpr uint64_t max_pixels = uint64_t(1) << 28, max_values = 3 * max_pixels;

static_assert(sizeof(glm::vec3) == 3 * sizeof(float), "pixels are handed over as floats");

// ---------------------------------------------------------------------------------------------- reading

/// Refuses what is no ordinary file with something in it, before anything waits for it or reads it without end.
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

/// Makes room for a picture of that size; for the C interface, so without exceptions.
float* allocate_picture(void* user, int width, int height) {
  auto& picture = *static_cast<Picture*>(user);
  try {
    picture.pixels.resize(size_t(width) * size_t(height));
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
  picture.width = width;
  picture.height = height;
  return &picture.pixels.data()->x;
}

/// Throws the Error for a file that the module has not read.
[[noreturn]] void refuse(VitrumImageStatus status, const VitrumImageMessage& message, const std::string& path,
                         const SourceLocation& asked_by) {
  const std::string reason = message.text[0] ? std::string(" (") + message.text + ")" : "";
  if (status == VITRUM_IMAGE_TOO_LARGE) {
    throw Error(asked_by, "the picture '" + path + "' is too large" + reason, "use one of at most 2^28 pixels");
  }
  if (status == VITRUM_IMAGE_NOT_A_PICTURE) {
    throw Error(asked_by, "the file '" + path + "' is no picture that can be read" + reason,
                "use a PNG, JPEG, TIFF, EXR or another common picture");
  }
  throw Error(asked_by, "the picture '" + path + "' is damaged or cut short" + reason, "put a sound copy in its place");
}

/// Makes room for all that a file holds; for the C interface, so without exceptions.
float* allocate_channels(void* user, const VitrumImageContents* contents) {
  auto& picture = *static_cast<PictureChannels*>(user);
  try {
    picture.names.assign(contents->channel_names, contents->channel_names + contents->channels);
    picture.values.resize(size_t(contents->width) * size_t(contents->height) * size_t(contents->channels));
  } catch (const std::bad_alloc&) {
    return nullptr;
  }
  picture.width = contents->width;
  picture.height = contents->height;
  picture.is_float = contents->is_float != 0;
  return picture.values.data();
}

// ---------------------------------------------------------------------------------------------- writing

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
  return interleaved({alone(std::move(layer))}, pixels);
}

std::vector<const char*> pointers(const std::vector<std::string>& texts) {
  std::vector<const char*> all;
  for (const std::string& text : texts) all.push_back(text.c_str());
  return all;
}

int take_bytes(void* user, const void* bytes, size_t size) {
  try {
    static_cast<std::string*>(user)->assign(static_cast<const char*>(bytes), size);
  } catch (const std::bad_alloc&) {
    return 0;
  }
  return 1;
}

/// The bytes of a file in memory. Throws Error at {path}.
std::string encoded(const std::string& path, const VitrumImageToEncode& image) {
  std::string bytes;
  VitrumImageMessage message{};
  if (image_module({path}).encode(&image, take_bytes, &bytes, &message) != VITRUM_IMAGE_OK) {
    throw Error({path}, std::string("the picture cannot be encoded: ") + message.text, "choose another format");
  }
  return bytes;
}

}  // namespace

Picture read_picture(const std::string& path, const SourceLocation& asked_by) {
  check_readable(path, asked_by);
  Picture picture;
  VitrumImageMessage message{};
  const auto status = image_module(asked_by).read(path.c_str(), max_pixels, allocate_picture, &picture, &message);
  if (status != VITRUM_IMAGE_OK) refuse(status, message, path, asked_by);
  return picture;
}

LayeredPicture read_layers(const std::string& path, const SourceLocation& asked_by) {
  check_readable(path, asked_by);
  PictureChannels channels;
  VitrumImageMessage message{};
  const auto status = image_module(asked_by).read_channels(path.c_str(), max_pixels, max_values, allocate_channels,
                                                           &channels, &message);
  if (status != VITRUM_IMAGE_OK) refuse(status, message, path, asked_by);
  return in_layers(channels);
}

void check_writable(const std::string& path) {
  format_of(path);
  check_whole_file(path);
}

void write_picture(const std::string& path, int width, int height, const std::vector<PictureLayer>& layers,
                   const DisplaySettings& display, const std::map<std::string, std::string>& metadata) {
  assert(width > 0 && height > 0 && !layers.empty());
  const size_t pixels = size_t(width) * size_t(height);
  for ([[maybe_unused]] const PictureLayer& layer : layers) {
    assert((layer.channels == 1 || layer.channels == 3) && layer.values.size() == pixels * size_t(layer.channels));
  }
  const Format format = format_of(path);
  const Channels channels = file_channels(format, layers, display, pixels);

  std::vector<std::string> keys, values;
  for (const auto& [key, value] : metadata) {
    keys.push_back(key);
    values.push_back(value);
  }
  const std::string software = std::string("vitrum ") + version();
  const auto names = pointers(channels.names), key_pointers = pointers(keys), value_pointers = pointers(values);
  VitrumImageToEncode image{};
  image.extension = format.extension.c_str();
  image.width = width;
  image.height = height;
  image.channels = int(names.size());
  image.channel_names = names.data();
  image.values = channels.values.data();
  image.is_float = format.is_linear;
  image.is_srgb = !format.is_linear && display.srgb && layers.front().is_colour;
  image.software = software.c_str();
  image.metadata_count = int(metadata.size());
  image.metadata_keys = key_pointers.data();
  image.metadata_values = value_pointers.data();
  write_whole_file(path, encoded(path, image));
}

}  // namespace vitrum
