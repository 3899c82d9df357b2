#include "film/exr_file.hpp"

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>

#include <algorithm>
#include <cassert>
#include <cstring>

namespace vitrum {
namespace {

/// A file in memory.
class StringStream : public Imf::OStream {
 public:
  StringStream() : Imf::OStream("picture.exr") {}
  void write(const char bytes[], int count) override {
    const auto n = static_cast<size_t>(count);
    text_.resize(std::max(text_.size(), at_ + n));
    std::memcpy(&text_[at_], bytes, n);
    at_ += n;
  }
  uint64_t tellp() override { return at_; }
  void seekp(uint64_t place) override { at_ = place; }
  std::string take() { return std::move(text_); }

 private:
  std::string text_;
  size_t at_ = 0;
};

}  // namespace

std::string exr_file(int width, int height, const std::vector<std::string>& channels, std::span<const float> values,
                     const std::map<std::string, std::string>& texts) {
  assert(values.size() == static_cast<size_t>(width) * static_cast<size_t>(height) * channels.size());
  Imf::Header header(width, height);
  header.compression() = Imf::ZIP_COMPRESSION;
  for (const auto& [name, text] : texts) header.insert(name, Imf::StringAttribute(text));
  const size_t pixel = channels.size() * sizeof(float), row = pixel * static_cast<size_t>(width);
  Imf::FrameBuffer pixels;
  for (size_t i = 0; i < channels.size(); ++i) {
    header.channels().insert(channels[i], Imf::Channel(Imf::FLOAT));
    char* first = reinterpret_cast<char*>(const_cast<float*>(values.data() + i));  // it is only read
    pixels.insert(channels[i], Imf::Slice(Imf::FLOAT, first, pixel, row));
  }
  StringStream stream;
  {
    Imf::OutputFile file(stream, header, 0);  // without threads of its own
    file.setFrameBuffer(pixels);
    file.writePixels(height);
  }
  return stream.take();
}

}  // namespace vitrum
