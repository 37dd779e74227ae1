#include <fmt/format.h>

#include <memory>

#include "commands.h"
#include "idle_options.h"
#include "load_arguments.h"
#include "numbers.h"
#include "simulation_output.h"
#include "solver_arguments.h"
#include "units.h"

namespace supple::cli {
namespace {

struct PatchSimulationArguments {
  std::string family;
  std::string parameters;
  LoadArguments load;
  SolverArguments solver;
  std::string mesh_region;
  double discretization_error = 0;
  std::string patch;
  std::string refinement;
  bool no_tangents = false;
  std::string csv_file;
  std::string vtu_file;
};

nlohmann::json request_of(const PatchSimulationArguments& arguments) {
  nlohmann::json request = {{"family", arguments.family}, {"load", load_of(arguments.load)}};
  if (!arguments.parameters.empty()) request["parameters"] = parse_numbers(arguments.parameters, "list of parameters");
  set_solver_fields(arguments.solver, request);
  set_member(request, "accuracy", "mesh_region", arguments.mesh_region);
  set_member(request, "accuracy", "discretization_error", arguments.discretization_error);
  set_member(request, "effects", "patch", arguments.patch);
  set_member(request, "effects", "refinement", arguments.refinement);
  if (arguments.no_tangents) request["tangents"] = false;
  if (!arguments.vtu_file.empty()) request["deformed"] = "vtu";
  return request;
}

void run(const GlobalOptions& options, const PatchSimulationArguments& arguments) {
  const nlohmann::json request = request_of(arguments);
  Session session(options);
  const nlohmann::json answer = session.compute("/v1/simulations", request).json();
  const auto& states = answer.at("states");
  if (!arguments.csv_file.empty()) write_file(arguments.csv_file, states_as_csv(states));
  if (!arguments.vtu_file.empty()) {
    for (std::size_t i = 0; i < states.size(); ++i) {
      write_file(state_file(arguments.vtu_file, i, states.size(), ".vtu"), states.at(i).at("vtu").get<std::string>());
    }
  }
  if (arguments.csv_file == "-") return;
  session.json() ? print_json(answer) : print_simulation(answer);
}

void add_options(CLI::App& command, PatchSimulationArguments& arguments) {
  command.add_option("family", arguments.family, "Family of the tiling, see supple families")->required();
  command.add_option("-p,--parameters", arguments.parameters,
                     "Parameters, separated by commas (the family's defaults)");
  add_load_options(command, arguments.load);
  add_material_options(command, arguments.solver);
  add_mesh_options(command, arguments.solver);
  command.add_option("--mesh-region", arguments.mesh_region, "What is meshed at a time (automatic)")
      ->check(CLI::IsMember({"automatic", "tile", "cell"}));
  command
      .add_option("--discretization-error", arguments.discretization_error,
                  "Relative error of the stress that the mesh may make; --mesh-size wins over it")
      ->transform(quantity(Dimension::ratio))
      ->check(CLI::PositiveNumber);
  add_path_options(command, arguments.solver, "-t,--tolerance", "Largest internal change of F (0.05)");
  command.add_option("--patch", arguments.patch, "Patch of 2 x 2 cells (automatic)")->check(switch_values());
  command
      .add_option("--refinement", arguments.refinement,
                  "States on a finer mesh too, which tell the mesh's error and take it off (automatic)")
      ->check(switch_values());
  command.add_flag("--no-tangents", arguments.no_tangents, "Leave out the tangent stiffnesses");
  command.add_option("--csv", arguments.csv_file, "Write the states to this file, - for the terminal");
  command.add_option("--vtu", arguments.vtu_file,
                     "Write the deformed mesh of each state; several states become name-0000.vtu and so on");
}

}  // namespace

void add_simulate_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<PatchSimulationArguments>();
  CLI::App* command = program.add_subcommand("simulate", "Stress and energy of a structure along a load path");
  add_options(*command, *arguments);
  command->footer(
      "Examples:\n  supple simulate IH01 --uniaxial 0 --stretches 1.02:1.3:15 --csv curve.csv\n"
      "  supple simulate IH22 --biaxial 45deg --stretches 0.98:0.9:5 --orthogonal 1 --vtu state.vtu\n"
      "  supple simulate IH21 --green-strain \"0.05,0,0;0.1,0,0\" --mesh-size 0.5 --contact off");
  command->callback([&options, arguments, command] {
    const bool is_biaxial = !arguments->load.biaxial.empty();
    refuse_idle_options(
        *command, {{"--stretches", is_biaxial || !arguments->load.uniaxial.empty(), "without --uniaxial or --biaxial"},
                   {"--orthogonal", is_biaxial, "without --biaxial"}});
    run(options, *arguments);
  });
}

}  // namespace supple::cli
