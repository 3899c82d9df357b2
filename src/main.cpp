// vitrum's command line: what the subcommands have in common.

#include <cstdio>

#include "commands/commands.hpp"
#include "commands/usage.hpp"
#include "core/error.hpp"
#include "core/version.hpp"

int main(int argc, char** argv) {
  int exit_code = 0;
  CLI::App app("vitrum renders glass: transparent, glossy and absorbing objects with their caustics, on OpenCL devices.",
               "vitrum");
  app.set_version_flag("--version", std::string("vitrum ") + vitrum::version());
  app.require_subcommand(1);
  vitrum::add_render_command(app);
  vitrum::add_compare_command(app, exit_code);
  vitrum::add_info_command(app);
  vitrum::add_devices_command(app);
  vitrum::add_verify_command(app, exit_code);
  vitrum::add_bench_command(app);
  app.footer("First steps:\n  vitrum render models/default_scene/scene.toml -o picture.png\n  vitrum render --help");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return app.exit(error);  // --help and --version
    std::fprintf(stderr, "vitrum: error: %s\n", vitrum::usage_error(app, error).what());
    return 2;
  } catch (const vitrum::Error& error) {
    std::fprintf(stderr, "vitrum: error: %s\n", error.what());
    return 1;
  } catch (const std::bad_alloc&) {
    std::fprintf(stderr, "vitrum: error: memory ran out; use fewer photons, fewer pixels or a smaller scene\n");
    return 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "vitrum: error: %s; this should not happen, please report it\n", error.what());
    return 1;
  }
  return exit_code;
}
