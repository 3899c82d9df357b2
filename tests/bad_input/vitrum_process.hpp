#pragma once
// Runs build/release/vitrum as a user does, and takes down what it says and how it ends.

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "temporary_folder.hpp"

extern char** environ;

/// A vitrum that runs. Its environment is the test's, with the `settings` ("NAME=value") in front; `program` may be a
/// copy that stands elsewhere.
class VitrumProcess {
 public:
  explicit VitrumProcess(std::vector<std::string> arguments, std::vector<std::string> settings = {},
                         const std::string& program = VITRUM_BINARY_DIR "/vitrum") {
    arguments.insert(arguments.begin(), program);
    for (char** entry = environ; *entry != nullptr; ++entry) {
      const std::string name = std::string(*entry).substr(0, std::string(*entry).find('=') + 1);
      bool is_set = false;
      for (const std::string& setting : settings) is_set = is_set || setting.rfind(name, 0) == 0;
      if (!is_set) settings.push_back(*entry);
    }
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, (folder_ / "out").c_str(), O_WRONLY | O_CREAT, 0600);
    posix_spawn_file_actions_addopen(&files, STDERR_FILENO, (folder_ / "err").c_str(), O_WRONLY | O_CREAT, 0600);
    const int fault = posix_spawn(&process_, program.c_str(), &files, nullptr, pointers(arguments).data(),
                                  pointers(settings).data());
    posix_spawn_file_actions_destroy(&files);
    if (fault != 0) throw std::runtime_error("vitrum does not start");
  }
  ~VitrumProcess() {
    if (process_ == 0) return;
    ::kill(process_, SIGKILL);
    wait();
  }
  VitrumProcess(const VitrumProcess&) = delete;
  VitrumProcess& operator=(const VitrumProcess&) = delete;

  /// What it has printed so far.
  std::string out() const { return vitrum::file_bytes(folder_ / "out"); }
  std::string err() const { return vitrum::file_bytes(folder_ / "err"); }

  /// Waits until `text` stands on standard error; false if that takes more than 30 s.
  bool has_said(const std::string& text) const {
    for (int i = 0; i < 3000; ++i) {
      if (err().find(text) != std::string::npos) return true;
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
    }
    return false;
  }
  pid_t number() const { return process_; }
  void send(int signal_number) const { ::kill(process_, signal_number); }

  /// Waits for the end: the exit code, or minus the number of the signal that ended it.
  int wait() {
    int status = 0;
    ::waitpid(process_, &status, 0);
    process_ = 0;
    return WIFSIGNALED(status) ? -WTERMSIG(status) : WEXITSTATUS(status);
  }

 private:
  static std::vector<char*> pointers(std::vector<std::string>& texts) {
    std::vector<char*> all;
    for (std::string& text : texts) all.push_back(text.data());
    all.push_back(nullptr);
    return all;
  }

  vitrum::TemporaryFolder folder_;
  pid_t process_ = 0;
};

struct Ended {
  int code;
  std::string out, err;
};

/// Runs vitrum to its end.
inline Ended vitrum_run(const std::vector<std::string>& arguments, const std::vector<std::string>& settings = {},
                        const std::string& program = VITRUM_BINARY_DIR "/vitrum") {
  VitrumProcess process(arguments, settings, program);
  const int code = process.wait();
  return {code, process.out(), process.err()};
}
