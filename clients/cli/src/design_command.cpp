#include <fmt/format.h>

#include <memory>
#include <utility>

#include "angles.h"
#include "commands.h"
#include "design_output.h"
#include "failure.h"
#include "idle_options.h"
#include "measured_curve_arguments.h"
#include "numbers.h"
#include "part_request.h"
#include "picture.h"
#include "problem.h"
#include "profile_arguments.h"
#include "profile_plot.h"
#include "units.h"

namespace supple::cli {
namespace {

struct DesignArguments {
  std::string request_file;
  ProfileArguments profile;
  std::string target;
  std::string target_points;
  MeasuredCurveArguments measured;
  std::string interpolation;
  int samples = 0;
  std::string initial, initial_orientation;
  std::string fixed;
  std::string orientation;
  std::string youngs_modulus;
  double density = 0;
  double beam_width = 0;
  double cell_size = 0;
  std::string density_limits;
  std::string beam_width_limits;
  std::string cell_size_limits;
  bool verify = false;
  int verified_samples = 0;
  double tolerance = 0;
  double equilibrium_tolerance = 0;
  int max_iterations = 0;
  int starts = 0;
  int candidates = 0;
  std::string trust;
  std::string multi_start;
  std::string envelope;
  std::string polish;
  std::string ways_out;
  std::string beam_width_sensitivity;
  double polish_tolerance = 0;
  int polish_rounds = 0;
  double polish_seconds = 0;
  std::string session;
  double deadline = 0;
  bool missed_ok = false;
  std::string part;
  double thickness = 0;
  PartFiles part_files;  ///< its SVG file is that of the structure if no part is wanted
  std::string csv_file;
  std::string plot_file;
};

/// The reduced curve of a file of measurements. If the server refuses the file, but its lines could be control points,
/// the failure names the option that reads those.
nlohmann::json measured_curve(Session& session, const DesignArguments& arguments, const std::string& bytes,
                              const std::string& task) {
  try {
    return reduce_curve(session, bytes, task, arguments.measured);
  } catch (const Problem& problem) {
    constexpr int unprocessable = 422;
    if (problem.status() != unprocessable || !holds_control_points(bytes, task)) throw;
    auto document = problem.document();
    document["hint"] = fmt::format("If its lines are control points rather than measurements, give --target-points {}.",
                                   arguments.target == "-" ? "FILE" : arguments.target);
    throw Problem(problem.code(), problem.status(), problem.what(), std::move(document));
  }
}

/// Sets the target from a file of measurements. Testing machines measure engineering strain and force over rest width.
void set_measured_target(Session& session, const DesignArguments& arguments, nlohmann::json& request) {
  const std::string task = request.value("task", "stress_strain");
  const std::string bytes = bytes_of_measurements(arguments.target);
  const auto answer = measured_curve(session, arguments, bytes, task);
  request["task"] = task;
  request["target"] = answer.at("target");
  if (task == "stress_strain" && !request.contains("strain_measure")) request["strain_measure"] = "engineering";
  if (session.json()) return;
  fmt::print(stderr, "target      {}\n", reduction_words(answer));
  print_curve_notes(answer);
}

/// Two numbers such as "1,2", the lesser first.
nlohmann::json parse_pair(const std::string& text, const char* option) {
  auto pair = parse_numbers(text, option);
  if (pair.size() != 2 || pair[0] > pair[1])
    throw Failure(ExitCode::usage,
                  fmt::format("{} {}: write the least and the greatest value, for example 0.1,0.3", option, text));
  return pair;
}

void set_material(const DesignArguments& arguments, nlohmann::json& request) {
  if (arguments.youngs_modulus.empty() && arguments.density <= 0) return;
  if (request.contains("material") && !request.at("material").is_object())
    throw Failure(ExitCode::usage, "--youngs-modulus and --density do not go with a list of materials");
  auto& material = request["material"];
  const auto& modulus = arguments.youngs_modulus;
  if (!modulus.empty())
    material["youngs_modulus"] = modulus.find(',') == std::string::npos
                                     ? nlohmann::json(parse_number(modulus, "--youngs-modulus"))
                                     : parse_pair(modulus, "--youngs-modulus");
  if (arguments.density > 0) material["density"] = arguments.density;
}

void set_orientation(const std::string& text, nlohmann::json& request) {
  if (text.empty()) return;
  const auto angles = parse_angles(text, "--orientation");
  if (angles.size() > 2 || (angles.size() == 2 && angles[0] > angles[1]))
    throw Failure(ExitCode::usage,
                  fmt::format("--orientation {}: write an angle, or the least and the greatest one", text));
  request["orientation"] = angles.size() == 1 ? nlohmann::json(angles[0]) : nlohmann::json(angles);
}

void set_start(const DesignArguments& arguments, nlohmann::json& request) {
  if (!arguments.initial.empty()) request["initial"] = parse_numbers(arguments.initial, "list of parameters");
  if (!arguments.initial_orientation.empty())
    request["initial_orientation"] = parse_angle(arguments.initial_orientation, "--initial-orientation");
}

void set_size(const DesignArguments& arguments, nlohmann::json& request) {
  if (arguments.beam_width > 0) request["beam_width"] = arguments.beam_width;
  if (arguments.cell_size > 0) request["cell_size"] = arguments.cell_size;
  const auto set_limits = [&](const char* name, const std::string& text, const char* option) {
    if (!text.empty()) request["limits"][name] = parse_pair(text, option);
  };
  set_limits("relative_density", arguments.density_limits, "--relative-density");
  set_limits("beam_width", arguments.beam_width_limits, "--beam-width-limits");
  set_limits("cell_size", arguments.cell_size_limits, "--cell-size-limits");
}

/// The request in the file, in which options of the command line replace fields.
nlohmann::json request_of(const DesignArguments& arguments, Session& session) {
  nlohmann::json request =
      arguments.request_file.empty() ? nlohmann::json::object() : object_in_file(arguments.request_file);
  for (const char* const group : {"target", "accuracy", "effects", "limits"}) {
    if (request.contains(group) && !request.at(group).is_object())
      throw Failure(ExitCode::local_file, fmt::format("{}: {} is no JSON object", arguments.request_file, group));
  }
  request.update(profile_fields(arguments.profile));
  const std::string task = request.value("task", "stress_strain");
  if (!arguments.target.empty() && is_measured(arguments.target)) {
    set_measured_target(session, arguments, request);
  } else if (!arguments.target.empty()) {
    request["target"] = parse_target(arguments.target, task);
  } else if (!arguments.target_points.empty()) {
    request["target"] = parse_target(arguments.target_points, task);
  }
  if (arguments.request_file.empty() && !(request.contains("task") && request.contains("target")))
    throw Failure(ExitCode::usage, "no problem: give --task and --target, or a file with --request");
  const auto set_text = [](nlohmann::json& in, const char* name, const std::string& value) {
    if (!value.empty()) in[name] = value;
  };
  const auto set_number = [](nlohmann::json& in, const char* name, auto value) {
    if (value > 0) in[name] = value;
  };
  if (!arguments.interpolation.empty()) request["target"]["interpolation"] = arguments.interpolation;
  set_number(request, "samples", arguments.samples);
  set_start(arguments, request);
  if (!arguments.fixed.empty()) request["fixed"] = parse_fixed(arguments.fixed);
  set_orientation(arguments.orientation, request);
  set_material(arguments, request);
  set_size(arguments, request);
  if (arguments.verify) request["verify"] = true;
  nlohmann::json accuracy = nlohmann::json::object();
  set_number(accuracy, "verified_samples", arguments.verified_samples);
  set_number(accuracy, "polish_tolerance", arguments.polish_tolerance);
  set_number(accuracy, "polish_rounds", arguments.polish_rounds);
  set_number(accuracy, "polish_seconds", arguments.polish_seconds);
  set_number(accuracy, "tolerance", arguments.tolerance);
  set_number(accuracy, "equilibrium_tolerance", arguments.equilibrium_tolerance);
  set_number(accuracy, "max_iterations", arguments.max_iterations);
  set_number(accuracy, "starts", arguments.starts);
  set_number(accuracy, "candidates", arguments.candidates);
  if (!accuracy.empty()) request["accuracy"].update(accuracy);
  if (!arguments.trust.empty()) request["effects"]["trust"] = arguments.trust;
  if (!arguments.multi_start.empty()) request["effects"]["multi_start"] = arguments.multi_start;
  if (!arguments.envelope.empty()) request["effects"]["envelope"] = arguments.envelope;
  if (!arguments.polish.empty()) request["effects"]["polish"] = arguments.polish;
  if (!arguments.ways_out.empty()) request["effects"]["ways_out"] = arguments.ways_out;
  if (!arguments.beam_width_sensitivity.empty())
    request["effects"]["beam_width_sensitivity"] = arguments.beam_width_sensitivity;
  set_text(request, "session", arguments.session);
  set_number(request, "deadline", arguments.deadline);
  return request;
}

void write_structures(Session& session, const std::string& file, const nlohmann::json& answer) {
  const auto designs = designs_in(answer);
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const auto link = designs[i].at("structure").at("svg").get<std::string>();
    write_file(numbered_file(file, i, designs.size()), session.http().get(link, "image/svg+xml").body);
  }
}

/// The request for the part of a design, whose outline the option --part gives.
nlohmann::json part_of(const nlohmann::json& design, const nlohmann::json& outline, double thickness) {
  nlohmann::json request = {{"outline", outline}};
  use_design(design, "the design", request);
  if (thickness > 0) request["thickness"] = thickness;
  return request;
}

/// Writes the files of the designs' parts and, unless one of them or the answer goes to the terminal, describes them.
void make_parts(Session& session, const DesignArguments& arguments, const nlohmann::json& outline,
                const nlohmann::json& answer, bool describe) {
  const auto designs = designs_in(answer);
  for (std::size_t i = 0; i < designs.size(); ++i) {
    const auto request = part_of(designs[i], outline, arguments.thickness);
    write_part(session, request, numbered_files(arguments.part_files, i, designs.size()));
    if (!describe) continue;
    fmt::print("\npart     {}\n", arguments.part);
    print_part(request, session.compute("/v1/parts", request).json());
  }
}

/// Throws Failure(missed) if a design misses its target, or if nothing tells whether it reaches it. The message begins
/// with the worst one, and names the regions if there are several.
void fail_on_missed(const nlohmann::json& answer) {
  std::string missed;
  const auto designs = designs_in(answer);
  for (const std::size_t i : worst_first(designs)) {
    if (!misses_target(designs[i])) break;
    if (missed.empty() && designs.size() > 1) missed = fmt::format("the worst of {} regions is ", designs.size());
    if (designs.size() > 1 || designs[i].contains("name")) missed += region_words(designs[i], i) + ": ";
    missed += designs[i].at("verdict").at("sentence").get<std::string>() + "\n";
  }
  if (!missed.empty())
    throw Failure(ExitCode::missed, missed + "The exit status is 7; with --missed-ok it is 0 all the same.");
}

/// Refuses options about measurements and parts that have no effect.
void check_inputs_and_outputs(const CLI::App& command, const GlobalOptions& options, const DesignArguments& arguments) {
  const bool is_from_measurements = !arguments.target.empty() && is_measured(arguments.target);
  constexpr const char* no_measurements = "without a file of measurements: give it with --target";
  refuse_idle_options(command, {{"--columns", is_from_measurements, no_measurements},
                                {"--units", is_from_measurements, no_measurements},
                                {"--gauge-length", is_from_measurements, no_measurements},
                                {"--area", is_from_measurements, no_measurements},
                                {"--sense", is_from_measurements, no_measurements},
                                {"--decimal-separator", is_from_measurements, no_measurements},
                                {"--zero", is_from_measurements, no_measurements},
                                {"--block", is_from_measurements, no_measurements},
                                {"--loading", is_from_measurements, no_measurements},
                                {"--rupture", is_from_measurements, no_measurements},
                                {"--origin", is_from_measurements, no_measurements},
                                {"--control-points", is_from_measurements, no_measurements}});
  const auto& files = arguments.part_files;
  bool has_file = false;
  for (const auto* file : {&files.svg, &files.step, &files.stl, &files.three_mf, &files.dxf})
    has_file |= !file->empty();
  const bool is_described = !options.json && arguments.csv_file != "-" && arguments.plot_file != "-";
  refuse_idle_options(
      command, {{"--part", has_file || is_described, "without a file: give --stl, --3mf, --step, --dxf or --svg"}});
}

/// Refuses options about simulations and polishing that have no effect.
void check_simulation(const CLI::App& command, const nlohmann::json& request) {
  const auto effects = request.value("effects", nlohmann::json::object());
  const bool is_polish_off = effects.value("polish", nlohmann::json()) == "off";
  const bool is_verified = request.value("verify", nlohmann::json()) == true;
  const bool is_simulated = is_verified || effects.value("polish", nlohmann::json()) == "on";
  const char* const no_polish = is_simulated ? "with --polish off" : "without --verify or --polish on";
  refuse_idle_options(command, {{"--verified-samples", is_simulated, "without --verify or --polish on"},
                                {"--polish-tolerance", is_simulated && !is_polish_off, no_polish},
                                {"--polish-rounds", is_simulated && !is_polish_off, no_polish},
                                {"--polish-seconds", is_simulated && !is_polish_off, no_polish}});
}

void run(const CLI::App& command, const GlobalOptions& options, const DesignArguments& arguments) {
  check_inputs_and_outputs(command, options, arguments);
  const auto outline = arguments.part.empty() ? nlohmann::json() : parse_sized_outline(arguments.part, "--part");
  Session session(options);
  const nlohmann::json request = request_of(arguments, session);
  if (!request.contains("regions")) refuse_idle_profile_options(command, request.value("task", "stress_strain"));
  check_simulation(command, request);
  const nlohmann::json answer = session.compute("/v1/designs", request).json();
  if (!arguments.csv_file.empty()) write_file(arguments.csv_file, designs_as_csv(answer));
  if (!arguments.plot_file.empty()) write_picture(arguments.plot_file, plot_svg(plots_of_designs(answer)));
  const auto& files = arguments.part_files;
  if (outline.is_null() && !files.svg.empty()) write_structures(session, files.svg, answer);
  bool on_terminal = false;
  for (const auto* file :
       {&arguments.csv_file, &arguments.plot_file, &files.svg, &files.step, &files.stl, &files.three_mf, &files.dxf})
    on_terminal |= *file == "-";
  if (!on_terminal) session.json() ? print_json(answer) : print_designs(answer);
  if (!outline.is_null()) make_parts(session, arguments, outline, answer, !on_terminal && !session.json());
  if (!arguments.missed_ok) fail_on_missed(answer);
}

void add_search_options(CLI::App& command, DesignArguments& arguments) {
  const auto switch_values = CLI::IsMember({"automatic", "on", "off"});
  command
      .add_option("--samples", arguments.samples, "Samples at which the target is compared (10; 50 over directions)")
      ->check(CLI::PositiveNumber);
  auto* const initial = command.add_option("--initial", arguments.initial,
                                           "Parameters to start from, separated by commas; with a family");
  command
      .add_option("--initial-orientation", arguments.initial_orientation,
                  "Orientation to start from, within --orientation (its middle)")
      ->needs(initial);
  command.add_option("--fixed", arguments.fixed, "Parameters to hold, for example 0.15,free; with a family");
  command.add_flag("--verify", arguments.verify, "Simulate the design found at its native scale too, and polish it");
  command.add_option("--verified-samples", arguments.verified_samples, "Samples that are simulated (12)")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--polish", arguments.polish,
                  "Correct the design until its simulation follows the target (automatic: with --verify)")
      ->check(switch_values);
  command
      .add_option("--ways-out", arguments.ways_out,
                  "Seek what helps where the target is missed, which takes up to 10 s (automatic)")
      ->check(switch_values);
  command
      .add_option(
          "--beam-width-sensitivity", arguments.beam_width_sensitivity,
          "Say how much beams that are 5 % wider or narrower change the profile (automatic: where the design is "
          "simulated)")
      ->check(switch_values);
  command
      .add_option("--polish-tolerance", arguments.polish_tolerance,
                  "Simulated relative deviation at which polishing ends (0.002)")
      ->transform(quantity(Dimension::ratio))
      ->check(CLI::PositiveNumber);
  command.add_option("--polish-rounds", arguments.polish_rounds, "Structures that polishing simulates at most (30)")
      ->check(CLI::PositiveNumber);
  command.add_option("--polish-seconds", arguments.polish_seconds, "Seconds that polishing may take (120)")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
  command
      .add_option("-t,--tolerance", arguments.tolerance,
                  "The search ends where a step promises to lessen the relative deviation by at most this (1e-6)")
      ->transform(quantity(Dimension::ratio))
      ->check(CLI::PositiveNumber);
  command
      .add_option("--equilibrium-tolerance", arguments.equilibrium_tolerance,
                  "Relative residual of an equilibrium (1e-10)")
      ->check(CLI::PositiveNumber);
  command.add_option("--max-iterations", arguments.max_iterations, "Iterations from one starting point (200)")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--starts", arguments.starts,
                  "Starting points that are followed at most (24, of each of all families 4)")
      ->check(CLI::PositiveNumber);
  command.add_option("--candidates", arguments.candidates, "Designs among which they are chosen")
      ->check(CLI::PositiveNumber);
  command.add_option("--trust", arguments.trust, "Prefer designs of which the model can be trusted (automatic)")
      ->check(switch_values);
  command.add_option("--multi-start", arguments.multi_start, "Further starting points (automatic)")
      ->check(switch_values);
  command.add_option("--envelope", arguments.envelope, "What the family can do at all (automatic)")
      ->check(switch_values);
}

void add_material_options(CLI::App& command, DesignArguments& arguments) {
  command.add_option("--orientation", arguments.orientation,
                     "Angle by which the tiling is turned (0), or the least and the greatest one between which it is "
                     "found: 0deg,180deg");
  command
      .add_option("--youngs-modulus", arguments.youngs_modulus,
                  "Young's modulus of the material in MPa or for example 1.2GPa (the model's, 26), or the least and "
                  "the greatest one among "
                  "which it is found: 20,60")
      ->transform(quantity(Dimension::stress));
  command.add_option("--density", arguments.density, "Density of the material in g/cm^3 (1.2)")
      ->transform(quantity(Dimension::density))
      ->check(CLI::PositiveNumber);
  auto* const beam_width = command.add_option("--beam-width", arguments.beam_width, "Width of the beams in mm (0.3)")
                               ->transform(quantity(Dimension::length))
                               ->check(CLI::PositiveNumber);
  command
      .add_option("--cell-size", arguments.cell_size,
                  "Instead of a width of the beams: the square root of a cell's area in mm, or for example 0.4cm")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber)
      ->excludes(beam_width);
  command
      .add_option("--relative-density", arguments.density_limits,
                  "Least and greatest share of the plane that is solid, for example 0.1,0.3 or 10%,30%")
      ->transform(quantity(Dimension::ratio));
  command
      .add_option("--beam-width-limits", arguments.beam_width_limits,
                  "Least and greatest width of the beams in mm; with --cell-size")
      ->transform(quantity(Dimension::length));
  command
      .add_option("--cell-size-limits", arguments.cell_size_limits,
                  "Least and greatest size of the cells in mm; without --cell-size")
      ->transform(quantity(Dimension::length));
}

void add_part_options(CLI::App& command, DesignArguments& arguments) {
  command.add_option(
      "--svg", arguments.part_files.svg,
      "Write the structure found, or its part, as SVG, - for the terminal; several become name-1.svg and "
      "so on");
  auto* const part =
      command
          .add_option("--part", arguments.part,
                      "Make the design's part: coupon:20x60, block:30x20 or rectangle:40x120, in mm; the design's load "
                      "lies along the axis of a coupon or a block. Its files are those of --stl and the like")
          ->transform(quantity(Dimension::length));
  command.add_option("--thickness", arguments.thickness, "Thickness of the part in mm (1)")
      ->transform(quantity(Dimension::length))
      ->check(CLI::PositiveNumber)
      ->needs(part);
  const auto add_file = [&](const char* name, std::string& file, const char* kind) {
    command.add_option(name, file, fmt::format("Write the part as {}, - for the terminal", kind))->needs(part);
  };
  add_file("--stl", arguments.part_files.stl, "a binary STL file");
  add_file("--3mf", arguments.part_files.three_mf, "a 3MF file");
  add_file("--dxf", arguments.part_files.dxf, "a DXF file");
  add_file("--step", arguments.part_files.step, "a STEP file");
}

}  // namespace

void add_design_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<DesignArguments>();
  CLI::App* command =
      program.add_subcommand("design", "Find tiling parameters whose response follows a target profile");
  add_profile_options(*command, arguments->profile);
  command->get_option("--family")->description("Family to search, or any for all that have a model (any)");
  auto* const target = command->add_option(
      "--target", arguments->target,
      "Control points x,y;x,y: strains or angles, and MPa, or with units as in 5%,60kPa; a third number is a weight, a "
      "fourth a band within which "
      "deviations count as none. Or a file of measurements, or - for standard input, which is read as supple curve "
      "does");
  command
      ->add_option("--target-points", arguments->target_points,
                   "A file whose lines are control points: x,y or x,y,weight or x,y,weight,band")
      ->excludes(target);
  add_measured_curve_options(*command, arguments->measured);
  command->add_option("--interpolation", arguments->interpolation, "Between the control points (cubic)")
      ->check(CLI::IsMember({"cubic", "monotone", "linear"}));
  command->add_option("--request,--regions", arguments->request_file,
                      "A request as JSON: further targets, regions; options given besides take their fields' place");
  add_material_options(*command, *arguments);
  add_search_options(*command, *arguments);
  command->add_option("--session", arguments->session, "A newer request of the same session replaces one that runs");
  command->add_option("--deadline", arguments->deadline, "Seconds that the computation may take, or for example 2min")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
  command->add_option("--csv", arguments->csv_file, "Write target and profiles to this file, - for the terminal");
  command
      ->add_option("--plot", arguments->plot_file, "Draw target and profiles as SVG or PNG, - for the terminal (SVG)")
      ->check(plot_file());
  add_part_options(*command, *arguments);
  command->add_flag("--missed-ok", arguments->missed_ok,
                    "The exit status is 0 even where the target is missed or nothing tells whether it is reached (7)");
  command->footer(
      "Examples:\n"
      "  supple design --task stress_strain --family IH67 --target \"0,0;0.1,0.6;0.2,0.9\" --plot curve.svg\n"
      "  supple design --task poisson --target \"0deg,-0.2;90deg,0.4\" --strain 0.1 --svg structure.svg\n"
      "  supple design --task stiffness --family IH67 --target-points target.csv --fixed 0.2,free --verify\n"
      "  supple design --task stiffness --target \"0deg,40;90deg,10\" --youngs-modulus 2000,3500 --relative-density "
      "0,0.4\n"
      "  supple design --request sole.json --plot regions.svg\n"
      "  supple design --task stress_strain --target tensile.csv --part coupon:12mmx30mm --stl coupon.stl");
  command->callback([&options, arguments, command] { run(*command, options, *arguments); });
}

}  // namespace supple::cli
