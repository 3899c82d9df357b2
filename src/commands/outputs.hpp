#pragma once
// The files that a command is about to write.

#include <string>
#include <vector>

namespace vitrum {

/// Checks, before the work, that `pictures` and the `report` ("": none) can be written. Throws Error for a file that
/// cannot, that is named twice, or that is one of the `inputs`.
void check_outputs(const std::vector<std::string>& pictures, const std::string& report,
                   const std::vector<std::string>& inputs = {});

}  // namespace vitrum
