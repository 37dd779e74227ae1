#include <fmt/format.h>

#include <memory>

#include "angles.h"
#include "commands.h"
#include "design_output.h"
#include "failure.h"
#include "idle_options.h"
#include "numbers.h"
#include "picture.h"
#include "simulation_output.h"
#include "units.h"
#include "weave_arguments.h"
#include "weave_output.h"
#include "weave_places.h"
#include "weave_print_commands.h"

namespace supple::cli {
namespace {

struct LayoutArguments {
  WeaveArguments weave;
  bool crossings = false;
  std::string svg_file;
};

void lay_out(const GlobalOptions& options, const LayoutArguments& arguments) {
  const nlohmann::json request = {{"weave", weave_of(arguments.weave)}};
  Session session(options);
  if (!arguments.svg_file.empty())
    write_file(arguments.svg_file, session.compute("/v1/weave-layouts", request, "image/svg+xml").body);
  if (arguments.svg_file == "-") return;
  const nlohmann::json answer = session.compute("/v1/weave-layouts", request).json();
  session.json() ? print_json(answer) : print_layout(answer, arguments.crossings);
}

void add_weave_layout_command(CLI::App& weave, const GlobalOptions& options) {
  const auto arguments = std::make_shared<LayoutArguments>();
  CLI::App* command = weave.add_subcommand("layout", "Strands and crossings at rest, and what is likely a mistake");
  add_weave_options(*command, arguments->weave);
  command->add_flag("--crossings", arguments->crossings, "List the crossings with their members");
  command->add_option("--svg", arguments->svg_file, "Write a picture, - for the terminal");
  command->callback([&options, arguments] { lay_out(options, *arguments); });
}

struct HomogenizeArguments {
  WeaveArguments weave;
  EquilibriumArguments equilibrium;
  std::string strain;
  std::string directions;
  std::string shear;
  double thickness = 0;
  std::string deformed;
  std::string csv_file;
  std::string plot_file;
  std::string obj_file;
};

nlohmann::json request_of(const HomogenizeArguments& arguments) {
  nlohmann::json request = {{"weave", weave_of(arguments.weave)}};
  if (!arguments.strain.empty()) request["strain"] = parse_numbers(arguments.strain, "strain").front();
  if (const auto count = integer_in(arguments.directions)) {
    request["directions"] = *count;
  } else if (!arguments.directions.empty()) {
    request["directions"] = parse_angles(arguments.directions, "--directions");
  }
  if (!arguments.shear.empty()) request["shear"] = arguments.shear;
  if (arguments.thickness > 0) request["thickness"] = arguments.thickness;
  if (!arguments.obj_file.empty() && arguments.deformed.empty())
    throw Failure(ExitCode::usage, "--obj needs --deformed, the numbers of the directions");
  for (const double index :
       arguments.deformed.empty() ? std::vector<double>{} : parse_numbers(arguments.deformed, "list of directions"))
    request["deformed"].push_back(static_cast<long>(index));
  set_equilibrium_fields(arguments.equilibrium, request);
  return request;
}

/// Writes deformed cells as OBJ files, unless `file` is empty.
void write_cells(const std::string& file, const nlohmann::json& cells) {
  for (std::size_t i = 0; i < cells.size() && !file.empty(); ++i)
    write_file(numbered_file(file, i, cells.size()), strands_as_obj(cells.at(i).at("strands")));
}

void homogenize(const GlobalOptions& options, const HomogenizeArguments& arguments) {
  const nlohmann::json request = request_of(arguments);
  Session session(options);
  const nlohmann::json answer = session.compute("/v1/weave-homogenizations", request).json();
  if (!arguments.csv_file.empty()) write_file(arguments.csv_file, homogenization_as_csv(answer));
  if (!arguments.plot_file.empty()) write_picture(arguments.plot_file, plot_svg(plots_of_homogenization(answer)));
  write_cells(arguments.obj_file, answer.at("cells"));
  if (arguments.csv_file == "-" || arguments.plot_file == "-") return;
  session.json() ? print_json(answer) : print_homogenization(answer);
}

void add_weave_homogenize_command(CLI::App& weave, const GlobalOptions& options) {
  const auto arguments = std::make_shared<HomogenizeArguments>();
  CLI::App* command =
      weave.add_subcommand("homogenize", "Young's modulus and Poisson's ratio of a periodic weave in every direction");
  add_weave_options(*command, arguments->weave);
  command->add_option("-s,--strain", arguments->strain, "Stretch minus one along each direction (0.1)")
      ->transform(quantity(Dimension::ratio));
  command->add_option("-d,--directions", arguments->directions,
                      "How many over half a turn (200), or angles: 0deg,45deg or first:last:n");
  command->add_option("--shear", arguments->shear, "Shear relative to the direction (free)")
      ->check(CLI::IsMember({"free", "suppressed"}));
  command->add_option("--thickness", arguments->thickness, "In mm, for moduli in MPa")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber);
  command->add_option("--deformed", arguments->deformed, "Numbers of directions whose deformed cells are wanted");
  add_equilibrium_options(*command, arguments->equilibrium);
  command->add_option("--csv", arguments->csv_file, "Write a line for each direction to this file, - for the terminal");
  command
      ->add_option("--plot", arguments->plot_file,
                   "Draw both over the direction as SVG or PNG, - for the terminal (SVG)")
      ->check(plot_file());
  command->add_option("--obj", arguments->obj_file, "Write the deformed cells; several become name-1.obj and so on");
  command->footer(
      "Examples:\n  supple weave homogenize squares --type 2 --strain 0.3 --plot squares.svg\n"
      "  supple weave homogenize regular --connections \"fused,slides_x;slides_y,fused\" --directions 45deg,0deg");
  command->callback([&options, arguments, command] {
    refuse_idle_options(*command, {{"--deformed", !arguments->obj_file.empty() || options.json,
                                    "without --obj or --json, which have the deformed cells"}});
    homogenize(options, *arguments);
  });
}

struct DeformArguments {
  WeaveArguments weave;
  EquilibriumArguments equilibrium;
  std::vector<std::string> gradients;
  std::string csv_file;
  std::string obj_file;
};

void deform(const GlobalOptions& options, const DeformArguments& arguments) {
  nlohmann::json request = {{"weave", weave_of(arguments.weave)}};
  for (const auto& text : arguments.gradients) {
    const auto f = parse_numbers(text, "deformation gradient");
    if (f.size() != 4)
      throw Failure(ExitCode::usage,
                    fmt::format("'{}' is no deformation gradient: write its rows one after the other, for example "
                                "1.05,0,0,1",
                                text));
    request["deformation_gradients"].push_back({{f[0], f[1]}, {f[2], f[3]}});
    if (!arguments.obj_file.empty()) request["deformed"].push_back(request["deformation_gradients"].size() - 1);
  }
  set_equilibrium_fields(arguments.equilibrium, request);
  Session session(options);
  const nlohmann::json answer = session.compute("/v1/weave-deformations", request).json();
  if (!arguments.csv_file.empty()) write_file(arguments.csv_file, deformations_as_csv(answer));
  write_cells(arguments.obj_file, answer.at("cells"));
  if (arguments.csv_file == "-") return;
  session.json() ? print_json(answer) : print_deformations(answer);
}

void add_weave_deform_command(CLI::App& weave, const GlobalOptions& options) {
  const auto arguments = std::make_shared<DeformArguments>();
  CLI::App* command =
      weave.add_subcommand("deform", "Stress and energy of a periodic weave under given deformation gradients");
  add_weave_options(*command, arguments->weave);
  command->add_option("-F,--gradient", arguments->gradients, "F by rows: 1.05,0,0,1; may be given several times")
      ->required();
  add_equilibrium_options(*command, arguments->equilibrium);
  command->add_option("--csv", arguments->csv_file, "Write a line for each gradient to this file, - for the terminal");
  command->add_option("--obj", arguments->obj_file, "Write the deformed cells; several become name-1.obj and so on");
  command->footer("Example:\n  supple weave deform circles --type 2 -F 1.1,0,0,1 -F 1,0.1,0.1,1 --csv states.csv");
  command->callback([&options, arguments] { deform(options, *arguments); });
}

struct SimulateArguments {
  WeaveArguments weave;
  EquilibriumArguments equilibrium;
  std::string load_file;
  std::vector<std::string> fixed_places;
  std::vector<std::string> moved;
  std::vector<std::string> forces;
  bool clamped = false;
  bool free_z = false;
  int states = 0;
  std::string csv_file;
  std::string obj_file;
  std::string vtu_file;
};

nlohmann::json support_at(nlohmann::json place, const SimulateArguments& arguments) {
  nlohmann::json support = {{"at", std::move(place)}};
  if (arguments.clamped) support["clamped"] = true;
  if (arguments.free_z) support["held"] = {true, true, false};
  return support;
}

nlohmann::json request_of(const SimulateArguments& arguments) {
  nlohmann::json request = {{"weave", weave_of(arguments.weave)}};
  if (!arguments.load_file.empty()) {
    const nlohmann::json load = object_in_file(arguments.load_file);
    for (const char* const name : {"supports", "forces"})
      if (load.contains(name)) request[name] = load.at(name);
  }
  for (const auto& text : arguments.fixed_places)
    request["supports"].push_back(support_at(parse_place(text), arguments));
  for (const auto& text : arguments.moved) {
    auto [place, displacement] = parse_placed_vector(text, "displacement of a place", Dimension::length);
    request["supports"].push_back(support_at(std::move(place), arguments));
    request["supports"].back()["displacement"] = std::move(displacement);
  }
  for (const auto& text : arguments.forces) {
    auto [place, force] = parse_placed_vector(text, "force at a place", Dimension::force);
    request["forces"].push_back({{"at", std::move(place)}, {"force", std::move(force)}});
  }
  if (!request.contains("supports"))
    throw Failure(ExitCode::usage, "nothing holds the sheet: give --hold, --move or a file with --load");
  if (arguments.states > 0) request["states"] = arguments.states;
  if (!arguments.obj_file.empty()) request["deformed"] = "obj";
  if (!arguments.vtu_file.empty()) request["deformed"] = "vtu";
  set_equilibrium_fields(arguments.equilibrium, request);
  return request;
}

void simulate(const CLI::App& command, const GlobalOptions& options, const SimulateArguments& arguments) {
  const bool has_supports = !arguments.fixed_places.empty() || !arguments.moved.empty();
  refuse_idle_options(command, {{"--clamp", has_supports, "without --hold or --move"},
                                {"--free-z", has_supports, "without --hold or --move"}});
  const nlohmann::json request = request_of(arguments);
  Session session(options);
  const nlohmann::json answer = session.compute("/v1/weave-simulations", request).json();
  const auto& states = answer.at("states");
  if (!arguments.csv_file.empty()) write_file(arguments.csv_file, sheet_states_as_csv(answer));
  const auto save = [&](const std::string& file, const char* name) {
    for (std::size_t i = 0; i < states.size() && !file.empty(); ++i)
      write_file(state_file(file, i, states.size(), (std::string(".") + name).c_str()),
                 states.at(i).at(name).get<std::string>());
  };
  save(arguments.obj_file, "obj");
  save(arguments.vtu_file, "vtu");
  if (arguments.csv_file == "-") return;
  session.json() ? print_json(answer) : print_weave_simulation(answer);
}

void add_weave_simulate_command(CLI::App& weave, const GlobalOptions& options) {
  const auto arguments = std::make_shared<SimulateArguments>();
  CLI::App* command = weave.add_subcommand("simulate", "A woven sheet that is held, moved and pulled");
  add_weave_options(*command, arguments->weave);
  command->add_option("--hold", arguments->fixed_places,
                      "Places that are held: c12, 3@5.2, 3:end or xmin,ymin,xmax,ymax");
  command->add_option("--move", arguments->moved, "Places that are moved by mm: 0,76,80,80=24,0");
  command->add_option("--pull", arguments->forces, "Places that are pulled with newtons: c12=0,-0.1");
  command->add_flag("--clamp", arguments->clamped, "What is held or moved keeps its direction too");
  command->add_flag("--free-z", arguments->free_z, "What is held or moved is so in the plane only");
  command->add_option("--load", arguments->load_file, "JSON file with supports and forces as the contract has them");
  command->add_option("-n,--states", arguments->states, "States to report along the path (1)")
      ->check(CLI::PositiveNumber);
  add_equilibrium_options(*command, arguments->equilibrium);
  command->add_option("--csv", arguments->csv_file, "Write a line for each state to this file, - for the terminal");
  auto* const obj = command->add_option(
      "--obj", arguments->obj_file, "Write the strands of each state; several states become name-0000.obj and so on");
  command->add_option("--vtu", arguments->vtu_file, "The same as VTU")->excludes(obj);
  command->footer(
      "Examples:\n"
      "  supple weave simulate regular --sheet 20x20 --connections slides_y --hold 0,0,80,3 --move 0,77,80,80=24,0 \\\n"
      "    --states 6 --csv shear.csv --vtu shear.vtu\n"
      "  supple weave simulate rings --hold 0:start --hold 1:start --move 6:end=0,4 --out-of-plane on --obj rings.obj");
  command->callback([&options, arguments, command] { simulate(*command, options, *arguments); });
}

}  // namespace

void add_weave_commands(CLI::App& program, const GlobalOptions& options) {
  CLI::App* weave =
      program.add_subcommand("weave", "Weaves of elastic strands: layouts, stiffness, sheets under load, printing");
  weave->require_subcommand(1);
  weave->fallthrough();
  add_weave_layout_command(*weave, options);
  add_weave_homogenize_command(*weave, options);
  add_weave_deform_command(*weave, options);
  add_weave_simulate_command(*weave, options);
  add_weave_print_commands(*weave, options);
}

}  // namespace supple::cli
