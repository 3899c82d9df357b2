#pragma once
// Kernels with a fault, to see it noticed.

#include <doctest/doctest.h>

#include <filesystem>
#include <string>

#include "temporary_folder.hpp"

namespace vitrum {

/// The kernels with `right` replaced by `wrong` in one of their files.
struct BrokenKernels {
  TemporaryFolder folder;

  BrokenKernels(const std::string& file, const std::string& right, const std::string& wrong) {
    std::filesystem::copy(VITRUM_SOURCE_DIR "/kernels", folder.path(), std::filesystem::copy_options::recursive);
    std::string text = file_bytes(folder / file);
    const size_t at = text.find(right);
    REQUIRE(at != std::string::npos);
    put_file(folder / file, text.replace(at, right.size(), wrong));
  }
};

}  // namespace vitrum
