#pragma once
// The one file that wraps OpenCL: devices, buffers, launches, timings, and errors turned into vitrum::Error.

#define CL_HPP_TARGET_OPENCL_VERSION 120
#define CL_HPP_MINIMUM_OPENCL_VERSION 120
#define CL_HPP_ENABLE_EXCEPTIONS
#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wignored-attributes"
#pragma GCC diagnostic ignored "-Wpedantic"
#pragma GCC diagnostic ignored "-Wshadow"
#endif
#include <CL/opencl.hpp>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include <map>
#include <string>
#include <vector>

namespace vitrum {

/// What `vitrum devices` shows of a device.
struct DeviceInfo {
  std::string name, platform, version, driver;
  bool is_cpu = false;
  unsigned compute_units = 0;
  bool can_be_split = false;    ///< into parts of some compute units each
  uint64_t memory = 0;          ///< [bytes]
  uint64_t max_allocation = 0;  ///< [bytes]
  bool usable = true;           ///< has OpenCL C 1.2, a compiler and what vitrum's kernels need
  std::string shortfall;        ///< why not
};

/// Says how many threads a CPU device may use (0: all). To be called before any other function here: PoCL reads it once.
/// Also gives PoCL a cache folder where the home directory cannot be written.
void prepare_opencl(unsigned threads);

/// All devices of all platforms, in OpenCL's order.
std::vector<DeviceInfo> list_devices();

/// The build options by which `device` rounds quotients and square roots correctly, "" where it cannot: OpenCL 1.2 grants
/// 2.5 and 3 ulp otherwise, which GPUs make use of.
std::string rounding_options(const cl::Device& device);

/// `text` in a form that an OpenCL error is told in: "CL_OUT_OF_RESOURCES (-5)".
std::string opencl_error_name(int code);

/// An array of T in device memory. Freed with the last copy.
template <typename T>
class Buffer {
 public:
  Buffer() = default;
  Buffer(cl::Buffer buffer, size_t count) : buffer_(std::move(buffer)), count_(count) {}
  size_t size() const { return count_; }
  const cl::Buffer& cl() const { return buffer_; }

 private:
  cl::Buffer buffer_;
  size_t count_ = 0;
};

/// A device with its context and its one in-order queue. Not copyable; outlives its buffers and kernels.
class Device {
 public:
  /// `choice`: "" takes the first CPU, else the first device; a number as `vitrum devices` counts them, or a piece of
  /// a device's or platform's name. `group_size`: work-items per group; pictures do not depend on it. `width`: rays per
  /// work-item, 1, 4, 8 or 16; 0 takes what suits the device. `compute_units`: takes a part of so many, which on a CPU are
  /// threads; 0 takes all. Throws Error if the device cannot be split so.
  explicit Device(const std::string& choice = "", unsigned group_size = 32, unsigned width = 0,
                  unsigned compute_units = 0);
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  const DeviceInfo& info() const { return info_; }
  /// Rays per work-item: kernels/portability.h's WIDTH.
  unsigned width() const { return width_; }
  /// Work-items for `count` entries of a kernel that takes WIDTH of them at a time.
  size_t packets(size_t count) const { return (count + width_ - 1) / width_; }

  /// Builds `source`; a failure shows the compiler's log and is our bug or the driver's.
  cl::Program build(const std::string& name, const std::string& source, const std::string& options) const;

  /// Room for `count` values, not initialised. Throws Error if the device has no such room.
  template <typename T>
  Buffer<T> allocate(size_t count, const char* purpose) {
    return {allocate_bytes(std::max<size_t>(count, 1) * sizeof(T), purpose), count};
  }
  /// A buffer with a copy of `values`.
  template <typename T>
  Buffer<T> upload(const std::vector<T>& values, const char* purpose) {
    Buffer<T> buffer = allocate<T>(values.size(), purpose);
    if (!values.empty()) write_bytes(buffer.cl(), 0, values.size() * sizeof(T), values.data());
    return buffer;
  }
  template <typename T>
  void write(const Buffer<T>& buffer, const std::vector<T>& values) {
    write_bytes(buffer.cl(), 0, values.size() * sizeof(T), values.data());
  }
  /// Waits for all that was launched, then copies values [first, first + count) back.
  template <typename T>
  std::vector<T> read(const Buffer<T>& buffer, size_t first, size_t count) {
    std::vector<T> values(count);
    if (count > 0) read_bytes(buffer.cl(), first * sizeof(T), count * sizeof(T), values.data());
    return values;
  }
  /// Copies `count` values from value `first` of `from` on to value `to_first` of `to` on; they do not overlap.
  template <typename T>
  void copy(const Buffer<T>& from, size_t first, const Buffer<T>& to, size_t to_first, size_t count) {
    if (count > 0) copy_bytes(from.cl(), first * sizeof(T), to.cl(), to_first * sizeof(T), count * sizeof(T));
  }
  template <typename T>
  void fill_zero(const Buffer<T>& buffer) {
    fill_zero_bytes(buffer.cl(), std::max<size_t>(buffer.size(), 1) * sizeof(T));
  }
  /// Launches `kernel` on `count` work-items (rounded up to whole groups); its time is booked under `stage`.
  void launch(const std::string& stage, const cl::Kernel& kernel, size_t count);
  /// The same for a few work-items that each have much to do: every one is a group, so that threads share them.
  void launch_singly(const std::string& stage, const cl::Kernel& kernel, size_t count);
  void finish();

  /// Seconds that the kernels of each stage ran, by the device's own clock; waits for all.
  std::map<std::string, double> stage_seconds();
  /// Bytes in buffers that this device has handed out, by purpose.
  const std::map<std::string, uint64_t>& memory_by_purpose() const { return memory_; }

 private:
  cl::Buffer allocate_bytes(size_t bytes, const char* purpose);
  void write_bytes(const cl::Buffer& buffer, size_t offset, size_t bytes, const void* data);
  void read_bytes(const cl::Buffer& buffer, size_t offset, size_t bytes, void* data);
  void copy_bytes(const cl::Buffer& from, size_t offset, const cl::Buffer& to, size_t to_offset, size_t bytes);
  void fill_zero_bytes(const cl::Buffer& buffer, size_t bytes);
  void collect_timings();
  void launch_groups(const std::string& stage, const cl::Kernel& kernel, size_t count, size_t group_size);

  DeviceInfo info_;
  cl::Device device_;
  cl::Context context_;
  cl::CommandQueue queue_;
  unsigned group_size_;
  unsigned width_;
  std::string build_options_;
  std::vector<std::pair<std::string, cl::Event>> launched_;
  std::map<std::string, double> seconds_;
  std::map<std::string, uint64_t> memory_;
};

/// Sets arguments `first`, `first + 1`, ... of a kernel; values, structs or Buffers.
template <typename T>
void set_argument(cl::Kernel& kernel, unsigned index, const T& value) {
  kernel.setArg(index, value);
}
template <typename T>
void set_argument(cl::Kernel& kernel, unsigned index, const Buffer<T>& buffer) {
  kernel.setArg(index, buffer.cl());
}
template <typename... Arguments>
void set_arguments(cl::Kernel& kernel, unsigned first, const Arguments&... arguments) {
  (set_argument(kernel, first++, arguments), ...);
}

}  // namespace vitrum
