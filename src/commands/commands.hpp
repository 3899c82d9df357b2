#pragma once
// The subcommands of vitrum, one file each. Each adds itself to the command line and says what to run when it is chosen.

#include <CLI/CLI.hpp>

namespace vitrum {

/// How vitrum ends when it has done what it was asked for, and a threshold is exceeded; 1 is for errors, 2 for usage.
constexpr int exit_exceeded = 3;
/// How `vitrum verify` ends when a check fails.
constexpr int exit_unverified = 1;

/// `vitrum render SCENE -o FILE ...`
void add_render_command(CLI::App& app);
/// `vitrum compare A B`; sets `exit_code` to exit_exceeded if a threshold is exceeded.
void add_compare_command(CLI::App& app, int& exit_code);
/// `vitrum info SCENE`
void add_info_command(CLI::App& app);
/// `vitrum devices`
void add_devices_command(CLI::App& app);
/// `vitrum verify`; sets `exit_code` to exit_unverified if a check fails.
void add_verify_command(CLI::App& app, int& exit_code);
/// `vitrum bench WHAT`
void add_bench_command(CLI::App& app);

}  // namespace vitrum
