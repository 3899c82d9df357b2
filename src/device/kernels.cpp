#include "device/kernels.hpp"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "core/error.hpp"
#include "device/kernel_source.hpp"

namespace vitrum {
namespace {

std::string kernel_text(const KernelFiles& files, const std::string& name) {
  if (files.folder.empty()) {
    for (const KernelFile& file : embedded_kernels())
      if (file.name == name) return file.text;
    throw Error({"kernels/" + name, 0, 0}, "this kernel file is not in the binary", "rebuild vitrum");
  }
  const std::string path = files.folder + "/" + name;
  std::ifstream in(path, std::ios::binary);
  std::stringstream text;
  if (std::filesystem::is_regular_file(path)) text << in.rdbuf();
  if (!std::filesystem::is_regular_file(path) || !in)
    throw Error({path, 0, 0}, "this kernel file cannot be read", "give --kernels the folder kernels/ of vitrum's sources");
  return text.str();
}

void expand(const KernelFiles& files, const std::string& name, std::set<std::string>& seen, std::string& out) {
  if (!seen.insert(name).second) return;
  std::istringstream lines(kernel_text(files, name));
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    if (line.rfind("#include \"", 0) == 0) {
      expand(files, line.substr(10, line.find('"', 10) - 10), seen, out);
      out += "#line " + std::to_string(number + 1) + " \"" + name + "\"\n";
    } else {
      out += line + '\n';
    }
  }
}

}  // namespace

std::string kernel_source(const KernelFiles& files, const std::vector<std::string>& names) {
  std::set<std::string> seen;
  std::string out;
  for (const std::string& name : names) {
    out += "#line 1 \"" + name + "\"\n";
    expand(files, name, seen, out);
  }
  return out;
}

Kernels::Kernels(const Device& device, const KernelFiles& files, const std::vector<std::string>& stages,
                 const std::string& options) {
  const auto start = std::chrono::steady_clock::now();
  const std::string all_options = "-cl-std=CL1.2" + options;
  // One program: drivers read their built-in functions anew for each, and compile one after the other anyway.
  std::vector<std::string> names;
  for (const std::string& stage : stages) names.push_back("stages/" + stage + ".cl");
  const std::string source = kernel_source(files, names);
  if (!files.dump_folder.empty()) {
    std::error_code ignored;  // what matters is whether the file can be written
    std::filesystem::create_directories(files.dump_folder, ignored);
    std::ofstream dump(files.dump_folder + "/vitrum.cl");
    dump << "// " << all_options << " -DWIDTH=" << device.width() << "\n" << source;
    if (!dump)
      throw Error({files.dump_folder, 0, 0}, "kernels cannot be written here", "give --dump-kernels another folder");
  }
  program_ = device.build("vitrum.cl", source, all_options);
  build_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

cl::Kernel Kernels::get(const std::string& name) const { return cl::Kernel(program_, name.c_str()); }

}  // namespace vitrum
