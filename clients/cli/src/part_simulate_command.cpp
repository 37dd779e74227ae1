#include "part_simulate_command.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include "failure.h"
#include "idle_options.h"
#include "part_simulation_output.h"
#include "picture.h"
#include "profile_plot.h"
#include "simulation_output.h"
#include "solver_arguments.h"
#include "units.h"

namespace supple::cli {
namespace {

constexpr std::array<std::string_view, 4> plate_sides{"bottom", "top", "left", "right"};

struct PartSimulationArguments {
  std::vector<std::string> supports;
  std::string load_file;
  std::optional<double> strain;
  std::optional<double> gap;
  bool sticks = false;
  int states = 0;
  SolverArguments solver;
  double pressure_length = 0;
  std::string error_estimate;
  std::string csv_file;
  std::string svg_file;
  std::string obj_file;
  std::string vtu_file;
  std::string plot_file;
};

[[noreturn]] void refuse_support(const std::string& text) {
  throw Failure(ExitCode::usage,
                fmt::format("'{}' is no support: write a side (bottom, top, left, right) for a plate, or a box "
                            "xmin,ymin,xmax,ymax for a clamp, and how far it moves, for example top=0,-2mm",
                            text));
}

/// A support from "SIDE=dx,dy" or "xmin,ymin,xmax,ymax=dx,dy"; what does not move needs no displacement.
nlohmann::json parse_support(const std::string& text, const PartSimulationArguments& arguments) {
  const std::size_t equals = text.find('=');
  const std::string place = text.substr(0, equals);
  nlohmann::json support;
  if (std::find(plate_sides.begin(), plate_sides.end(), place) != plate_sides.end()) {
    support = {{"kind", "plate"}, {"side", place}};
    if (arguments.gap) support["gap"] = *arguments.gap;
    if (arguments.sticks) support["friction"] = "stick";
  } else {
    const auto corners = quantities_in(place, {Dimension::length});
    if (!corners || corners->size() != 4) refuse_support(text);
    const auto& c = *corners;
    support = {{"kind", "clamp"}, {"box", {{c[0], c[1]}, {c[2], c[3]}}}};
  }
  if (equals == std::string::npos) return support;
  const auto displacement = quantities_in(std::string_view(text).substr(equals + 1), {Dimension::length});
  if (!displacement || displacement->size() != 2) refuse_support(text);
  support["displacement"] = *displacement;
  return support;
}

/// The part of a request for its files, without what its simulation does not take.
nlohmann::json simulated_part(nlohmann::json request) {
  for (const char* const name : {"material", "svg", "deadline", "priority"}) request.erase(name);
  return request;
}

nlohmann::json request_of(nlohmann::json part, const PartSimulationArguments& arguments) {
  nlohmann::json request = {{"part", simulated_part(std::move(part))}};
  if (!arguments.load_file.empty()) {
    const nlohmann::json load = object_in_file(arguments.load_file);
    if (!load.contains("supports"))
      throw Failure(ExitCode::local_file, fmt::format("{} holds no \"supports\"", arguments.load_file));
    request["supports"] = load.at("supports");
  }
  for (const auto& text : arguments.supports) request["supports"].push_back(parse_support(text, arguments));
  if (arguments.strain) request["strain"] = *arguments.strain;
  if (arguments.states > 0) request["states"] = arguments.states;
  set_solver_fields(arguments.solver, request);
  set_member(request, "accuracy", "pressure_length", arguments.pressure_length);
  set_member(request, "effects", "error_estimate", arguments.error_estimate);
  if (!arguments.obj_file.empty()) request["deformed"] = "obj";
  if (!arguments.vtu_file.empty()) request["deformed"] = "vtu";
  if (!arguments.svg_file.empty()) request["svg"] = true;
  return request;
}

/// Writes a file for each state.
void write_states(const std::string& file, const nlohmann::json& states, const char* member) {
  for (std::size_t i = 0; i < states.size() && !file.empty(); ++i)
    write_file(state_file(file, i, states.size(), (std::string(".") + member).c_str()),
               states.at(i).at(member).get<std::string>());
}

/// Refuses options of `part` that are about its files or its mass.
void refuse_file_options(const CLI::App& part) {
  constexpr const char* where = "where the part is simulated";
  refuse_idle_options(part, {{"--step", false, where},
                             {"--stl", false, where},
                             {"--3mf", false, where},
                             {"--dxf", false, where},
                             {"--svg", false, "before simulate"},
                             {"--density", false, where}});
}

void simulate_part(const CLI::App& command, const GlobalOptions& options, const PartArguments& part,
                   const PartSimulationArguments& arguments) {
  const CLI::App& of_part = *command.get_parent();
  refuse_file_options(of_part);
  const bool has_plate = std::any_of(arguments.supports.begin(), arguments.supports.end(), [](const auto& text) {
    return std::any_of(plate_sides.begin(), plate_sides.end(), [&](auto side) { return text.starts_with(side); });
  });
  refuse_idle_options(command, {{"--gap", has_plate, "without a plate as --support"},
                                {"--stick", has_plate, "without a plate as --support"}});
  Session session(options);
  const nlohmann::json request = request_of(part_request(of_part, part, session), arguments);
  const nlohmann::json answer = session.compute("/v1/part-simulations", request).json();
  const auto& states = answer.at("states");
  if (!arguments.csv_file.empty()) write_file(arguments.csv_file, part_states_as_csv(states));
  write_states(arguments.svg_file, states, "svg");
  write_states(arguments.obj_file, states, "obj");
  write_states(arguments.vtu_file, states, "vtu");
  if (!arguments.plot_file.empty()) write_picture(arguments.plot_file, plot_svg({plot_of_part(answer)}));
  if (arguments.csv_file == "-" || arguments.plot_file == "-") return;
  session.json() ? print_json(answer) : print_part_simulation(answer);
}

void add_support_options(CLI::App& command, PartSimulationArguments& arguments) {
  auto* const supports = command
                             .add_option("--support", arguments.supports,
                                         "A plate along a side of the part, or a clamp on a box, and how far it moves: "
                                         "bottom, top=0,-2mm or 0,0,20,5=0,3; may be given several times (a coupon is "
                                         "clamped at its grips, a block lies between two plates)")
                             ->expected(1)
                             ->take_all();
  command.add_option("--load", arguments.load_file, "JSON file with supports as the contract has them");
  command
      .add_option("--strain", arguments.strain,
                  "Without --support: by how much the structure of a coupon or a block is stretched at the end (20%, "
                  "-20% of a block)")
      ->transform(quantity(Dimension::ratio))
      ->excludes(supports);
  command.add_option("--gap", arguments.gap, "Distance of the plates of --support from the part at rest in mm (0)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::NonNegativeNumber);
  command.add_flag("--stick", arguments.sticks, "What touches the plates of --support moves along with them");
}

}  // namespace

void add_part_simulate_command(CLI::App& part, const GlobalOptions& options,
                               std::shared_ptr<const PartArguments> arguments) {
  const auto own = std::make_shared<PartSimulationArguments>();
  CLI::App* command = part.add_subcommand(
      "simulate", "Tests a part, which the options of supple part describe, under supports that move");
  add_support_options(*command, *own);
  command->add_option("-n,--states", own->states, "States to report along the path (10)")->check(CLI::PositiveNumber);
  add_material_options(*command, own->solver);
  add_mesh_options(*command, own->solver);
  command
      ->add_option("--pressure-length", own->pressure_length,
                   "Length along a plate over which its pressure is averaged in mm (1)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber);
  add_path_options(*command, own->solver, "--residual",
                   "Largest internal motion of a support, as a share of the part's length (0.05)");
  command
      ->add_option("--error-estimate", own->error_estimate,
                   "The same on a coarser mesh, which tells the mesh's error (automatic)")
      ->check(switch_values());
  command->add_option("--csv", own->csv_file, "Write the states to this file, - for the terminal");
  command->add_option("--svg", own->svg_file,
                      "Draw the deformed part of each state, coloured by strain; several states become name-0000.svg "
                      "and so on");
  auto* const obj = command->add_option("--obj", own->obj_file, "Write the deformed part of each state as OBJ");
  command->add_option("--vtu", own->vtu_file, "The same as VTU")->excludes(obj);
  command->add_option("--plot", own->plot_file, "Draw force over displacement as SVG or PNG, - for the terminal (SVG)")
      ->check(plot_file());
  command->footer(
      "Examples:\n  supple part simulate IH21 --block 30x20 --strain -20% --plot force.svg\n"
      "  supple part simulate --from design.json --coupon 20x60 --strain 10% --csv force.csv --svg state.svg\n"
      "  supple part simulate IH22 --rectangle 30x30 --frame 1 --support bottom --support top=0,-3 --stick \\\n"
      "    --vtu part.vtu");
  command->callback([&options, command, arguments = std::move(arguments), own] {
    simulate_part(*command, options, *arguments, *own);
  });
}

}  // namespace supple::cli
