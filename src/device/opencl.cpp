#include "device/opencl.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <mutex>

#include "core/error.hpp"

namespace vitrum {
namespace {

std::vector<cl::Device> all_devices() {
  std::vector<cl::Platform> platforms;
  try {
    cl::Platform::get(&platforms);
  } catch (const cl::Error&) {
    // No platform at all is told below, as no device.
  }
  std::vector<cl::Device> devices;
  for (const cl::Platform& platform : platforms) {
    std::vector<cl::Device> own;
    try {
      platform.getDevices(CL_DEVICE_TYPE_ALL, &own);
    } catch (const cl::Error&) {
      // A platform without devices answers with an error.
    }
    devices.insert(devices.end(), own.begin(), own.end());
  }
  return devices;
}

DeviceInfo describe(const cl::Device& device) {
  DeviceInfo info;
  info.name = device.getInfo<CL_DEVICE_NAME>();
  info.platform = cl::Platform(device.getInfo<CL_DEVICE_PLATFORM>()).getInfo<CL_PLATFORM_NAME>();
  info.version = device.getInfo<CL_DEVICE_VERSION>();
  info.driver = device.getInfo<CL_DRIVER_VERSION>();
  info.is_cpu = (device.getInfo<CL_DEVICE_TYPE>() & CL_DEVICE_TYPE_CPU) != 0;
  info.compute_units = device.getInfo<CL_DEVICE_MAX_COMPUTE_UNITS>();
  const auto partitions = device.getInfo<CL_DEVICE_PARTITION_PROPERTIES>();
  info.can_be_split = info.compute_units > 1 && std::find(partitions.begin(), partitions.end(),
                                                          CL_DEVICE_PARTITION_BY_COUNTS) != partitions.end();
  info.memory = device.getInfo<CL_DEVICE_GLOBAL_MEM_SIZE>();
  info.max_allocation = device.getInfo<CL_DEVICE_MAX_MEM_ALLOC_SIZE>();
  auto lacks = [&info](const std::string& what) {
    info.usable = false;
    info.shortfall = what;
  };
  if (info.version < "OpenCL 1.2") lacks("OpenCL 1.2 is needed");
  if (!device.getInfo<CL_DEVICE_COMPILER_AVAILABLE>()) lacks("it has no compiler");
  if (!device.getInfo<CL_DEVICE_ENDIAN_LITTLE>()) lacks("it is not little-endian");
  return info;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

[[noreturn]] void fail(const cl::Error& error, const std::string& doing, const std::string& mend) {
  throw Error({}, "OpenCL: " + doing + " failed with " + opencl_error_name(error.err()), mend);
}

cl::Device part_of(cl::Device device, unsigned compute_units) {
  const cl_device_partition_property counts[] = {CL_DEVICE_PARTITION_BY_COUNTS,
                                                 static_cast<cl_device_partition_property>(compute_units),
                                                 CL_DEVICE_PARTITION_BY_COUNTS_LIST_END, 0};
  std::vector<cl::Device> parts;
  device.createSubDevices(counts, &parts);
  // PoCL 3.1's threads look at the device of a command that the host has waited for already: what is split off stays.
  static std::mutex mutex;
  static std::vector<cl::Device>& kept = *new std::vector<cl::Device>;
  const std::lock_guard lock(mutex);
  return kept.emplace_back(parts.at(0));
}

}  // namespace

void prepare_opencl(unsigned threads) {
  if (threads > 0) setenv("POCL_MAX_PTHREAD_COUNT", std::to_string(threads).c_str(), 1);
  // Without a folder for its cache PoCL offers no device at all.
  const char* home = std::getenv("HOME");
  const bool has_home = home != nullptr && access(home, W_OK) == 0;
  if (!has_home && std::getenv("POCL_CACHE_DIR") == nullptr && std::getenv("XDG_CACHE_HOME") == nullptr) {
    const std::filesystem::path folder =
        std::filesystem::temp_directory_path() / ("vitrum-pocl-" + std::to_string(getuid()));
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    setenv("POCL_CACHE_DIR", folder.c_str(), 1);
  }
}

std::vector<DeviceInfo> list_devices() {
  std::vector<DeviceInfo> infos;
  for (const cl::Device& device : all_devices()) infos.push_back(describe(device));
  return infos;
}

std::string rounding_options(const cl::Device& device) {
  const bool can = device.getInfo<CL_DEVICE_SINGLE_FP_CONFIG>() & CL_FP_CORRECTLY_ROUNDED_DIVIDE_SQRT;
  return can ? " -cl-fp32-correctly-rounded-divide-sqrt" : "";
}

std::string opencl_error_name(int code) {
  const char* name = "an unknown error";
  switch (code) {
    case CL_DEVICE_NOT_FOUND: name = "CL_DEVICE_NOT_FOUND"; break;
    case CL_DEVICE_NOT_AVAILABLE: name = "CL_DEVICE_NOT_AVAILABLE"; break;
    case CL_COMPILER_NOT_AVAILABLE: name = "CL_COMPILER_NOT_AVAILABLE"; break;
    case CL_MEM_OBJECT_ALLOCATION_FAILURE: name = "CL_MEM_OBJECT_ALLOCATION_FAILURE"; break;
    case CL_OUT_OF_RESOURCES: name = "CL_OUT_OF_RESOURCES"; break;
    case CL_OUT_OF_HOST_MEMORY: name = "CL_OUT_OF_HOST_MEMORY"; break;
    case CL_BUILD_PROGRAM_FAILURE: name = "CL_BUILD_PROGRAM_FAILURE"; break;
    case CL_INVALID_VALUE: name = "CL_INVALID_VALUE"; break;
    case CL_INVALID_BUFFER_SIZE: name = "CL_INVALID_BUFFER_SIZE"; break;
    case CL_INVALID_BUILD_OPTIONS: name = "CL_INVALID_BUILD_OPTIONS"; break;
    case CL_INVALID_KERNEL_NAME: name = "CL_INVALID_KERNEL_NAME"; break;
    case CL_INVALID_ARG_INDEX: name = "CL_INVALID_ARG_INDEX"; break;
    case CL_INVALID_ARG_SIZE: name = "CL_INVALID_ARG_SIZE"; break;
    case CL_INVALID_KERNEL_ARGS: name = "CL_INVALID_KERNEL_ARGS"; break;
    case CL_DEVICE_PARTITION_FAILED: name = "CL_DEVICE_PARTITION_FAILED"; break;
    case CL_INVALID_DEVICE_PARTITION_COUNT: name = "CL_INVALID_DEVICE_PARTITION_COUNT"; break;
    case CL_INVALID_WORK_GROUP_SIZE: name = "CL_INVALID_WORK_GROUP_SIZE"; break;
    case CL_MISALIGNED_SUB_BUFFER_OFFSET: name = "CL_MISALIGNED_SUB_BUFFER_OFFSET"; break;
    default: break;
  }
  return std::string(name) + " (" + std::to_string(code) + ")";
}

Device::Device(const std::string& choice, unsigned group_size, unsigned width, unsigned compute_units)
    : group_size_(group_size), width_(width) {
  const std::vector<cl::Device> devices = all_devices();
  if (devices.empty())
    throw Error({}, "no OpenCL device was found", "install one, for a CPU: apt-get install pocl-opencl-icd");
  int chosen = -1;
  const bool is_number = !choice.empty() && choice.find_first_not_of("0123456789") == std::string::npos;
  for (size_t i = 0; i < devices.size() && chosen < 0; ++i) {
    const DeviceInfo info = describe(devices[i]);
    const bool fits = choice.empty() ? info.is_cpu
                      : is_number    ? std::to_string(i) == choice
                                     : lower(info.name + " " + info.platform).find(lower(choice)) != std::string::npos;
    if (fits && (info.usable || !choice.empty())) chosen = static_cast<int>(i);
  }
  if (chosen < 0 && choice.empty()) chosen = 0;
  if (chosen < 0) {
    std::string names;
    for (size_t i = 0; i < devices.size(); ++i)
      names += (i ? ", " : "") + std::to_string(i) + " (" + describe(devices[i]).name + ")";
    throw Error({"--device " + choice}, "there is no such device",
                "choose by number, or by a piece of the name, among " + names);
  }
  device_ = devices[static_cast<size_t>(chosen)];
  info_ = describe(device_);
  if (!info_.usable)
    throw Error({}, "the device '" + info_.name + "' cannot be used: " + info_.shortfall,
                "choose another that `vitrum devices` lists");
  try {
    if (compute_units > 0) {
      device_ = part_of(device_, compute_units);
      info_ = describe(device_);
    }
    context_ = cl::Context(device_);
    queue_ = cl::CommandQueue(context_, device_, CL_QUEUE_PROFILING_ENABLE);
    // On GPUs the work-items are the lanes.
    const unsigned lanes = info_.is_cpu ? device_.getInfo<CL_DEVICE_NATIVE_VECTOR_WIDTH_FLOAT>() : 1;
    if (width_ == 0) width_ = lanes >= 16 ? 16 : lanes >= 8 ? 8 : lanes >= 4 ? 4 : 1;
    build_options_ = rounding_options(device_) + " -DWIDTH=" + std::to_string(width_);
    const size_t largest = device_.getInfo<CL_DEVICE_MAX_WORK_GROUP_SIZE>();
    group_size_ = static_cast<unsigned>(std::clamp<size_t>(group_size_, 1, largest));
  } catch (const cl::Error& error) {
    fail(error, "starting the device '" + info_.name + "'", "choose another with --device, or update its driver");
  }
}

cl::Program Device::build(const std::string& name, const std::string& source, const std::string& options) const {
  cl::Program program(context_, source);
  try {
    program.build({device_}, (options + build_options_).c_str());
  } catch (const cl::Error& error) {
    const std::string log = program.getBuildInfo<CL_PROGRAM_BUILD_LOG>(device_).substr(0, 2000);  // the first cause
    throw Error({"kernels/" + name, 0, 0},
                "the kernel does not build on '" + info_.name + "' (" + opencl_error_name(error.err()) + "):\n" + log,
                "report this with the output of `vitrum devices`");
  }
  return program;
}

cl::Buffer Device::allocate_bytes(size_t bytes, const char* purpose) {
  const std::string size = std::to_string((bytes + 1048575) / 1048576) + " MiB for " + purpose;
  const char* mend = "use fewer photons, fewer pixels or a smaller mesh, or another device";
  if (bytes > info_.max_allocation)
    throw Error({}, "the device cannot give " + size + " in one piece (it gives " +
                        std::to_string(info_.max_allocation / 1048576) + " MiB)", mend);
  try {
    cl::Buffer buffer(context_, CL_MEM_READ_WRITE, bytes);
    memory_[purpose] += bytes;
    return buffer;
  } catch (const cl::Error& error) {
    fail(error, "getting " + size, mend);
  }
}

void Device::write_bytes(const cl::Buffer& buffer, size_t offset, size_t bytes, const void* data) {
  try {
    queue_.enqueueWriteBuffer(buffer, CL_TRUE, offset, bytes, data);
  } catch (const cl::Error& error) {
    fail(error, "copying to the device", "another device may do better (--device)");
  }
}

void Device::read_bytes(const cl::Buffer& buffer, size_t offset, size_t bytes, void* data) {
  try {
    queue_.enqueueReadBuffer(buffer, CL_TRUE, offset, bytes, data);
  } catch (const cl::Error& error) {
    fail(error, "copying from the device", "another device may do better (--device)");
  }
}

void Device::copy_bytes(const cl::Buffer& from, size_t offset, const cl::Buffer& to, size_t to_offset, size_t bytes) {
  try {
    queue_.enqueueCopyBuffer(from, to, offset, to_offset, bytes);
  } catch (const cl::Error& error) {
    fail(error, "copying on the device", "another device may do better (--device)");
  }
}

void Device::fill_zero_bytes(const cl::Buffer& buffer, size_t bytes) {
  try {
    queue_.enqueueFillBuffer(buffer, cl_uchar{0}, 0, bytes);
  } catch (const cl::Error& error) {
    fail(error, "clearing device memory", "another device may do better (--device)");
  }
}

void Device::launch(const std::string& stage, const cl::Kernel& kernel, size_t count) {
  launch_groups(stage, kernel, count, group_size_);
}

void Device::launch_singly(const std::string& stage, const cl::Kernel& kernel, size_t count) {
  launch_groups(stage, kernel, count, info_.is_cpu ? 1 : group_size_);
}

void Device::launch_groups(const std::string& stage, const cl::Kernel& kernel, size_t count, size_t group_size) {
  if (count == 0) return;
  const size_t rounded = (count + group_size - 1) / group_size * group_size;
  try {
    cl::Event event;
    queue_.enqueueNDRangeKernel(kernel, cl::NullRange, cl::NDRange(rounded), cl::NDRange(group_size), nullptr, &event);
    launched_.emplace_back(stage, event);
  } catch (const cl::Error& error) {
    fail(error, "the stage '" + stage + "'", "another device may do better (--device)");
  }
  // Events hold memory in the driver; now and then those that are done are booked.
  if (launched_.size() >= 4096) collect_timings();
}

void Device::finish() {
  try {
    queue_.finish();
  } catch (const cl::Error& error) {
    fail(error, "a kernel", "another device may do better (--device)");
  }
}

void Device::collect_timings() {
  finish();
  for (const auto& [stage, event] : launched_)
    seconds_[stage] += 1e-9 * static_cast<double>(event.getProfilingInfo<CL_PROFILING_COMMAND_END>() -
                                                  event.getProfilingInfo<CL_PROFILING_COMMAND_START>());
  launched_.clear();
}

std::map<std::string, double> Device::stage_seconds() {
  collect_timings();
  return seconds_;
}

}  // namespace vitrum
