#pragma once
// Just enough OpenCL for the tests of the tree: the first device, kernels from text, buffers from vectors.

#include <stdexcept>
#include <string>
#include <vector>

#include "device/opencl.hpp"

namespace vitrum {

class OpenClHarness {
 public:
  OpenClHarness() : context_(CL_DEVICE_TYPE_ALL), queue_(context_) {}

  cl::Program build(const std::string& source, const std::string& options = "") const {
    cl::Program program(context_, source);
    const cl::Device device = context_.getInfo<CL_CONTEXT_DEVICES>().front();
    try {
      const std::string all = "-cl-std=CL1.2 -I " VITRUM_SOURCE_DIR "/kernels " + options + rounding_options(device);
      program.build(all.c_str());
    } catch (const cl::Error&) {
      throw std::runtime_error(program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device));
    }
    return program;
  }

  template <typename T>
  cl::Buffer upload(const std::vector<T>& data) const {
    if (data.empty()) return cl::Buffer(context_, CL_MEM_READ_WRITE, sizeof(T));
    return cl::Buffer(context_, CL_MEM_READ_WRITE | CL_MEM_COPY_HOST_PTR, data.size() * sizeof(T),
                      const_cast<T*>(data.data()));
  }

  template <typename T>
  std::vector<T> download(const cl::Buffer& buffer, size_t count) const {
    std::vector<T> data(count);
    queue_.enqueueReadBuffer(buffer, CL_TRUE, 0, count * sizeof(T), data.data());
    return data;
  }

  /// Runs `count` work-items, a multiple of 64, and waits for them.
  template <typename... Arguments>
  void run(const cl::Program& program, const char* kernel_name, size_t count, const Arguments&... arguments) const {
    cl::Kernel kernel(program, kernel_name);
    cl_uint index = 0;
    (kernel.setArg(index++, arguments), ...);
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(count), cl::NDRange(64));
    queue_.finish();
  }

 private:
  cl::Context context_;
  cl::CommandQueue queue_;
};

}  // namespace vitrum
