#pragma once
// What vitrum and its process for pictures, the program vitrum_images, say to each other, over a socket that is the
// process's standard input. Both are built from this file and run on one machine, so numbers go as they lie in memory.
//
// The process greets once. Then vitrum asks and the process answers, one picture at a time:
//
//   vitrum    decode: DecodeRequest, path
//   process   contents: PictureContents, the channels' names; rows: the values of the next rows, as often as there are
//             some; done: Status, message
//
//   vitrum    encode: EncodeRequest, texts, values
//   process   file: the file's bytes, if it is encoded; done: Status, message
//
// Values are floats, interleaved, row 0 at the top. Texts and names are each closed by a zero.

#include <sys/socket.h>

#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace vitrum::image_protocol {

/// Raised by every change of what stands here, so that a program of another build is refused.
inline constexpr uint32_t version = 2;

enum class FrameKind : uint32_t { greeting, decode, encode, contents, rows, file, done };

/// Before everything that is sent; `bytes` of payload follow.
struct FrameHeader {
  FrameKind kind;
  uint32_t version;
  uint64_t bytes;
};

enum class Status : uint32_t {
  ok,
  not_a_picture,  ///< no reader knows the file, or it holds something else (volumes, deep pixels)
  too_large,      ///< more pixels or values than allowed, or than there is memory for
  damaged,        ///< cut short, or what it holds contradicts itself
  not_encoded,
};

struct DecodeRequest {
  uint64_t max_pixels, max_values;  ///< pictures of more are refused unread; values are those that would be sent
  uint64_t wants_all;               ///< 1: all channels, as the file has them; 0: R, G, B, with grey spread over them
};

struct PictureContents {
  int32_t width, height;
  int32_t is_float;      ///< 1: the file holds floats; 0: integers, sent as 0..1
};

/// The texts: the format's extension without the dot, name and version of the program, the channels' names, then keys
/// and values of the metadata in turn.
struct EncodeRequest {
  int32_t width, height, channels;
  int32_t is_float;      ///< 1: 32-bit float; 0: 8-bit, 0..1 becomes 0..255
  int32_t is_srgb;       ///< 1: the values carry the sRGB curve, and the file may say so
  uint32_t texts_bytes;
};

template <typename T>
std::string_view bytes_of(std::span<const T> values) {
  static_assert(std::is_trivially_copyable_v<T>);
  return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
}

template <typename T>
std::string_view bytes_of(const T& value) {
  return bytes_of(std::span<const T>(&value, 1));
}

inline void append_text(std::string& texts, const std::string& text) { texts.append(text.c_str()).push_back('\0'); }

inline std::vector<std::string> split_texts(const std::string& texts) {
  std::vector<std::string> all;
  for (size_t at = 0; at < texts.size(); at += all.back().size() + 1) all.emplace_back(texts.c_str() + at);
  return all;
}

/// Sends all bytes. False if the other side has gone, which raises no signal.
inline bool send_all(int socket, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t sent = ::send(socket, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    if (sent >= 0) {
      bytes.remove_prefix(static_cast<size_t>(sent));
    } else if (errno != EINTR) {
      return false;
    }
  }
  return true;
}

/// Fills `bytes` bytes at `to`. False if the other side has gone.
inline bool receive_all(int socket, void* to, size_t bytes) {
  char* at = static_cast<char*>(to);
  while (bytes > 0) {
    const ssize_t received = ::recv(socket, at, bytes, 0);
    if (received > 0) {
      at += received;
      bytes -= static_cast<size_t>(received);
    } else if (received == 0 || errno != EINTR) {
      return false;
    }
  }
  return true;
}

/// Sends a frame whose payload is these pieces in turn. False if the other side has gone.
template <typename... Pieces>
bool send_frame(int socket, FrameKind kind, const Pieces&... pieces) {
  const FrameHeader header{kind, version, (uint64_t{0} + ... + pieces.size())};
  return send_all(socket, bytes_of(header)) && (send_all(socket, pieces) && ...);
}

}  // namespace vitrum::image_protocol
