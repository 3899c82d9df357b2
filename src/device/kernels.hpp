#pragma once
// Kernels by name: source text put together, built for the scene's features.

#include <string>
#include <vector>

#include "device/opencl.hpp"

namespace vitrum {

/// Where kernels come from and where they are shown.
struct KernelFiles {
  std::string folder;           ///< read from here instead of from the binary (--kernels DIR); "": the binary
  std::string dump_folder;      ///< what was compiled is written here (--dump-kernels DIR); "": nowhere
};

/// The text of kernels/NAME ("checks/fresnel.cl") of each name, one after the other, with every #include "..." replaced
/// by the file, each once. Throws Error for a file that is missing.
std::string kernel_source(const KernelFiles& files, const std::vector<std::string>& names);

/// The kernels of some stages, built for one device and one set of features.
class Kernels {
 public:
  /// Builds kernels/stages/NAME.cl of each stage with `options`. Throws Error.
  Kernels(const Device& device, const KernelFiles& files, const std::vector<std::string>& stages,
          const std::string& options);

  /// A kernel of one of the stages. A name that is not there is our bug.
  cl::Kernel get(const std::string& name) const;
  /// Seconds that building took.
  double build_seconds() const { return build_seconds_; }

 private:
  cl::Program program_;
  double build_seconds_ = 0.0;
};

}  // namespace vitrum
