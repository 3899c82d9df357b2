#include "film/vitrum_images/codec.hpp"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <exception>
#include <new>

namespace vitrum::image_protocol {
namespace {

/// Rows that are held at a time: as many as OpenImageIO takes at once, and a multiple of all formats' blocks.
constexpr int band_rows = 256;

/// One line: OpenImageIO joins several errors by line feeds, and the first one says most.
std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

template <typename Work>
Outcome guarded(Status otherwise, Work work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return {Status::too_large, "out of memory"};
  } catch (const std::exception& error) {
    return {otherwise, first_line(error.what())};
  }
}

/// Which channels of a file are read.
struct ChannelRange {
  int first = 0;
  int count = 3;
};

/// Those of its colour: 3, or 1 for grey.
ChannelRange colour_channels(const OIIO::ImageSpec& spec) {
  const auto& names = spec.channelnames;
  for (int i = 0; i + 2 < spec.nchannels && i + 2 < static_cast<int>(names.size()); ++i) {
    if (names[i] == "R" && names[i + 1] == "G" && names[i + 2] == "B") return {i, 3};
  }
  return {0, spec.nchannels >= 3 ? 3 : 1};
}

/// Reads the rows from `y` to before `end`, with `pixel_values` floats from one pixel to the next.
bool read_rows(OIIO::ImageInput& input, const ChannelRange& range, int y, int end, float* values, size_t pixel_values) {
  const OIIO::ImageSpec& spec = input.spec();
  const int end_channel = range.first + range.count;
  const auto stride = static_cast<OIIO::stride_t>(pixel_values * sizeof(float));
  if (spec.tile_width == 0)
    return input.read_scanlines(0, 0, y, end, spec.z, range.first, end_channel, OIIO::TypeDesc::FLOAT, values, stride);
  return input.read_tiles(0, 0, spec.x, spec.x + spec.width, y, end, spec.z, spec.z + 1, range.first, end_channel,
                          OIIO::TypeDesc::FLOAT, values, stride);
}

Outcome decode_file(const std::string& path, const DecodeRequest& request, const TakeContents& take_contents,
                    const std::function<void(std::span<const float>)>& take_rows) {
  OIIO::ImageSpec wishes;
  wishes.attribute("oiio:UnassociatedAlpha", 1);  // colours as they are in the file, not multiplied by alpha
  const auto input = OIIO::ImageInput::open(path, &wishes);
  if (!input) return {Status::not_a_picture, first_line(OIIO::geterror())};
  const OIIO::ImageSpec& spec = input->spec();
  if (spec.width < 1 || spec.height < 1 || spec.depth > 1 || spec.nchannels < 1 || spec.deep)
    return {Status::not_a_picture, "no plain two-dimensional pixels"};
  const bool wants_all = request.wants_all != 0;
  const ChannelRange range = wants_all ? ChannelRange{0, spec.nchannels} : colour_channels(spec);
  std::vector<std::string> names{"R", "G", "B"};
  if (wants_all) {
    names = spec.channelnames;
    names.resize(static_cast<size_t>(spec.nchannels));  // a reader need not name them all
  }
  const uint64_t pixels = static_cast<uint64_t>(spec.width) * static_cast<uint64_t>(spec.height);
  const std::string size = std::to_string(spec.width) + " x " + std::to_string(spec.height) + " pixels";
  if (pixels > request.max_pixels) return {Status::too_large, size};
  if (pixels > request.max_values / names.size())
    return {Status::too_large, size + " of " + std::to_string(names.size()) + " channels"};
  const int step = spec.tile_width == 0 ? band_rows : spec.tile_height;
  const size_t row_values = static_cast<size_t>(spec.width) * names.size();
  std::vector<float> band(static_cast<size_t>(std::min(step, spec.height)) * row_values);
  take_contents({spec.width, spec.height, spec.format.is_floating_point()}, names);
  for (int row = 0; row < spec.height; row += step) {
    const int rows = std::min(step, spec.height - row);
    const std::span<float> values(band.data(), static_cast<size_t>(rows) * row_values);
    const bool is_read = read_rows(*input, range, spec.y + row, spec.y + row + rows, values.data(), names.size());
    // Readers of JPEG and TIFF fill in what a file cut short lacks, report success, and leave an error behind.
    if (!is_read || input->has_error()) return {Status::damaged, first_line(input->geterror())};
    if (!wants_all && range.count == 1) {
      for (size_t i = 0; i < values.size(); i += 3) values[i + 1] = values[i + 2] = values[i];
    }
    take_rows(values);
  }
  return {};
}

/// Puts the metadata where the format keeps it: PNG has named texts, the others one description.
void add_metadata(const std::string& extension, std::span<const std::string> keys_and_values, OIIO::ImageSpec& spec) {
  std::string description;
  for (size_t i = 0; i + 1 < keys_and_values.size(); i += 2) {
    const std::string& key = keys_and_values[i];
    const std::string& value = keys_and_values[i + 1];
    if (extension == "png") {
      spec.attribute("vitrum:" + key, value);
    } else {
      description += (description.empty() ? "" : "; ") + key + "=" + value;
    }
  }
  if (!description.empty()) spec.attribute("ImageDescription", description);
}

Outcome encode_file(const EncodeRequest& request, const std::vector<std::string>& texts,
                    const std::function<void(std::span<float>)>& give_rows, std::vector<unsigned char>& file) {
  const std::string& extension = texts.at(0);
  const auto output = OIIO::ImageOutput::create(extension);
  // Everything is encoded in memory: the JPEG writer ends the whole process when the disk is full.
  if (!output || !output->supports("ioproxy"))
    return {Status::not_encoded, output ? "the writer cannot write to memory" : first_line(OIIO::geterror())};
  OIIO::ImageSpec spec(request.width, request.height, request.channels,
                       request.is_float ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
  spec.attribute("Software", texts.at(1));
  const auto names = texts.begin() + 2, metadata = names + request.channels;
  spec.channelnames.assign(names, metadata);
  add_metadata(extension, {metadata, texts.end()}, spec);
  const bool is_tiff = extension == "tif" || extension == "tiff";
  if (is_tiff) {
    spec.attribute("compression", "zip");
    spec.attribute("DateTime", "");  // else the time of day is written, and no two files are the same
  }
  if (extension == "jpg" || extension == "jpeg") {
    spec.attribute("compression", "jpeg:95");
    spec.attribute("jpeg:subsampling", "4:4:4");
  }
  // In a TIFF this would need an Exif directory, which OpenImageIO 2.4 writes in the place of the main one.
  if (request.is_srgb && !is_tiff) spec.attribute("oiio:ColorSpace", "sRGB");

  OIIO::Filesystem::IOVecOutput memory(file);
  output->set_ioproxy(&memory);
  const size_t row_values = static_cast<size_t>(request.width) * static_cast<size_t>(request.channels);
  std::vector<float> band(static_cast<size_t>(std::min(band_rows, request.height)) * row_values);
  bool is_written = output->open("picture." + extension, spec);
  for (int row = 0; is_written && row < request.height; row += band_rows) {
    const int end = std::min(row + band_rows, request.height);
    give_rows({band.data(), static_cast<size_t>(end - row) * row_values});
    is_written = output->write_scanlines(row, end, 0, OIIO::TypeDesc::FLOAT, band.data()) && !output->has_error();
  }
  is_written = output->close() && is_written;
  if (!is_written || file.empty()) return {Status::not_encoded, first_line(output->geterror())};
  return {};
}

}  // namespace

Outcome decode(const std::string& path, const DecodeRequest& request, const TakeContents& take_contents,
               const std::function<void(std::span<const float>)>& take_rows) {
  return guarded(Status::damaged, [&] { return decode_file(path, request, take_contents, take_rows); });
}

Outcome encode(const EncodeRequest& request, const std::vector<std::string>& texts,
               const std::function<void(std::span<float>)>& give_rows, std::vector<unsigned char>& file) {
  return guarded(Status::not_encoded, [&] { return encode_file(request, texts, give_rows, file); });
}

}  // namespace vitrum::image_protocol
