#include "program.h"

#include <string>

#include "commands.h"
#include "version.h"

namespace supple::cli {
namespace {

constexpr auto description =
    "Geodesics and elastic networks on triangle meshes; simulations of periodic structures, neural models and designs "
    "of them; weaves of elastic strands; answered by a supple-server";

constexpr auto footer =
    R"(Arguments:
  a mesh    an id, the beginning of one, or a mesh file (OBJ, OFF, PLY, STL), which is uploaded first
  a point   v17 is vertex 17; 12:0.2,0.3,0.5 is a point of face 12 by its barycentric coordinates;
            @1,2.5,-3 is the point of the surface that is nearest to a point in space
  an angle  45deg, 0.785rad, or a number, which is in radians
  a length, a stress, a duration and the like are numbers in the unit that the option names, or have a unit of their
            own: 4mm, 0.4cm, 12MPa, 1.2GPa, 90s, 2min, 5%

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
  supple part simulate IH21 --block 30x20 --strain -20% --csv force.csv
  supple evaluate ih21 --parameters 0.15,0.65 --strain 0.05,0,0 --derivatives 2
  supple design --task stress_strain --family any --target "0,0;0.1,0.6;0.2,0.9" --plot curve.svg
  supple weave homogenize squares --type 2 --plot squares.svg
  supple weave print regular --sheet 20x20 --frame 2 -o sheet.gcode
  supple job list

Environment:
  SUPPLE_SERVER, SUPPLE_KEY_FILE and SUPPLE_KEY stand for the options --server, --key-file and --key.
  NO_COLOR, if it is set to anything, turns off the colours on terminals.

Exit status:
  0  done                                     3  the server failed (5xx)
  1  the command line cannot be understood    4  no server answered
  2  the server refused the request (4xx)     5  a local file cannot be read or written
  6  a G-code file or a family has faults     7  a design misses its target (design --missed-ok: 0)
  130  Ctrl-C; the computation was cancelled on the server)";

}  // namespace

std::unique_ptr<CLI::App> make_program(GlobalOptions& options) {
  auto owner = std::make_unique<CLI::App>(description, "supple");
  CLI::App& program = *owner;
  program.footer(footer);
  program.require_subcommand(1);
  program.set_version_flag("--version", std::string("supple ") + program_version(), "Print the version");
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
  program
      .add_option("--priority", options.priority,
                  "How urgent computations are: interactive ones start first, background ones delay no others")
      ->check(CLI::IsMember({"interactive", "normal", "background"}));
  program.add_flag("--json", options.json, "Print the server's answer as JSON");
  program.add_flag("--no-progress", options.no_progress, "Draw no progress bar on the terminal");
  add_mesh_commands(program, options);
  add_geodesic_command(program, options);
  add_field_command(program, options);
  add_karcher_command(program, options);
  add_relax_command(program, options);
  add_voronoi_command(program, options);
  add_exponential_map_command(program, options);
  add_family_command(program, options);
  add_structure_command(program, options);
  add_outlines_command(program, options);
  add_part_command(program, options);
  add_simulate_command(program, options);
  add_model_commands(program, options);
  add_evaluate_command(program, options);
  add_uniaxial_command(program, options);
  add_curve_command(program, options);
  add_design_command(program, options);
  add_profile_command(program, options);
  add_weave_commands(program, options);
  add_job_commands(program, options);
  add_program_commands(program, program_version());
  return owner;
}

}  // namespace supple::cli
