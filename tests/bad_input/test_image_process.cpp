// The process for pictures: whatever becomes of it, the user gets a message and whole files, and none is left over.
#include <doctest/doctest.h>
#include <signal.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <future>
#include <string>
#include <thread>
#include <vector>

#include "film/images.hpp"
#include "vitrum_process.hpp"

using namespace vitrum;
namespace fs = std::filesystem;

namespace {

const SourceLocation asked_by{"lawn.mtl", 12, 3};
const std::string default_scene = VITRUM_SOURCE_DIR "/models/default_scene/scene.toml";
const std::string lawn_texture = VITRUM_SOURCE_DIR "/models/default_scene/default_scene.mtl:9:1: ";

bool contains(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

void wait_a_little() { std::this_thread::sleep_for(std::chrono::milliseconds(300)); }

/// What the system knows of a process.
struct ProcessState {
  std::string name;
  char letter = 'X';  ///< X: there is none; Z: it has ended, and nobody has asked how
  pid_t parent = 0;
};

ProcessState state_of(pid_t process) {
  const std::string stat = file_bytes("/proc/" + std::to_string(process) + "/stat");  // 12 (name) S 11 ...
  const size_t open = stat.find('('), close = stat.rfind(')');
  if (close == std::string::npos) return {};
  return {stat.substr(open + 1, close - open - 1), stat[close + 2], std::stoi(stat.substr(close + 4))};
}

/// The process for pictures of `parent`; waits for its start.
pid_t image_process_of(pid_t parent) {
  for (int i = 0; i < 3000; ++i) {
    for (const fs::directory_entry& entry : fs::directory_iterator("/proc")) {
      const std::string number = entry.path().filename().string();
      if (number.find_first_not_of("0123456789") != std::string::npos) continue;
      const ProcessState state = state_of(std::stoi(number));
      if (state.parent == parent && state.name == "vitrum_images" && state.letter != 'Z') return std::stoi(number);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  FAIL("there is no process for pictures");
  return -1;
}

/// False if it has not ended within 10 s.
bool ends(pid_t process) {
  for (int i = 0; i < 1000; ++i) {
    const char letter = state_of(process).letter;
    if (letter == 'X' || letter == 'Z') return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

void write_grey(const std::string& path, int size = 8, float value = 0.5f) {
  const std::vector<float> values(static_cast<size_t>(size) * static_cast<size_t>(size), value);
  write_picture(path, size, size, {{"", 1, values, true}}, {}, {});
}

/// The message of what `call` throws while the process for pictures is ended by a signal.
template <typename Call>
std::string refusal_when_ended_by(int signal_number, Call call) {
  const TemporaryFolder folder;
  write_grey(folder / "x.png");  // so that the process is past its start
  const pid_t process = image_process_of(::getpid());
  ::kill(process, SIGSTOP);  // so that the request is not answered before the signal comes
  auto waiting = std::async(std::launch::async, call);
  wait_a_little();
  ::kill(process, signal_number);
  ::kill(process, SIGCONT);
  try {
    waiting.get();
  } catch (const Error& error) {
    CHECK(!error.mend().empty());
    CHECK(state_of(process).letter == 'X');
    return error.what();
  }
  return "";
}

/// A copy of vitrum in a folder of its own, without anything beside it.
struct LoneVitrum {
  TemporaryFolder folder;
  std::string program = folder / "vitrum";

  LoneVitrum() { fs::copy_file(VITRUM_BINARY_DIR "/vitrum", program); }

  /// Puts a shell script in the place of vitrum_images.
  void put_images(const std::string& script) const {
    put_file(folder / "vitrum_images", "#!/bin/sh\n" + script);
    fs::permissions(folder / "vitrum_images", fs::perms::owner_all);
  }

  /// The one line with which a command is refused.
  std::string refusal(const std::vector<std::string>& words) const {
    const int before = folder.entries();
    const Ended run = vitrum_run(words, {}, program);
    CHECK(run.code == 1);
    CHECK(run.out.empty());
    CHECK(run.err.find('\n') == run.err.size() - 1);
    CHECK(folder.entries() == before);
    return run.err;
  }
  std::string render_refusal() const {
    return refusal({"render", default_scene, "-o", folder / "a.png", "--quiet", "--size", "16x16", "--samples", "1"});
  }
};

}  // namespace

TEST_CASE("process for pictures: one that ends while a picture is read or written is told, and replaced") {
  const TemporaryFolder folder;
  const std::string path = folder / "x.exr";
  write_grey(path);
  for (const auto& [signal_number, how] : {std::pair(SIGKILL, "signal 9 (Killed)"), {SIGABRT, "signal 6 (Aborted)"}}) {
    CAPTURE(how);
    std::string message = refusal_when_ended_by(signal_number, [&] { read_picture(path, asked_by); });
    CHECK(contains(message, "lawn.mtl:12:3: the picture '" + path + "' cannot be read"));
    CHECK(contains(message, how));
    CHECK(read_picture(path, asked_by).width == 8);
    message = refusal_when_ended_by(signal_number, [&] { read_layers(path, asked_by); });
    CHECK(contains(message, "lawn.mtl:12:3: the picture '" + path + "' cannot be read"));
    CHECK(contains(message, how));
    CHECK(read_layers(path, asked_by).width == 8);
    // A picture of a megabyte is still being sent when its reader goes, and must not end the tests by SIGPIPE.
    for (const int size : {8, 512}) {
      message = refusal_when_ended_by(signal_number, [&] { write_grey(folder / "y.png", size); });
      CHECK(contains(message, folder / "y.png: the picture cannot be encoded"));
      CHECK(contains(message, how));
      CHECK(folder.entries() == 1);
    }
    write_grey(path);
  }
}

TEST_CASE("process for pictures: one that ends while it has nothing to do is replaced without a word") {
  const TemporaryFolder folder;
  for (int i = 0; i < 3; ++i) {
    write_grey(folder / "x.png");
    const pid_t process = image_process_of(::getpid());
    ::kill(process, SIGKILL);
    REQUIRE(ends(process));
    wait_a_little();  // for its last thread, with which its end of the socket goes
    CHECK(read_picture(folder / "x.png", asked_by).width == 8);
    CHECK(state_of(process).letter == 'X');
    end_image_process();
    CHECK(read_picture(folder / "x.png", asked_by).width == 8);
  }
}

TEST_CASE("process for pictures: threads share it, and each gets its own picture") {
  const TemporaryFolder folder;
  std::vector<std::future<float>> values;
  for (int i = 0; i < 6; ++i) {
    values.push_back(std::async(std::launch::async, [&folder, i] {
      const std::string path = folder / (std::to_string(i) + ".exr");
      write_grey(path, 300, static_cast<float>(i));
      const Picture picture = read_picture(path, asked_by);
      for (const glm::vec3& pixel : picture.pixels)
        if (pixel != picture.pixels.front()) return -1.0f;
      const auto layered = read_layers(path, asked_by);
      for (const float value : layered.layers.front().values)
        if (value != picture.pixels.front().x) return -1.0f;
      return picture.pixels.front().x;
    }));
  }
  for (int i = 0; i < 6; ++i) CHECK(values[static_cast<size_t>(i)].get() == static_cast<float>(i));
}

TEST_CASE("process for pictures: a name without its folder counts from where vitrum works") {
  const TemporaryFolder folder;
  start_image_process();
  const fs::path before = fs::current_path();
  fs::current_path(folder.path());
  CHECK_NOTHROW(write_grey("x.png"));
  CHECK_NOTHROW(read_picture("x.png", asked_by));
  fs::current_path(before);
  CHECK(folder.entries() == 1);
}

TEST_CASE("vitrum without its vitrum_images, or with a wrong one") {
  const LoneVitrum vitrum;
  const std::string mend = "; build or install vitrum again, with vitrum_images beside the program";
  std::string message = vitrum.render_refusal();
  CHECK(contains(message, "there is neither " + vitrum.folder / "vitrum_images"));
  CHECK(contains(message, mend));
  message = vitrum.refusal({"compare", "a.png", "b.png"});
  CHECK(contains(message, "there is neither " + vitrum.folder / "vitrum_images"));
  CHECK(contains(message, mend));
  message = vitrum.refusal({"info", default_scene});
  CHECK(contains(message, "vitrum: error: " + lawn_texture));
  CHECK(contains(message, mend));
  put_file(vitrum.folder / "vitrum_images", "");
  CHECK(contains(vitrum.render_refusal(), "does not start: Permission denied" + mend));
  vitrum.put_images("echo no libOpenImageIO >&2; exit 127");
  message = vitrum.render_refusal();
  CHECK(contains(message, "vitrum: error: " + lawn_texture));
  INFO(message);
  CHECK(contains(message, "ended with code 127 when it was started: no libOpenImageIO" + mend));
  vitrum.put_images("head -c 16 /dev/zero >&0");  // the greeting of version 0
  CHECK(contains(vitrum.render_refusal(), "is of another version" + mend));
  vitrum.put_images("exec " VITRUM_BINARY_DIR "/vitrum_images");  // the rightful one
  const Ended run = vitrum_run({"render", default_scene, "-o", vitrum.folder / "a.png", "-o", vitrum.folder / "b.exr",
                                "--size", "16x16", "--samples", "1"}, {}, vitrum.program);
  CHECK_MESSAGE(run.code == 0, run.err);
  CHECK(vitrum.folder.entries() == 4);
}

TEST_CASE("vitrum_images by itself says whose it is") {
  const Ended run = vitrum_run({}, {}, VITRUM_BINARY_DIR "/vitrum_images");
  CHECK(run.code == 2);
  CHECK(contains(run.err, "run vitrum instead"));
}

TEST_CASE("a render whose process for pictures is killed while it reads a texture") {
  const TemporaryFolder folder;
  VitrumProcess process({"render", default_scene, "-o", folder / "a.png", "-o", folder / "b.exr", "--size", "16x16"});
  const pid_t images = image_process_of(process.number());
  ::kill(images, SIGSTOP);
  REQUIRE(process.has_said("device:"));
  wait_a_little();
  ::kill(images, SIGKILL);
  CHECK(process.wait() == 1);
  CHECK(contains(process.err(), "vitrum: error: " + lawn_texture + "the picture '"));
  CHECK(contains(process.err(), "grass.png' cannot be read"));
  CHECK(state_of(images).letter == 'X');
  CHECK(folder.entries() == 0);
}

TEST_CASE("a render outlives its process for pictures, which outlives signals of the terminal; none is left") {
  const TemporaryFolder folder;
  VitrumProcess process({"render", default_scene, "-o", folder / "a.png", "-o", folder / "b.exr", "--size", "128x128",
                         "--samples", "64", "--set", "render.textures=false"});  // so that it is idle when it dies
  const pid_t first = image_process_of(process.number());
  REQUIRE(process.has_said("features:"));
  process.send(SIGSTOP);
  for (const int signal_number : {SIGINT, SIGQUIT, SIGHUP}) ::kill(first, signal_number);
  wait_a_little();
  CHECK(std::string("SRD").find(state_of(first).letter) != std::string::npos);  // it lives
  ::kill(first, SIGKILL);
  CHECK(ends(first));
  wait_a_little();  // for its last thread, with which its end of the socket goes
  process.send(SIGCONT);
  const pid_t second = image_process_of(process.number());  // for the first output
  CHECK(process.wait() == 0);
  CHECK(state_of(first).letter == 'X');
  CHECK(state_of(second).letter == 'X');
  CHECK(read_picture(folder / "a.png", asked_by).width == 128);
  CHECK(read_picture(folder / "b.exr", asked_by).width == 128);
  CHECK(folder.entries() == 2);
}

TEST_CASE("the process for pictures ends with its vitrum, however that ends") {
  const TemporaryFolder folder;
  for (const int signal_number : {SIGINT, SIGKILL}) {
    VitrumProcess process({"render", default_scene, "-o", folder / "a.png", "--samples", "1000000"});
    const pid_t images = image_process_of(process.number());
    REQUIRE(process.has_said("features:"));
    process.send(signal_number);
    CHECK(process.wait() == -signal_number);
    CHECK(ends(images));
    CHECK(folder.entries() == 0);
  }
}
