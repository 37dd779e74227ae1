#include <fmt/format.h>

#include <memory>

#include "angles.h"
#include "commands.h"
#include "design_output.h"
#include "failure.h"
#include "numbers.h"
#include "picture.h"
#include "profile_arguments.h"
#include "profile_plot.h"
#include "units.h"

namespace supple::cli {
namespace {

struct ProfileCommandArguments {
  ProfileArguments profile;
  std::string parameters;
  std::string x;
  int samples = 0;
  double equilibrium_tolerance = 0;
  double youngs_modulus = 0;
  std::string orientation;
  double deadline = 0;
  std::string csv_file;
  std::string plot_file;
};

nlohmann::json request_of(const ProfileCommandArguments& arguments) {
  nlohmann::json request = profile_fields(arguments.profile);
  if (!request.contains("family") && !request.contains("model"))
    throw Failure(ExitCode::usage, "whose profile: give --family or --model");
  request["parameters"] = parse_numbers(arguments.parameters, "list of parameters");
  if (!arguments.x.empty())
    request["x"] = is_over_directions(arguments.profile.task)
                       ? parse_angles(arguments.x, "-x")
                       : parse_series(in_base_units(arguments.x, Dimension::ratio, "-x"), "list of strains");
  if (arguments.samples > 0) request["samples"] = arguments.samples;
  if (arguments.equilibrium_tolerance > 0)
    request["accuracy"]["equilibrium_tolerance"] = arguments.equilibrium_tolerance;
  if (!arguments.orientation.empty()) request["orientation"] = parse_angle(arguments.orientation, "--orientation");
  if (arguments.youngs_modulus > 0) request["material"]["youngs_modulus"] = arguments.youngs_modulus;
  if (arguments.deadline > 0) request["deadline"] = arguments.deadline;
  return request;
}

void run(const GlobalOptions& options, const ProfileCommandArguments& arguments) {
  const nlohmann::json request = request_of(arguments);
  Session session(options);
  const nlohmann::json answer = session.compute("/v1/profiles", request).json();
  if (!arguments.csv_file.empty()) write_file(arguments.csv_file, profile_as_csv(answer));
  if (!arguments.plot_file.empty()) write_picture(arguments.plot_file, plot_svg({plot_of_profile(answer)}));
  if (arguments.csv_file == "-" || arguments.plot_file == "-") return;
  session.json() ? print_json(answer) : print_profile(answer);
}

}  // namespace

void add_profile_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<ProfileCommandArguments>();
  CLI::App* command = program.add_subcommand(
      "profile", "Stress over strain, or stiffness or Poisson's ratio over directions, as a neural model has them");
  add_profile_options(*command, arguments->profile);
  command->get_option("--task")->required();
  command->add_option("-p,--parameters", arguments->parameters, "Parameters, separated by commas")->required();
  auto* const x = command->add_option(
      "-x", arguments->x,
      "Strains (-0.1:0.2:31), or directions (50 over half a turn), for example 0deg,45deg: 0.05,0.1 or first:last:n");
  command->add_option("--samples", arguments->samples, "Number of evenly spaced samples")
      ->check(CLI::PositiveNumber)
      ->excludes(x);
  command
      ->add_option("--equilibrium-tolerance", arguments->equilibrium_tolerance,
                   "Relative residual of an equilibrium (1e-10)")
      ->check(CLI::PositiveNumber);
  command->add_option("--orientation", arguments->orientation, "Angle by which the tiling is turned (0)");
  command
      ->add_option("--youngs-modulus", arguments->youngs_modulus,
                   "Young's modulus of the material in MPa (the model's, 26)")
      ->transform(quantity(Dimension::stress))
      ->check(CLI::PositiveNumber);
  command->add_option("--deadline", arguments->deadline, "Seconds that the computation may take, or for example 2min")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
  command->add_option("--csv", arguments->csv_file, "Write the profile to this file, - for the terminal");
  command->add_option("--plot", arguments->plot_file, "Draw the profile as SVG or PNG, - for the terminal (SVG)")
      ->check(plot_file());
  command->footer(
      "Examples:\n  supple profile --task stress_strain --family IH67 --parameters 0.2,0.9 --direction 45deg --csv -\n"
      "  supple profile --task poisson --family IH67 --parameters 0.2,0.9 --strain -0.1 --plot poisson.svg");
  command->callback([&options, arguments, command] {
    refuse_idle_profile_options(*command, arguments->profile.task);
    run(options, *arguments);
  });
}

}  // namespace supple::cli
