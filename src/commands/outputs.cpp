#include "commands/outputs.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

#include "core/error.hpp"
#include "core/whole_file.hpp"
#include "film/images.hpp"

namespace vitrum {

void check_outputs(const std::vector<std::string>& pictures, const std::string& report,
                   const std::vector<std::string>& inputs) {
  std::set<std::filesystem::path> files;
  const auto check_alone = [&](const std::string& output) {
    const std::filesystem::path file = std::filesystem::weakly_canonical(output);
    const auto is_it = [&file](const std::string& input) {
      std::error_code no_path;  // what is wrong with an input is said when it is read
      return std::filesystem::weakly_canonical(input, no_path) == file;
    };
    if (std::any_of(inputs.begin(), inputs.end(), is_it))
      throw Error({output}, "this file is to be read and written", "give what is written a name of its own");
    if (!files.insert(file).second)
      throw Error({output}, "this file is to be written twice", "give every picture and the report a name of its own");
  };
  for (const std::string& picture : pictures) {
    check_writable(picture);
    check_alone(picture);
  }
  if (!report.empty()) {
    check_whole_file(report);
    check_alone(report);
  }
}

}  // namespace vitrum
