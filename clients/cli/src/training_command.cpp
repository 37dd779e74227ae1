#include "training_command.h"

#include <fmt/format.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "units.h"

namespace supple::cli {
namespace {

struct TrainingArguments {
  std::string family;
  double core_seconds = 0;
  std::optional<double> error;
  std::optional<double> deadline;
  std::optional<int> seed;
  bool only_plan = false;
};

nlohmann::json request_of(const TrainingArguments& arguments) {
  nlohmann::json request{{"family", arguments.family}, {"budget", {{"core_seconds", arguments.core_seconds}}}};
  if (arguments.error) request["accuracy"] = {{"error", *arguments.error}};
  if (arguments.deadline) request["deadline"] = *arguments.deadline;
  if (arguments.seed) request["seed"] = *arguments.seed;
  return request;
}

void print_estimate(const nlohmann::json& answer) {
  const auto& estimate = answer.at("estimate");
  fmt::print("planned     {:.0f} core-seconds of simulations, {:.0f} of trainings\n",
             estimate.at("simulation").get<double>(), estimate.at("training").get<double>());
  fmt::print("designs     {}, of which small networks choose {}\n", estimate.at("designs").get<std::int64_t>(),
             estimate.at("chosen_designs").get<std::int64_t>());
}

void run(const GlobalOptions& options, const TrainingArguments& arguments) {
  Session session(options);
  const auto* const path = arguments.only_plan ? "/v1/training-plans" : "/v1/trainings";
  const nlohmann::json answer = session.compute(path, request_of(arguments)).json();
  if (session.json()) return print_json(answer);
  if (!arguments.only_plan)
    fmt::print("model       {} of {}: errs by {:.3g} % in the mean on designs that it has not seen, after {} designs\n",
               answer.at("model").get<std::string>(), answer.at("family").get<std::string>(),
               100 * answer.at("error").get<double>(), answer.at("designs").get<std::int64_t>());
  print_estimate(answer);
}

}  // namespace

void add_training_command(CLI::App& families, const GlobalOptions& options) {
  const auto arguments = std::make_shared<TrainingArguments>();
  CLI::App* command =
      families.add_subcommand("train", "Train a network of a family; the same command goes on where it was stopped");
  command->add_option("family", arguments->family, "Family of the server or of one's own")->required();
  command
      ->add_option("--core-time", arguments->core_seconds,
                   "Time of one core for all simulations and trainings: seconds, or for example 5h")
      ->required()
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
  command
      ->add_option("--error", arguments->error,
                   "Mean error at which no more designs are simulated, for example 2%; without it the time is used up")
      ->transform(quantity(Dimension::ratio));
  command->add_option("--seed", arguments->seed, "Of the designs and loads (1)");
  command
      ->add_option("--deadline", arguments->deadline, "Seconds after which it is stopped and kept, or for example 12h")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
  command->add_flag("--plan", arguments->only_plan, "Only say what it takes");
  command->footer(
      "Examples:\n  supple families train own --core-time 4h --plan\n"
      "  supple --priority background families train own --core-time 4h");
  command->callback([&options, arguments] { run(options, *arguments); });
}

}  // namespace supple::cli
