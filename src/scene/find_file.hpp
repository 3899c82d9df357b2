#pragma once
// Files as OBJ and MTL name them: beside the file that names them, with backslashes, quotes or a comment behind.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace vitrum {

/// `name` as it counts from the folder of the file `named_in`, slashes for backslashes; it need not exist.
std::string path_beside(const std::string& named_in, std::string_view name);

/// The file that `name`, written in `named_in`, stands for, if there is one: as it stands, with backslashes as slashes,
/// without quotes, or without the comment behind it; the first of these that exists.
std::optional<std::string> find_file(const std::string& named_in, std::string_view name);

/// The names in a list such as "a.mtl b c.mtl", written in `named_in`, where names themselves may hold spaces: the
/// whole if that is a file, else what ends in `extension` (of any case), or single words if only they are files.
std::vector<std::string_view> split_file_names(const std::string& named_in, std::string_view list,
                                               std::string_view extension);

}  // namespace vitrum
