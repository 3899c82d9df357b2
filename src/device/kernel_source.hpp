#pragma once
// The text of the kernels: embedded in the binary, or read from a folder.

#include <string>
#include <vector>

namespace vitrum {

struct KernelFile {
  std::string name;                         ///< path under kernels/, as in #include
  std::string text;
};

/// Every file under kernels/ as it was when the binary was built.
const std::vector<KernelFile>& embedded_kernels();

}  // namespace vitrum
