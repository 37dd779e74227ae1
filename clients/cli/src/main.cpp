#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <exception>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "exit_code.h"
#include "failure.h"
#include "interrupt.h"

namespace {

constexpr auto description =
    "Geodesics and elastic networks on triangle meshes; simulations of periodic structures, neural models and designs "
    "of them; "
    "weaves of elastic strands; answered by a supple-server";

constexpr auto footer =
    R"(Meshes:   an id, the beginning of one, or a mesh file (OBJ, OFF, PLY, STL), which is uploaded first
Points:   v17 is vertex 17; 12:0.2,0.3,0.5 is a point of face 12 by its barycentric coordinates

Examples:
  supple mesh add bunny.obj
  supple geodesic bunny.obj v0 v1200 --path path.obj
  supple field bunny.obj v0 --output distances.ply
  supple karcher bunny.obj v0 v300 12:0.2,0.3,0.5 --weights 1,1,2
  supple relax bunny.obj --poisson-disk 0.2 --voronoi-dual --rest-length 0.15 --obj network.obj
  supple voronoi bunny.obj --random 200 --optimize centroidal --obj cells.obj
  supple exponential-map bunny.obj v0 --tangent 0.1,0,0.2
  supple structure IH21 --svg tiling.svg
  supple simulate IH01 --uniaxial 0 --stretches 1.02:1.3:15 --csv curve.csv
  supple evaluate ih21 --parameters 0.15,0.65 --strain 0.05,0,0 --derivatives 2
  supple design --task stress_strain --family any --target "0,0;0.1,0.6;0.2,0.9" --plot curve.svg
  supple weave homogenize squares --type 2 --plot squares.svg
  supple weave print regular --sheet 20x20 --frame 2 -o sheet.gcode
  supple job list

Exit status:
  0  done                                     3  the server failed (5xx)
  1  the command line cannot be understood    4  no server answered
  2  the server refused the request (4xx)     5  a local file cannot be read or written
  6  a G-code file has violations           130  Ctrl-C; the computation was cancelled on the server)";

int run(int argument_count, char** arguments) {
  using supple::cli::ExitCode;
  // First of all, so that every thread that follows leaves Ctrl-C to the watch.
  const supple::cli::InterruptWatch watch;
  supple::cli::GlobalOptions options;
  CLI::App program(description, "supple");
  program.footer(footer);
  program.require_subcommand(1);
  program.fallthrough();
  program.add_option("--server", options.server, "Where supple-server answers")
      ->envname("SUPPLE_SERVER")
      ->capture_default_str();
  program.add_option("--key-file", options.key_file, "File that holds the key to send (mode 0600)")
      ->envname("SUPPLE_KEY_FILE");
  program
      .add_option(
          "--key", options.key,
          "The key itself; other users of the machine see command lines: better set the environment or --key-file")
      ->envname("SUPPLE_KEY");
  program.add_flag("--json", options.json, "Print the server's answer as JSON");
  program.add_flag("--no-progress", options.no_progress, "Draw no progress bar on the terminal");
  supple::cli::add_mesh_commands(program, options);
  supple::cli::add_geodesic_command(program, options);
  supple::cli::add_field_command(program, options);
  supple::cli::add_karcher_command(program, options);
  supple::cli::add_relax_command(program, options);
  supple::cli::add_voronoi_command(program, options);
  supple::cli::add_exponential_map_command(program, options);
  supple::cli::add_family_command(program, options);
  supple::cli::add_structure_command(program, options);
  supple::cli::add_simulate_command(program, options);
  supple::cli::add_model_commands(program, options);
  supple::cli::add_evaluate_command(program, options);
  supple::cli::add_uniaxial_command(program, options);
  supple::cli::add_design_command(program, options);
  supple::cli::add_profile_command(program, options);
  supple::cli::add_weave_commands(program, options);
  supple::cli::add_job_commands(program, options);
  try {
    program.parse(argument_count, arguments);
    return static_cast<int>(ExitCode::success);
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? static_cast<int>(ExitCode::success) : static_cast<int>(ExitCode::usage);
  } catch (const supple::cli::Failure& failure) {
    fmt::print(stderr, "supple: {}\n", failure.what());
    return static_cast<int>(failure.code());
  } catch (const nlohmann::json::exception& error) {
    fmt::print(stderr, "supple: the server's answer lacks what this command needs ({}): is its version the same?\n",
               error.what());
    return static_cast<int>(ExitCode::server_error);
  }
}

}  // namespace

int main(int argument_count, char** arguments) {
  try {
    return run(argument_count, arguments);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "supple: %s\n", error.what());
    return static_cast<int>(supple::cli::ExitCode::local_file);
  }
}
