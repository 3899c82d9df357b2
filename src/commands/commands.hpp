#pragma once
// The subcommands of vitrum, one file each. Each adds itself to the command line and says what to run when it is chosen.

#include <CLI/CLI.hpp>

namespace vitrum {

/// `vitrum render SCENE -o FILE ...`
void add_render_command(CLI::App& app);
/// `vitrum info SCENE`
void add_info_command(CLI::App& app);
/// `vitrum devices`
void add_devices_command(CLI::App& app);

}  // namespace vitrum
