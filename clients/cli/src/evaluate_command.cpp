#include <fmt/format.h>

#include <memory>
#include <vector>

#include "commands.h"
#include "load_arguments.h"
#include "model_output.h"
#include "numbers.h"
#include "units.h"

namespace supple::cli {
namespace {

struct EvaluationArguments {
  std::string model;
  std::string parameters;
  std::vector<std::string> strains;
  int derivatives = 1;
  double deadline = 0;
  std::string csv_file;
};

nlohmann::json request_of(const EvaluationArguments& arguments) {
  bool is_file = false;
  auto designs = nlohmann::json::array();
  for (const auto& row : parse_rows(arguments.parameters, is_file))
    designs.push_back(parse_numbers(row, "list of parameters"));
  auto strains = nlohmann::json::array();
  for (const auto& argument : arguments.strains) {
    for (const auto& strain : parse_green_strains(argument)) strains.push_back(strain);
  }
  nlohmann::json request = {{"parameters", designs}, {"green_strain", strains}, {"derivatives", arguments.derivatives}};
  if (arguments.deadline > 0) request["deadline"] = arguments.deadline;
  return request;
}

void run(const GlobalOptions& options, const EvaluationArguments& arguments) {
  const nlohmann::json request = request_of(arguments);
  const auto& strains = request.at("green_strain");
  Session session(options);
  const nlohmann::json answer = session.compute("/v1/models/" + arguments.model + "/evaluations", request).json();
  if (!arguments.csv_file.empty()) write_file(arguments.csv_file, evaluation_as_csv(strains, answer));
  if (arguments.csv_file == "-") return;
  session.json() ? print_json(answer) : print_evaluation(strains, answer);
}

}  // namespace

void add_evaluate_command(CLI::App& program, const GlobalOptions& options) {
  const auto arguments = std::make_shared<EvaluationArguments>();
  CLI::App* command = program.add_subcommand("evaluate", "Energy, stress and stiffness as a neural model has them");
  command->add_option("model", arguments->model, "Model, see supple models")->required();
  command
      ->add_option(
          "-p,--parameters", arguments->parameters,
          "Design: parameters, separated by commas; or one for each strain, separated by ; or in a file's lines")
      ->required();
  command
      ->add_option("-s,--strain", arguments->strains,
                   "Green strains xx,yy,xy (tensor components), several separated by ; or in the lines of a file")
      ->required();
  command->add_option("-d,--derivatives", arguments->derivatives, "0: energies; 1: stresses too; 2: tangents too (1)")
      ->check(CLI::Range(0, 2));
  command->add_option("--deadline", arguments->deadline, "Seconds that the computation may take, or for example 2min")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
  command->add_option("--csv", arguments->csv_file, "Write the answer to this file, - for the terminal");
  command->footer(
      "Examples:\n  supple evaluate ih21 --parameters 0.15,0.65 --strain 0.05,0,0 --strain 0.1,-0.02,0.01\n"
      "  supple evaluate ih21 --parameters \"0.15,0.65;0.12,0.7\" --strain \"0.05,0,0;0.05,0,0\" --derivatives 2\n"
      "  supple evaluate ih21 --parameters 0.15,0.65 --strain strains.csv --csv stresses.csv");
  command->callback([&options, arguments] { run(options, *arguments); });
}

}  // namespace supple::cli
