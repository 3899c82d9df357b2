#include <doctest/doctest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>

#include "core/error.hpp"
#include "core/whole_file.hpp"
#include "temporary_folder.hpp"

using namespace vitrum;
namespace fs = std::filesystem;

TEST_CASE("a whole file is written, replaced, and leaves nothing beside it") {
  const TemporaryFolder folder;
  const std::string path = folder / "result.json";
  write_whole_file(path, "first");
  CHECK(file_bytes(path) == "first");
  const std::string large(3'000'000, 'x');
  write_whole_file(path, large);
  CHECK(file_bytes(path) == large);
  write_whole_file(path, "");
  CHECK(file_bytes(path).empty());
  CHECK(folder.entries() == 1);
}

TEST_CASE("the longest name that a folder takes is not too long") {
  const TemporaryFolder folder;
  const std::string path = folder / std::string(255, 'n');
  check_whole_file(path);
  write_whole_file(path, "x");
  CHECK(file_bytes(path) == "x");
}

TEST_CASE("permissions: the user's mask for a new file, the old ones for a replaced file") {
  const TemporaryFolder folder;
  const std::string path = folder / "x";
  const mode_t mask = ::umask(027);
  write_whole_file(path, "x");
  ::umask(mask);
  CHECK((fs::status(path).permissions() & fs::perms::mask) == fs::perms(0640));
  fs::permissions(path, fs::perms(0604));
  write_whole_file(path, "y");
  CHECK((fs::status(path).permissions() & fs::perms::mask) == fs::perms(0604));
}

TEST_CASE("a symbolic link stays one") {
  const TemporaryFolder folder;
  put_file(folder / "real", "old");
  fs::create_symlink("real", folder / "link");
  check_whole_file(folder / "link");
  write_whole_file(folder / "link", "new");
  CHECK(fs::is_symlink(folder / "link"));
  CHECK(file_bytes(folder / "real") == "new");
}

TEST_CASE("the check neither makes nor changes the file") {
  const TemporaryFolder folder;
  check_whole_file(folder / "new");
  CHECK(folder.entries() == 0);
  put_file(folder / "old", "content");
  const auto time = fs::last_write_time(folder / "old");
  check_whole_file(folder / "old");
  CHECK(file_bytes(folder / "old") == "content");
  CHECK(fs::last_write_time(folder / "old") == time);
  CHECK(folder.entries() == 1);
}

TEST_CASE("a signal during the writing removes the temporary file and leaves the target") {
  const TemporaryFolder folder;
  const std::string path = folder / "x";
  put_file(path, "old");
  for (const int signal_number : {SIGINT, SIGTERM, SIGHUP}) {
    const pid_t child = ::fork();
    if (child == 0) {
      ::signal(signal_number, SIG_DFL);  // doctest has handlers of its own
      // Writes over and over, so that the signal meets it in the middle.
      const std::string large(20'000'000, 'y');
      for (;;) write_whole_file(path, large);
    }
    const auto half_written = [&] {
      for (const auto& entry : fs::directory_iterator(folder.path())) {
        if (entry.path().extension() == ".part") return true;
      }
      return false;
    };
    int polls = 0;
    while (!half_written() && ++polls < 10'000'000) {
    }
    ::kill(child, signal_number);
    int status = 0;
    ::waitpid(child, &status, 0);
    REQUIRE(WIFSIGNALED(status));
    CHECK(WTERMSIG(status) == signal_number);
    CHECK(folder.entries() == 1);
    const std::string bytes = file_bytes(path);
    CHECK((bytes == "old" || bytes == std::string(20'000'000, 'y')));
  }
}

TEST_CASE("signals are as they were, and those that the program ignores are left to it") {
  const TemporaryFolder folder;
  for (const auto handler : {SIG_IGN, SIG_DFL}) {
    const auto before = ::signal(SIGHUP, handler);
    write_whole_file(folder / "x", "x");
    CHECK((::signal(SIGHUP, before) == handler));
  }
}
