#include <cstdio>

#include "commands/commands.hpp"
#include "core/error.hpp"
#include "device/opencl.hpp"

namespace vitrum {
namespace {

void run_devices() {
  prepare_opencl(0);
  const std::vector<DeviceInfo> devices = list_devices();
  if (devices.empty())
    throw Error({}, "no OpenCL device was found", "install one, for a CPU: apt-get install pocl-opencl-icd");
  for (size_t i = 0; i < devices.size(); ++i) {
    const DeviceInfo& d = devices[i];
    std::printf("%zu  %s\n", i, d.name.c_str());
    std::printf("   %s, %s, driver %s\n", d.platform.c_str(), d.version.c_str(), d.driver.c_str());
    std::printf("   %s, %u compute units, %.1f GiB memory, %.1f GiB in one piece\n", d.is_cpu ? "CPU" : "GPU or other",
                d.compute_units, static_cast<double>(d.memory) / 0x1p30, static_cast<double>(d.max_allocation) / 0x1p30);
    std::printf("   %s\n", d.usable ? "can render" : ("cannot render: " + d.shortfall).c_str());
  }
}

}  // namespace

void add_devices_command(CLI::App& app) {
  CLI::App* command = app.add_subcommand("devices", "List the OpenCL devices and what each can do");
  command->callback(run_devices);
}

}  // namespace vitrum
