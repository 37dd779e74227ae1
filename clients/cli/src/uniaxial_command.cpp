#include <fmt/format.h>

#include <memory>

#include "angles.h"
#include "commands.h"
#include "failure.h"
#include "load_arguments.h"
#include "model_output.h"
#include "numbers.h"
#include "units.h"

namespace supple::cli {
namespace {

struct UniaxialArguments {
  std::string model;
  std::string parameters;
  std::string direction;
  std::string stretches;
  std::string green_strains;
  double tolerance = 0;
  double deadline = 0;
  std::string csv_file;
};

nlohmann::json request_of(const UniaxialArguments& arguments) {
  nlohmann::json request = {{"parameters", parse_numbers(arguments.parameters, "list of parameters")},
                            {"direction", parse_angle(arguments.direction, "--direction")}};
  if (arguments.stretches.empty() == arguments.green_strains.empty())
    throw Failure(ExitCode::usage, "no load: give --stretches or --green-strains");
  if (!arguments.stretches.empty())
    request["stretches"] = parse_series(arguments.stretches, "list of stretches");
  else
    request["green_strains"] = parse_series(arguments.green_strains, "list of strains");
  if (arguments.tolerance > 0) request["accuracy"]["tolerance"] = arguments.tolerance;
  if (arguments.deadline > 0) request["deadline"] = arguments.deadline;
  return request;
}

void run(const GlobalOptions& options, const UniaxialArguments& arguments) {
  const nlohmann::json request = request_of(arguments);
  Session session(options);
  const nlohmann::json answer = session.compute("/v1/models/" + arguments.model + "/uniaxial", request).json();
  if (!arguments.csv_file.empty()) write_file(arguments.csv_file, uniaxial_as_csv(answer.at("states")));
  if (arguments.csv_file == "-") return;
  session.json() ? print_json(answer) : print_uniaxial(answer);
}

}  // namespace

void add_uniaxial_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<UniaxialArguments>();
  CLI::App* command =
      program.add_subcommand("uniaxial", "A neural model's stress along a direction, lateral strain and shear free");
  command->add_option("model", arguments->model, "Model, see supple models")->required();
  command->add_option("-p,--parameters", arguments->parameters, "Parameters, separated by commas")->required();
  command->add_option("-d,--direction", arguments->direction, "Direction of the load, for example 45deg")->required();
  auto* const stretches = command
                              ->add_option("--stretches", arguments->stretches,
                                           "Stretches along it in their order: 1.05,1.1 or first:last:n")
                              ->transform(quantity(Dimension::ratio));
  command->add_option("--green-strains", arguments->green_strains, "Or Green strains along it, written likewise")
      ->transform(quantity(Dimension::ratio))
      ->excludes(stretches);
  command->add_option("-t,--tolerance", arguments->tolerance, "Relative residual of an equilibrium (1e-10)")
      ->check(CLI::PositiveNumber);
  command->add_option("--deadline", arguments->deadline, "Seconds that the computation may take, or for example 2min")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
  command->add_option("--csv", arguments->csv_file, "Write the states to this file, - for the terminal");
  command->footer(
      "Examples:\n  supple uniaxial ih21 --parameters 0.15,0.65 --direction 0 --stretches 1.02:1.2:10\n"
      "  supple uniaxial ih21 --parameters 0.15,0.65 --direction 45deg --green-strains -0.05,-0.1 --csv curve.csv");
  command->callback([&options, arguments] { run(options, *arguments); });
}

}  // namespace supple::cli
