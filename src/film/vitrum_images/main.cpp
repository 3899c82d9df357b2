// vitrum_images: the process that reads and writes pictures for vitrum, with OpenImageIO in it. What it is asked comes
// over the socket that is its standard input (protocol.hpp), and it lives as long as that socket's other end.

#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "film/vitrum_images/codec.hpp"
#include "film/vitrum_images/protocol.hpp"

namespace {

using namespace vitrum::image_protocol;

constexpr int vitrum_socket = STDIN_FILENO;

/// Nobody is there to be answered. Without the destructors of some 260 libraries.
[[noreturn]] void leave() { ::_exit(0); }

void receive(void* to, size_t bytes) {
  if (!receive_all(vitrum_socket, to, bytes)) leave();
}

template <typename... Pieces>
void send(FrameKind kind, const Pieces&... pieces) {
  if (!send_frame(vitrum_socket, kind, pieces...)) leave();
}

void send_done(const Outcome& outcome) { send(FrameKind::done, bytes_of(outcome.status), outcome.message); }

std::string receive_text(size_t bytes) {
  std::string text(bytes, '\0');
  receive(text.data(), text.size());
  return text;
}

void answer_decode(const FrameHeader& frame) {
  DecodeRequest request{};
  receive(&request, sizeof request);
  const std::string path = receive_text(frame.bytes - sizeof request);
  const auto send_contents = [](const PictureContents& contents, const std::vector<std::string>& names) {
    std::string texts;
    for (const std::string& name : names) append_text(texts, name);
    send(FrameKind::contents, bytes_of(contents), texts);
  };
  send_done(decode(path, request, send_contents,
                   [](std::span<const float> rows) { send(FrameKind::rows, bytes_of(rows)); }));
}

void answer_encode(const FrameHeader& frame) {
  EncodeRequest request{};
  receive(&request, sizeof request);
  const std::vector<std::string> texts = split_texts(receive_text(request.texts_bytes));
  size_t left = frame.bytes - sizeof request - request.texts_bytes;
  std::vector<unsigned char> file;
  const Outcome outcome = encode(request, texts, [&left](std::span<float> rows) {
    receive(rows.data(), rows.size_bytes());
    left -= rows.size_bytes();
  }, file);
  std::array<char, 65536> unwanted;  // of a picture that was given up
  for (; left > 0; left -= std::min(left, unwanted.size())) receive(unwanted.data(), std::min(left, unwanted.size()));
  if (outcome.status == Status::ok) send(FrameKind::file, bytes_of(std::span<const unsigned char>(file)));
  send_done(outcome);
}

}  // namespace

int main() {
  struct stat input {};
  if (::fstat(vitrum_socket, &input) != 0 || !S_ISSOCK(input.st_mode)) {
    std::fprintf(stderr, "vitrum_images reads and writes pictures for vitrum, which starts it; run vitrum instead\n");
    return 2;
  }
  // However long a picture takes: without a vitrum this process ends.
  std::thread([] {
    pollfd socket{vitrum_socket, 0, 0};
    while (::poll(&socket, 1, -1) < 1) {}
    leave();
  }).detach();
  send(FrameKind::greeting);
  for (;;) {
    FrameHeader frame{};
    receive(&frame, sizeof frame);
    if (frame.kind == FrameKind::decode) answer_decode(frame);
    if (frame.kind == FrameKind::encode) answer_encode(frame);
  }
}
