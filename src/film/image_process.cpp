#include "film/image_process.hpp"

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/auxv.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <utility>
#include <vector>

extern char** environ;

namespace vitrum {
namespace {

namespace fs = std::filesystem;
using namespace image_protocol;

constexpr const char* program_file = "vitrum_images";

constexpr uint64_t max_pixels = uint64_t{1} << 28, max_values = 3 * max_pixels;

static_assert(sizeof(glm::vec3) == 3 * sizeof(float), "pixels come as floats");

/// Why the process cannot do what it is there for; becomes an Error at the place of who asked.
struct ProcessFault {
  std::string problem, mend;
};

ProcessFault bad_installation(const std::string& problem) {
  return {problem, std::string("build or install vitrum again, with ") + program_file + " beside the program"};
}

ProcessFault out_of_resources(const std::string& what, int error_number) {
  return {what + ": " + std::strerror(error_number), "end other programs, or free memory"};
}

/// Refuses answers that do not fit the request, before they are taken for sizes in memory.
void expect(bool makes_sense) {
  if (!makes_sense) throw bad_installation(std::string("its process ") + program_file + " gives no sensible answer");
}

/// The folder of the running program.
fs::path program_folder() {
  std::error_code error;
  fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) {  // no /proc, as in a bare chroot
    const char* name = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
    program = fs::absolute(name ? name : "", error);
  }
  return program.parent_path();
}

/// Where vitrum_images is. Throws ProcessFault.
fs::path find_program() {
  const fs::path folder = program_folder();
  const std::array<fs::path, 2> places{folder / program_file, folder / "../lib/vitrum" / program_file};
  for (const fs::path& place : places) {
    std::error_code error;
    if (fs::exists(place, error)) return place;
  }
  throw bad_installation("there is neither " + places[0].string() + " nor " + places[1].string());
}

/// A descriptor that is closed at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() {
    if (number_ >= 0) ::close(number_);
  }
  int get() const { return number_; }

 private:
  int number_;
};

struct DescriptorPair {
  Descriptor ours, its;
};

/// For requests and answers. Its ends, and those of the pipe, are closed in whatever other program is started.
DescriptorPair make_socket_pair() {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw out_of_resources("there is no socket left", errno);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

/// For what the process's libraries print. Neither end ever waits: once the pipe is full, what is printed is lost.
DescriptorPair make_pipe() {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) throw out_of_resources("there is no pipe left", errno);
  return {Descriptor(ends[0]), Descriptor(ends[1])};
}

/// A process for pictures that runs, from construction to destruction.
class ImageProcess {
 public:
  /// Throws ProcessFault if there is no program, or the system does not start it.
  ImageProcess() {
    std::string program = find_program().string();
    DescriptorPair socket = make_socket_pair(), printed = make_pipe();
    posix_spawn_file_actions_t files;
    ::posix_spawn_file_actions_init(&files);
    ::posix_spawn_file_actions_adddup2(&files, socket.its.get(), STDIN_FILENO);
    ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
    ::posix_spawn_file_actions_adddup2(&files, printed.its.get(), STDERR_FILENO);
    // What a terminal sends to all of its processes is vitrum's business: this one ends when vitrum does.
    sigset_t terminal_signals;
    ::sigemptyset(&terminal_signals);
    for (const int signal_number : {SIGINT, SIGQUIT, SIGHUP}) ::sigaddset(&terminal_signals, signal_number);
    posix_spawnattr_t attributes;
    ::posix_spawnattr_init(&attributes);
    ::posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
    ::posix_spawnattr_setsigmask(&attributes, &terminal_signals);
    std::array<char*, 2> arguments{program.data(), nullptr};
    const int fault = ::posix_spawn(&process_, program.c_str(), &files, &attributes, arguments.data(), environ);
    ::posix_spawnattr_destroy(&attributes);
    ::posix_spawn_file_actions_destroy(&files);
    const std::string problem = program + " does not start";
    if (fault == EAGAIN || fault == ENOMEM) throw out_of_resources(problem, fault);
    if (fault != 0) throw bad_installation(problem + ": " + std::strerror(fault));
    socket_ = std::move(socket.ours);
    printed_ = std::move(printed.ours);
  }
  ~ImageProcess() {
    if (process_ >= 0) end();
  }
  ImageProcess(const ImageProcess&) = delete;
  ImageProcess& operator=(const ImageProcess&) = delete;

  /// False if it has ended.
  bool is_connected() const {
    pollfd socket{socket_.get(), 0, 0};
    return !is_killed_ && ::poll(&socket, 1, 0) == 0;
  }

  /// Ends it, without waiting for that.
  void kill() {
    // Not what has ended by itself: its number may belong to another process where SIGCHLD is ignored.
    if (is_connected()) is_killed_ = ::kill(process_, SIGKILL) == 0;
  }

  /// Waits until it has loaded its libraries. Throws ProcessFault if it is not what is expected.
  void wait_for_greeting() {
    if (has_greeted_) return;
    const FrameHeader frame = next_frame();
    if (frame.kind != FrameKind::greeting || frame.version != version || frame.bytes != 0)
      throw bad_installation(std::string(program_file) + " is of another version");
    has_greeted_ = true;
  }

  FrameHeader next_frame() {
    FrameHeader frame{};
    receive(&frame, sizeof frame);
    return frame;
  }
  /// What FrameKind::done says, whose header is `frame`.
  ImageAnswer receive_answer(const FrameHeader& frame) {
    ImageAnswer answer;
    expect(frame.kind == FrameKind::done && frame.bytes >= sizeof answer.status);
    receive(&answer.status, sizeof answer.status);
    answer.message.resize(frame.bytes - sizeof answer.status);
    receive(answer.message.data(), answer.message.size());
    return answer;
  }

  template <typename... Pieces>
  void send(FrameKind kind, const Pieces&... pieces) {
    if (!send_frame(socket_.get(), kind, pieces...)) fail();
  }
  void receive(void* to, size_t bytes) {
    if (!receive_all(socket_.get(), to, bytes)) fail();
  }

 private:
  /// Waits for its end and returns its status; nothing, if the system has none because SIGCHLD is ignored.
  std::optional<int> end() {
    kill();
    int status = 0;
    pid_t ended = 0;
    do ended = ::waitpid(process_, &status, 0);
    while (ended < 0 && errno == EINTR);
    process_ = -1;
    return ended < 0 ? std::nullopt : std::optional(status);
  }

  /// The first line that it or its loader has printed.
  std::string first_line() const {
    std::array<char, 512> text{};
    const ssize_t length = ::read(printed_.get(), text.data(), text.size());
    const std::string_view all(text.data(), length > 0 ? static_cast<size_t>(length) : 0);
    return std::string(all.substr(0, all.find('\n')));
  }

  /// To be called when it is found gone.
  [[noreturn]] void fail() {
    const std::optional<int> status = end();
    std::string how = "ended";
    if (status && WIFSIGNALED(*status)) {
      const int number = WTERMSIG(*status);
      how = "was ended by signal " + std::to_string(number) + " (" + ::strsignal(number) + ")";
    } else if (status) {
      how = "ended with code " + std::to_string(WEXITSTATUS(*status));
    }
    if (has_greeted_)
      throw ProcessFault{std::string("its process ") + program_file + " " + how,
                         "put the picture into another format, or free memory if that ran out"};
    const std::string reason = first_line();
    throw bad_installation(std::string("the process ") + program_file + " " + how + " when it was started" +
                           (reason.empty() ? "" : ": " + reason));
  }

  pid_t process_ = -1;
  Descriptor socket_, printed_;
  bool has_greeted_ = false, is_killed_ = false;
};

std::mutex one_request;
std::optional<ImageProcess> running;  // guarded by one_request

/// The process, started if none runs. To be called with one_request locked. Throws ProcessFault.
ImageProcess& running_process() {
  if (running && !running->is_connected()) running.reset();
  if (!running) running.emplace();
  return *running;
}

/// Has the process answer what `exchange` asks it. One whose answer was not heard to its end is of no more use.
template <typename Exchange>
ImageAnswer ask(const SourceLocation& asked_by, const std::string& failure, Exchange exchange) {
  const std::lock_guard lock(one_request);
  try {
    ImageProcess& process = running_process();
    process.wait_for_greeting();
    return exchange(process);
  } catch (const ProcessFault& fault) {
    running.reset();
    throw Error(asked_by, failure + ": " + fault.problem, fault.mend);
  } catch (...) {
    running.reset();
    throw;
  }
}

/// Decodes a picture into what `make_room` gives for its contents and the names of its channels: a span of chars.
template <typename MakeRoom>
ImageAnswer decode(const std::string& path, bool wants_all, const SourceLocation& asked_by, MakeRoom make_room) {
  return ask(asked_by, "the picture '" + path + "' cannot be read", [&](ImageProcess& process) {
    const DecodeRequest request{max_pixels, max_values, wants_all};
    // The folder that the process works in is the one that vitrum worked in when it was started.
    process.send(FrameKind::decode, bytes_of(request), fs::absolute(path).string());
    bool has_contents = false;
    std::span<char> unfilled;
    for (;;) {
      const FrameHeader frame = process.next_frame();
      if (frame.kind == FrameKind::contents) {
        PictureContents contents{};
        expect(frame.bytes >= sizeof contents && !has_contents);
        process.receive(&contents, sizeof contents);
        std::string texts(frame.bytes - sizeof contents, '\0');
        process.receive(texts.data(), texts.size());
        const std::vector<std::string> names = split_texts(texts);
        expect(contents.width > 0 && contents.height > 0 && !names.empty());
        const uint64_t pixels = static_cast<uint64_t>(contents.width) * static_cast<uint64_t>(contents.height);
        expect(pixels <= max_pixels && pixels <= max_values / names.size());
        unfilled = make_room(contents, names);
        expect(unfilled.size() == pixels * names.size() * sizeof(float));
        has_contents = true;
      } else if (frame.kind == FrameKind::rows) {
        expect(frame.bytes <= unfilled.size());
        process.receive(unfilled.data(), frame.bytes);
        unfilled = unfilled.subspan(frame.bytes);
      } else {
        const ImageAnswer answer = process.receive_answer(frame);
        expect(answer.status != Status::ok || (has_contents && unfilled.empty()));
        return answer;
      }
    }
  });
}

}  // namespace

void start_image_process() {
  const std::lock_guard lock(one_request);
  try {
    running_process();
  } catch (const ProcessFault& fault) {
    throw Error({}, "pictures can be neither read nor written: " + fault.problem, fault.mend);
  }
}

void end_image_process() {
  const std::lock_guard lock(one_request);
  if (running) running->kill();
}

ImageAnswer decode_picture(const std::string& path, const SourceLocation& asked_by, Picture& picture) {
  return decode(path, false, asked_by, [&](const PictureContents& contents, const std::vector<std::string>&) {
    picture.width = contents.width;
    picture.height = contents.height;
    picture.pixels.resize(static_cast<size_t>(contents.width) * static_cast<size_t>(contents.height));
    return std::span(reinterpret_cast<char*>(picture.pixels.data()), picture.pixels.size() * sizeof(glm::vec3));
  });
}

ImageAnswer decode_picture(const std::string& path, const SourceLocation& asked_by, PictureChannels& picture) {
  return decode(path, true, asked_by, [&](const PictureContents& contents, const std::vector<std::string>& names) {
    picture.width = contents.width;
    picture.height = contents.height;
    picture.is_float = contents.is_float != 0;
    picture.names = names;
    picture.values.resize(static_cast<size_t>(contents.width) * static_cast<size_t>(contents.height) * names.size());
    return std::span(reinterpret_cast<char*>(picture.values.data()), picture.values.size() * sizeof(float));
  });
}

ImageAnswer encode_picture(const std::string& path, const EncodeRequest& request,
                           std::string_view texts, std::span<const float> values, std::string& file) {
  return ask({path}, "the picture cannot be encoded", [&](ImageProcess& process) {
    process.send(FrameKind::encode, bytes_of(request), texts, bytes_of(values));
    FrameHeader frame = process.next_frame();
    if (frame.kind == FrameKind::file) {
      file.resize(frame.bytes);
      process.receive(file.data(), file.size());
      frame = process.next_frame();
    }
    return process.receive_answer(frame);
  });
}

}  // namespace vitrum
