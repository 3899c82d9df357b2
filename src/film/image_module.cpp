#include "film/image_module.hpp"

#include <dlfcn.h>
#include <sys/auxv.h>

#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "core/error.hpp"
#include "film/images.hpp"

namespace vitrum {
namespace {

namespace fs = std::filesystem;

constexpr const char* module_file = "vitrum_images.so";

/// The folder of the running program.
fs::path program_folder() {
  std::error_code error;
  fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (error) {  // no /proc, as in a bare chroot
    const char* name = reinterpret_cast<const char*>(::getauxval(AT_EXECFN));
    program = fs::absolute(name ? name : "", error);
  }
  return program.parent_path();
}

/// Either the module's functions or why there are none.
struct OpenedModule {
  const VitrumImageModule* functions = nullptr;
  std::string problem;
};

OpenedModule open_module() {
  const fs::path folder = program_folder();
  const std::vector<fs::path> places{folder / module_file, folder / "../lib/vitrum" / module_file};
  for (const fs::path& place : places) {
    std::error_code error;
    if (!fs::exists(place, error)) continue;
    // RTLD_LOCAL keeps the symbols of its 260 libraries from those of the OpenCL driver. It is never closed: libraries
    // among them do not survive that.
    void* const handle = ::dlopen(place.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) return {nullptr, ::dlerror()};
    const auto entry = reinterpret_cast<VitrumImageModuleEntry>(::dlsym(handle, VITRUM_IMAGE_MODULE_ENTRY));
    const VitrumImageModule* functions = entry ? entry() : nullptr;
    if (!functions || functions->version != VITRUM_IMAGE_MODULE_VERSION) {
      return {nullptr, place.string() + " is of another version"};
    }
    return {functions, ""};
  }
  return {nullptr, "there is neither " + places[0].string() + " nor " + places[1].string()};
}

const OpenedModule& opened_module() {
  static const OpenedModule module = open_module();
  return module;
}

}  // namespace

const VitrumImageModule& image_module(const SourceLocation& asked_by) {
  const OpenedModule& module = opened_module();
  if (!module.functions) {
    throw Error(asked_by, "the module for pictures cannot be opened: " + module.problem,
                std::string("build or install vitrum again, with ") + module_file + " beside the program");
  }
  return *module.functions;
}

void preload_image_module() {
  // Joined when the program ends: a library that is being opened must not meet its own destruction.
  static const std::jthread opener([] { opened_module(); });
}

}  // namespace vitrum
