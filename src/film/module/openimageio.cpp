// The image module: OpenImageIO behind the C interface of image_module.h.

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstring>
#include <exception>
#include <memory>
#include <new>
#include <string>
#include <string_view>
#include <vector>

#include "film/module/image_module.h"

namespace {

void say(VitrumImageMessage* message, std::string_view text) {
  // One line: OpenImageIO joins several errors by line feeds, and the first one says most.
  text = text.substr(0, text.find('\n'));
  const size_t length = std::min(text.size(), sizeof message->text - 1);
  std::memcpy(message->text, text.data(), length);
  message->text[length] = '\0';
}

/// Runs `work` so that no exception leaves the module.
template <typename Work>
VitrumImageStatus guarded(VitrumImageStatus otherwise, VitrumImageMessage* message, Work work) {
  say(message, "");
  try {
    return work();
  } catch (const std::bad_alloc&) {
    say(message, "out of memory");
    return VITRUM_IMAGE_TOO_LARGE;
  } catch (const std::exception& error) {
    say(message, error.what());
    return otherwise;
  }
}

/// Which channels of a file are its colour.
struct ColourChannels {
  int first = 0;
  int count = 3;  ///< 3, or 1 for grey
};

ColourChannels colour_channels(const OIIO::ImageSpec& spec) {
  const auto& names = spec.channelnames;
  for (int i = 0; i + 2 < spec.nchannels && i + 2 < static_cast<int>(names.size()); ++i) {
    if (names[i] == "R" && names[i + 1] == "G" && names[i + 2] == "B") return {i, 3};
  }
  return {0, spec.nchannels >= 3 ? 3 : 1};
}

/// Opens the file at `path` as `input`, if it holds plain pixels, and not too many.
VitrumImageStatus open_file(const char* path, uint64_t max_pixels, std::unique_ptr<OIIO::ImageInput>& input,
                            VitrumImageMessage* message) {
  OIIO::ImageSpec wishes;
  wishes.attribute("oiio:UnassociatedAlpha", 1);  // colours as they are in the file, not multiplied by alpha
  input = OIIO::ImageInput::open(path, &wishes);
  if (!input) {
    say(message, OIIO::geterror());
    return VITRUM_IMAGE_NOT_A_PICTURE;
  }
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.deep) {
    say(message, "no plain two-dimensional pixels");
    return VITRUM_IMAGE_NOT_A_PICTURE;
  }
  if (static_cast<uint64_t>(spec.width) * static_cast<uint64_t>(spec.height) > max_pixels) {
    say(message, std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels");
    return VITRUM_IMAGE_TOO_LARGE;
  }
  return VITRUM_IMAGE_OK;
}

VitrumImageStatus read_file(const char* path, uint64_t max_pixels, VitrumImageAllocate allocate, void* user,
                            VitrumImageMessage* message) {
  std::unique_ptr<OIIO::ImageInput> input;
  const VitrumImageStatus status = open_file(path, max_pixels, input, message);
  if (status != VITRUM_IMAGE_OK) return status;
  const OIIO::ImageSpec& spec = input->spec();
  const size_t pixels = static_cast<size_t>(spec.width) * static_cast<size_t>(spec.height);
  float* const values = allocate(user, spec.width, spec.height);
  if (!values) {
    say(message, "out of memory");
    return VITRUM_IMAGE_TOO_LARGE;
  }
  const ColourChannels colour = colour_channels(spec);
  const bool is_read = input->read_image(0, 0, colour.first, colour.first + colour.count, OIIO::TypeDesc::FLOAT, values,
                                         3 * sizeof(float));
  // Readers of JPEG and TIFF fill in what a file cut short lacks, report success, and leave an error behind.
  if (!is_read || input->has_error()) {
    say(message, input->geterror());
    return VITRUM_IMAGE_DAMAGED;
  }
  if (colour.count == 1) {
    for (size_t i = 0; i < pixels; ++i) values[3 * i + 1] = values[3 * i + 2] = values[3 * i];
  }
  return VITRUM_IMAGE_OK;
}

VitrumImageStatus read_all_channels(const char* path, uint64_t max_pixels, uint64_t max_values,
                                    VitrumImageAllocateChannels allocate, void* user, VitrumImageMessage* message) {
  std::unique_ptr<OIIO::ImageInput> input;
  const VitrumImageStatus status = open_file(path, max_pixels, input, message);
  if (status != VITRUM_IMAGE_OK) return status;
  const OIIO::ImageSpec& spec = input->spec();
  const uint64_t values_of_pixel = static_cast<uint64_t>(spec.nchannels);
  if (static_cast<uint64_t>(spec.width) * static_cast<uint64_t>(spec.height) > max_values / values_of_pixel) {
    say(message, std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels of " +
                     std::to_string(spec.nchannels) + " channels");
    return VITRUM_IMAGE_TOO_LARGE;
  }
  std::vector<const char*> names;
  for (int i = 0; i < spec.nchannels; ++i) names.push_back(spec.channelnames.at(static_cast<size_t>(i)).c_str());
  const VitrumImageContents contents{spec.width, spec.height, spec.nchannels, names.data(),
                                     spec.format.is_floating_point()};
  float* const values = allocate(user, &contents);
  if (!values) {
    say(message, "out of memory");
    return VITRUM_IMAGE_TOO_LARGE;
  }
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, values) || input->has_error()) {
    say(message, input->geterror());
    return VITRUM_IMAGE_DAMAGED;
  }
  return VITRUM_IMAGE_OK;
}

/// Puts the metadata where the format keeps it: EXR and PNG have named texts, the others one description.
void add_metadata(const VitrumImageToEncode& image, OIIO::ImageSpec& spec) {
  const std::string_view extension = image.extension;
  spec.attribute("Software", image.software);
  if (extension == "exr" || extension == "png") {
    for (int i = 0; i < image.metadata_count; ++i) {
      spec.attribute(std::string("vitrum:") + image.metadata_keys[i], image.metadata_values[i]);
    }
  } else {
    std::string description;
    for (int i = 0; i < image.metadata_count; ++i) {
      if (i > 0) description += "; ";
      description += std::string(image.metadata_keys[i]) + "=" + image.metadata_values[i];
    }
    if (!description.empty()) spec.attribute("ImageDescription", description);
  }
}

VitrumImageStatus encode_file(const VitrumImageToEncode& image, VitrumImageTake take, void* user,
                              VitrumImageMessage* message) {
  const std::string extension = image.extension;
  const auto output = OIIO::ImageOutput::create(extension);
  // Everything is encoded in memory: the JPEG writer ends the whole process when the disk is full.
  if (!output || !output->supports("ioproxy")) {
    say(message, output ? "the writer cannot write to memory" : OIIO::geterror());
    return VITRUM_IMAGE_FAILED;
  }
  OIIO::ImageSpec spec(image.width, image.height, image.channels,
                       image.is_float ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
  spec.channelnames.assign(image.channel_names, image.channel_names + image.channels);
  add_metadata(image, spec);
  const bool is_exr = extension == "exr", is_tiff = extension == "tif" || extension == "tiff";
  if (is_exr || is_tiff) {
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // else the time of day is written, and no two files are the same
  }
  if (extension == "jpg" || extension == "jpeg") {
    spec.attribute("compression", "jpeg:95");
    spec.attribute("jpeg:subsampling", "4:4:4");
  }
  // In a TIFF this would need an Exif directory, which OpenImageIO 2.4 writes in the place of the main one.
  if (image.is_srgb && !is_tiff) spec.attribute("oiio:ColorSpace", "sRGB");

  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  output->set_ioproxy(&memory);
  bool is_written = output->open("picture." + extension, spec) &&
                    output->write_image(OIIO::TypeDesc::FLOAT, image.values) && !output->has_error();
  is_written = output->close() && is_written;
  if (!is_written || bytes.empty()) {
    say(message, output->geterror());
    return VITRUM_IMAGE_FAILED;
  }
  if (!take(user, bytes.data(), bytes.size())) {
    say(message, "out of memory");
    return VITRUM_IMAGE_FAILED;
  }
  return VITRUM_IMAGE_OK;
}

VitrumImageStatus read(const char* path, uint64_t max_pixels, VitrumImageAllocate allocate, void* user,
                       VitrumImageMessage* message) {
  return guarded(VITRUM_IMAGE_DAMAGED, message, [&] { return read_file(path, max_pixels, allocate, user, message); });
}

VitrumImageStatus read_channels(const char* path, uint64_t max_pixels, uint64_t max_values,
                                VitrumImageAllocateChannels allocate, void* user, VitrumImageMessage* message) {
  return guarded(VITRUM_IMAGE_DAMAGED, message,
                 [&] { return read_all_channels(path, max_pixels, max_values, allocate, user, message); });
}

VitrumImageStatus encode(const VitrumImageToEncode* image, VitrumImageTake take, void* user,
                         VitrumImageMessage* message) {
  return guarded(VITRUM_IMAGE_FAILED, message, [&] { return encode_file(*image, take, user, message); });
}

}  // namespace

extern "C" const VitrumImageModule* vitrum_image_module() {
  static const VitrumImageModule module{VITRUM_IMAGE_MODULE_VERSION, read, read_channels, encode};
  return &module;
}
