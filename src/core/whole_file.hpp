#pragma once
// Output files that appear whole or not at all.

#include <string>
#include <string_view>

namespace vitrum {

/// Checks that `write_whole_file(path, ...)` can be expected to succeed: the folder exists and takes new files, and what
/// stands at `path`, if anything, is an ordinary file that may be replaced. Leaves nothing behind and does not touch
/// the file at `path`. Throws Error at {path}.
void check_whole_file(const std::string& path);

/// Writes `bytes` to `path`: into a temporary file beside it, which takes its place in one step when all of it is on
/// the disk. On failure, and on SIGINT, SIGTERM or SIGHUP, the temporary file is removed and `path` is as it was.
/// A symbolic link is followed; the permissions of a file that is replaced are kept. Throws Error at {path}.
void write_whole_file(const std::string& path, std::string_view bytes);

}  // namespace vitrum
