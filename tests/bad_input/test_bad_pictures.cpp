// Pictures that cannot be read, and places that cannot be written: the message names file, line and mend, and nothing
// is left behind.
#include <doctest/doctest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <string>

#include "film/images.hpp"
#include "temporary_folder.hpp"

using namespace vitrum;
namespace fs = std::filesystem;

namespace {

const SourceLocation asked_by{"lawn.mtl", 12, 3};
constexpr int width = 48, height = 40;

bool starts_with(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }
bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The message of the refusal to read `path` by `read`; "" if there is none.
template <typename Read>
std::string refusal_by(Read read, const std::string& path) {
  try {
    read(path, asked_by);
  } catch (const Error& error) {
    CHECK(starts_with(error.what(), "lawn.mtl:12:3: "));
    CHECK(contains(error.problem(), path));
    CHECK(!error.mend().empty());
    return error.what();
  }
  return "";
}

/// The message with which both ways of reading refuse `path`; "" if there is none.
std::string refusal(const std::string& path) {
  const std::string message = refusal_by(read_picture, path);
  CHECK(refusal_by(read_layers, path) == message);
  return message;
}

/// The message of the refusal to write `path`, which `call` does or checks; "" if there is none.
template <typename Call>
std::string write_refusal(const std::string& path, Call call) {
  try {
    call(path);
  } catch (const Error& error) {
    CHECK(starts_with(error.what(), path + ": "));
    CHECK(!error.mend().empty());
    return error.what();
  }
  return "";
}

PictureLayer noise() {
  PictureLayer layer{"beauty", 3, {}, true};
  uint32_t state = 1;
  for (int i = 0; i < width * height * 3; ++i) {
    state = state * 1664525u + 1013904223u;
    layer.values.push_back(float(state >> 8) / float(1 << 24));
  }
  return layer;
}

void write_noise(const std::string& path) { write_picture(path, width, height, {noise()}, {}, {}); }

}  // namespace

TEST_CASE("pictures: files that are none") {
  const TemporaryFolder folder;
  CHECK(contains(refusal(folder / "none.png"), "does not exist"));
  CHECK(contains(refusal(folder.path()), "is a folder"));
  put_file(folder / "file", "x");
  CHECK(contains(refusal(folder / "file/x.png"), "Not a directory"));
  REQUIRE(::mkfifo((folder / "fifo.png").c_str(), 0600) == 0);
  CHECK(contains(refusal(folder / "fifo.png"), "not an ordinary file"));
  CHECK(contains(refusal("/dev/zero"), "not an ordinary file"));
  put_file(folder / "empty.png", "");
  CHECK(contains(refusal(folder / "empty.png"), "is empty"));
  if (::geteuid() != 0) {  // root may read everything
    put_file(folder / "secret.png", "x");
    fs::permissions(folder / "secret.png", fs::perms::none);
    CHECK(contains(refusal(folder / "secret.png"), "Permission denied"));
  }
}

TEST_CASE("pictures: files that are something else") {
  const TemporaryFolder folder;
  put_file(folder / "pointer.png", "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n");
  CHECK(contains(refusal(folder / "pointer.png"), "git lfs pull"));
  put_file(folder / "text.png", "newmtl glass\nKd 1 1 1\n");
  CHECK(contains(refusal(folder / "text.png"), "is no picture"));
  put_file(folder / "text.without", std::string(100'000, 'x'));
  CHECK(contains(refusal(folder / "text.without"), "is no picture"));
  put_file(folder / "zeros.exr", std::string(100'000, '\0'));
  CHECK(contains(refusal(folder / "zeros.exr"), "is no picture"));
}

TEST_CASE("pictures: a file cut short anywhere is refused, or all its pixels are there") {
  const TemporaryFolder folder;
  for (const std::string ending : {"png", "jpg", "exr", "tif", "bmp", "hdr"}) {
    CAPTURE(ending);
    const std::string whole_path = folder / ("x." + ending);
    const std::string cut_path = folder / ("cut." + ending);
    write_noise(whole_path);
    const std::string bytes = file_bytes(whole_path);
    const Picture whole = read_picture(whole_path, asked_by);
    int refused = 0;
    for (int part = 1; part < 60; ++part) {
      CAPTURE(part);
      put_file(cut_path, bytes.substr(0, bytes.size() * size_t(part) / 60));
      const std::string message = refusal(cut_path);
      if (message.empty()) CHECK((read_picture(cut_path, asked_by).pixels == whole.pixels));
      refused += !message.empty();
    }
    CHECK(refused > 50);
    put_file(cut_path, bytes.substr(0, bytes.size() / 2));
    CHECK(contains(refusal(cut_path), "cut short"));
  }
}

TEST_CASE("pictures: a header that claims far too many pixels is refused before they are read") {
  const TemporaryFolder folder;
  // JPEG: the size stands in the frame header (marker, length, precision, height, width).
  write_noise(folder / "x.jpg");
  std::string jpeg = file_bytes(folder / "x.jpg");
  const size_t frame = jpeg.find(std::string("\xff\xc0\x00\x11\x08", 5));
  REQUIRE(frame != std::string::npos);
  jpeg.replace(frame + 5, 4, "\xff\xdc\xff\xdc");  // the largest that libjpeg takes
  put_file(folder / "huge.jpg", jpeg);
  CHECK(contains(refusal(folder / "huge.jpg"), "is too large (65500 x 65500 pixels)"));
  // BMP: width and height stand at 18 and 22, little-endian.
  write_noise(folder / "x.bmp");
  std::string bmp = file_bytes(folder / "x.bmp");
  bmp.replace(18, 8, std::string("\x00\x80\x00\x00\x01\x20\x00\x00", 8));  // 32768 x 8193, one row above the limit
  put_file(folder / "huge.bmp", bmp);
  CHECK(contains(refusal(folder / "huge.bmp"), "is too large (32768 x 8193 pixels)"));
  // As many pixels as are allowed, but of 32 bits, which stand at 28: four channels make too many values.
  bmp.replace(18, 8, std::string("\x00\x40\x00\x00\x00\x40\x00\x00", 8));
  bmp[28] = 32;
  put_file(folder / "deep.bmp", bmp);
  CHECK(contains(refusal_by(read_layers, folder / "deep.bmp"), "is too large (16384 x 16384 pixels of 4 channels)"));
}

TEST_CASE("pictures: a fault in the middle is refused") {
  const TemporaryFolder folder;
  PictureLayer squares{"beauty", 3, {}, true};  // noise would be stored as it is, without a check sum
  for (int i = 0; i < width * height * 3; ++i) squares.values.push_back(float(i % 97 * i % 64) / 64.0f);
  for (const std::string ending : {"png", "exr"}) {
    CAPTURE(ending);
    const std::string path = folder / ("x." + ending);
    write_picture(path, width, height, {squares}, {}, {});
    std::string bytes = file_bytes(path);
    for (size_t i = 0; i < 64; ++i) bytes[bytes.size() / 2 + i] = char(~bytes[bytes.size() / 2 + i]);
    put_file(path, bytes);
    CHECK(contains(refusal(path), "damaged"));
  }
}

TEST_CASE("pictures: places that cannot be written are refused before anything is rendered") {
  const TemporaryFolder folder;
  const auto check_refusal = [&](const std::string& path) { return write_refusal(path, check_writable); };
  CHECK(contains(check_refusal(folder / "picture"), "no ending"));
  CHECK(contains(check_refusal(folder / "picture.xyz"), "of the kind '.xyz'"));
  CHECK(contains(check_refusal(folder / ".png"), "no ending"));
  CHECK(contains(check_refusal(folder / "none/x.png"), "does not exist; make it first"));
  CHECK(contains(check_refusal(folder / (std::string(300, 'n') + ".png")), "choose a shorter name"));
  put_file(folder / "file", "x");
  CHECK(contains(check_refusal(folder / "file/x.png"), "is not a folder"));
  fs::create_directory(folder / "folder.png");
  CHECK(contains(check_refusal(folder / "folder.png"), "is a folder"));
  REQUIRE(::mkfifo((folder / "fifo.png").c_str(), 0600) == 0);
  CHECK(contains(check_refusal(folder / "fifo.png"), "not an ordinary file"));
  CHECK(folder.entries() == 3);
  if (::geteuid() != 0) {  // root may write everywhere
    put_file(folder / "kept.png", "x");
    fs::permissions(folder / "kept.png", fs::perms::owner_read);
    CHECK(contains(check_refusal(folder / "kept.png"), "may not be replaced"));
    fs::create_directory(folder / "locked");
    fs::permissions(folder / "locked", fs::perms::owner_read | fs::perms::owner_exec);
    CHECK(contains(check_refusal(folder / "locked/x.png"), "Permission denied"));
  }
}

TEST_CASE("pictures: one that does not fit on the disk leaves the old one and nothing else") {
  const TemporaryFolder folder;
  // A limit on the size of files stands for the full disk.
  struct rlimit before {};
  ::getrlimit(RLIMIT_FSIZE, &before);
  struct rlimit small = before;
  small.rlim_cur = 2000;
  const auto old_handler = ::signal(SIGXFSZ, SIG_IGN);
  for (const std::string ending : {"png", "jpg", "exr", "tif", "bmp", "hdr"}) {
    CAPTURE(ending);
    const std::string path = folder / ("x." + ending);
    put_file(path, "old");
    ::setrlimit(RLIMIT_FSIZE, &small);
    const std::string message = write_refusal(path, write_noise);
    ::setrlimit(RLIMIT_FSIZE, &before);
    CHECK(contains(message, "File too large"));
    CHECK(file_bytes(path) == "old");
  }
  ::signal(SIGXFSZ, old_handler);
  CHECK(folder.entries() == 6);
}

TEST_CASE("pictures: a folder that has gone since it was checked") {
  const TemporaryFolder folder;
  CHECK(contains(write_refusal(folder / "gone/x.png", write_noise), "No such file"));
  CHECK(folder.entries() == 0);
}
