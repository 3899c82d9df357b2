#include "core/whole_file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <optional>
#include <utility>

#include "core/error.hpp"

namespace vitrum {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, const std::string& problem, int error_number) {
  const std::string reason = error_number != 0 ? std::string(": ") + std::strerror(error_number) : "";
  const char* mend = "choose another place";
  if (error_number == ENOSPC || error_number == EDQUOT) mend = "make room on the disk, or choose another place";
  if (error_number == EACCES || error_number == EPERM) mend = "allow writing there, or choose another place";
  if (error_number == ENAMETOOLONG) mend = "choose a shorter name";
  throw Error({path}, problem + reason, mend);
}

/// The file that a write to `path` means: symbolic links are followed, so that the link itself stays.
fs::path resolved(const std::string& path) {
  std::error_code error;
  fs::path target = fs::canonical(path, error);
  return error ? fs::path(path) : target;
}

fs::path folder_of(const fs::path& target) {
  return target.has_parent_path() ? target.parent_path() : fs::path(".");
}

/// Status of what stands at `target`; nothing, if nothing does. Throws if it cannot be replaced.
std::optional<struct stat> replaceable(const std::string& path, const fs::path& target) {
  struct stat status {};
  if (::stat(target.c_str(), &status) != 0) {
    if (errno == ENOENT) return std::nullopt;
    fail(path, "cannot be written", errno);
  }
  if (S_ISDIR(status.st_mode)) throw Error({path}, "is a folder", "name a file");
  if (!S_ISREG(status.st_mode)) throw Error({path}, "is not an ordinary file", "choose another place");
  if (::access(target.c_str(), W_OK) != 0) fail(path, "exists and may not be replaced", errno);
  return status;
}

// One temporary file exists at a time (`one_at_a_time`), so the signal handler needs to know one name.
std::mutex one_at_a_time;
std::array<char, 4096> temporary_name{};
constexpr std::array<int, 3> deadly_signals{SIGINT, SIGTERM, SIGHUP};

extern "C" void remove_temporary_and_die(int signal_number) {
  ::unlink(temporary_name.data());
  ::raise(signal_number);  // SA_RESETHAND has restored the default, which ends the process when this handler returns
}

/// The temporary file: on the disk from construction to destruction, or until `release`.
class TemporaryFile {
 public:
  TemporaryFile(const std::string& path, const fs::path& folder) {
    // The name of the target is left out: with it, long names would be too long.
    for (int attempt = 0; descriptor_ < 0; ++attempt) {
      name_ = (folder / (".vitrum-" + std::to_string(::getpid()) + "-" + std::to_string(attempt) + ".part")).string();
      if (name_.size() >= temporary_name.size()) fail(path, "cannot be written", ENAMETOOLONG);
      std::memcpy(temporary_name.data(), name_.c_str(), name_.size() + 1);
      catch_signals();
      descriptor_ = ::open(name_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (descriptor_ >= 0) return;
      const int error_number = errno;
      restore_signals();
      if (error_number != EEXIST || attempt == 1000) fail(path, "cannot be written", error_number);
    }
  }
  ~TemporaryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
    if (!released_) ::unlink(name_.c_str());
    restore_signals();
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;

  int descriptor() const { return descriptor_; }
  const std::string& name() const { return name_; }
  bool close() { return ::close(std::exchange(descriptor_, -1)) == 0; }
  void release() { released_ = true; }

 private:
  // A handler that the program has set, or its wish to ignore a signal, goes before ours.
  void catch_signals() {
    for (std::size_t i = 0; i < deadly_signals.size(); ++i) {
      ::sigaction(deadly_signals[i], nullptr, &before_[i]);
      if (before_[i].sa_handler != SIG_DFL) continue;
      struct sigaction ours {};
      ours.sa_handler = remove_temporary_and_die;
      ours.sa_flags = SA_RESETHAND;
      ::sigaction(deadly_signals[i], &ours, nullptr);
    }
  }
  void restore_signals() {
    for (std::size_t i = 0; i < deadly_signals.size(); ++i) {
      if (before_[i].sa_handler == SIG_DFL) ::sigaction(deadly_signals[i], &before_[i], nullptr);
    }
  }

  std::string name_;
  int descriptor_ = -1;
  bool released_ = false;
  std::array<struct sigaction, deadly_signals.size()> before_{};
};

void write_all(const std::string& path, int descriptor, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor, bytes.data(), bytes.size());
    if (written >= 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EINTR) {
      fail(path, "cannot be written", errno);
    }
  }
}

/// Makes the new name last: a rename is in the folder, which has a disk block of its own.
void sync_folder(const fs::path& folder) {
  const int descriptor = ::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  ::fsync(descriptor);
  ::close(descriptor);
}

}  // namespace

void check_whole_file(const std::string& path) {
  if (path.empty()) throw Error({}, "the output has no name", "name a file");
  const fs::path target = resolved(path);
  const fs::path folder = folder_of(target);
  std::error_code error;
  if (!fs::exists(folder, error)) {
    throw Error({path}, "the folder '" + folder.string() + "' does not exist", "make it first, or choose another place");
  }
  if (!fs::is_directory(folder, error)) {
    throw Error({path}, "'" + folder.string() + "' is not a folder", "choose another place");
  }
  replaceable(path, target);
  // A file without a name: proves that the folder takes files, and cannot be left behind.
  const int descriptor = ::open(folder.c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, 0600);
  if (descriptor >= 0) {
    ::close(descriptor);
  } else if (errno == EOPNOTSUPP || errno == EISDIR || errno == EINVAL) {  // not every file system has them
    if (::access(folder.c_str(), W_OK | X_OK) != 0) fail(path, "cannot be written", errno);
  } else {
    fail(path, "cannot be written", errno);
  }
}

void write_whole_file(const std::string& path, std::string_view bytes) {
  const std::lock_guard lock(one_at_a_time);
  const fs::path target = resolved(path);
  const auto before = replaceable(path, target);
  TemporaryFile file(path, folder_of(target));
  write_all(path, file.descriptor(), bytes);
  if (before && ::fchmod(file.descriptor(), before->st_mode & 07777) != 0) fail(path, "cannot be written", errno);
  // Some file systems cannot sync (EINVAL); whatever else fails means that the bytes are not there.
  if (::fsync(file.descriptor()) != 0 && errno != EINVAL) fail(path, "cannot be written", errno);
  if (!file.close()) fail(path, "cannot be written", errno);
  if (::rename(file.name().c_str(), target.c_str()) != 0) fail(path, "cannot be written", errno);
  file.release();
  sync_folder(folder_of(target));
}

}  // namespace vitrum
