#pragma once
// The rows of the group `slab-and-ball` whose bodies are meshes; pictures of size x size pixels.

#include <vector>

#include "verify/check.hpp"

namespace vitrum {

std::vector<CheckResult> check_mesh_furnace(const CheckContext& context, int size);
std::vector<CheckResult> check_mesh_ball(const CheckContext& context, int size);
std::vector<CheckResult> check_touching_layers(const CheckContext& context, int size);
std::vector<CheckResult> check_mesh_shells(const CheckContext& context, int size);

}  // namespace vitrum
