#pragma once
// The groups of checks, one file each; check.cpp lists them.

#include "verify/check.hpp"

namespace vitrum {

std::vector<CheckResult> check_interface(const CheckContext& context);
std::vector<CheckResult> check_absorption(const CheckContext& context);
std::vector<CheckResult> check_slab_and_ball(const CheckContext& context);
std::vector<CheckResult> check_geometry(const CheckContext& context);
std::vector<CheckResult> check_photons(const CheckContext& context);
std::vector<CheckResult> check_density(const CheckContext& context);
std::vector<CheckResult> check_lights(const CheckContext& context);
std::vector<CheckResult> check_determinism(const CheckContext& context);
std::vector<CheckResult> check_devices(const CheckContext& context);

}  // namespace vitrum
