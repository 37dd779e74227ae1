#include "learning_commands.h"

#include <fmt/format.h>

#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <mutex>
#include <string>

#include "family_option.h"
#include "supple/base/threads.h"
#include "supple/lab/family_learning.h"

namespace supple::lab {
namespace {

struct LearningArguments {
  FamilyOption family;
  LearningOptions options;
  std::filesystem::path folder;
  double core_seconds = 0;
  int threads = 0;
};

/// Writes a line on stdout for each change, which a program can read: "progress 0.25 designs", "saved", "error 0.031
/// 120".
class ProgressLines : public LearningListener {
 public:
  void progress(double fraction, const std::string& stage) override {
    const std::scoped_lock lock(mutex_);
    const int thousandths = static_cast<int>(1000 * fraction);
    if (thousandths == thousandths_ && stage == stage_) return;
    thousandths_ = thousandths;
    stage_ = stage;
    fmt::print("progress {:.3f} {}\n", fraction, stage);
    std::fflush(stdout);
  }
  void saved() override {
    const std::scoped_lock lock(mutex_);
    fmt::print("saved\n");
    std::fflush(stdout);
  }
  void error_reached(double error, std::int64_t designs) override {
    const std::scoped_lock lock(mutex_);
    fmt::print("error {:.6f} {}\n", error, designs);
    std::fflush(stdout);
  }

 private:
  std::mutex mutex_;
  int thousandths_ = -1;
  std::string stage_;
};

void prepare(LearningArguments& arguments) {
  auto& data = arguments.options.data;
  set_family(arguments.family, data);
  data.simulation.mesh.mesh_size = family_of(data).sufficient_mesh_size;
  data.simulation.mesh.corner_size = 0.1;
  set_thread_count(arguments.threads);
}

void print_plan(const LearningPlan& plan, const LearningCost& cost) {
  fmt::print(
      "--even-designs {} --rounds {} --round-designs {} --members {} --member-width {} --member-epochs {} --width {} "
      "--epochs {}\n",
      plan.even_designs, plan.rounds, plan.round_designs, plan.members, plan.member_width, plan.member_epochs,
      plan.width, plan.epochs);
  fmt::print("simulation {:.0f} core-seconds\ntraining {:.0f} core-seconds\n", cost.simulation, cost.training);
}

void plan(LearningArguments& arguments, const StopSignals& signals) {
  prepare(arguments);
  const auto& data = arguments.options.data;
  const double seconds = design_seconds(data, signals.cancellation());
  const int states = states_of(data);
  const auto parameters = static_cast<int>(family_of(data).parameters.size());
  const auto made = plan_within(arguments.core_seconds, seconds, states, parameters);
  print_plan(made, cost_of(made, seconds, states));
}

void learn(LearningArguments& arguments, const StopSignals& signals, bool& interrupted) {
  prepare(arguments);
  ProgressLines progress;
  const auto result = learn_family(arguments.options, arguments.folder, signals.cancellation(), &progress);
  interrupted = !result.finished;
  if (interrupted)
    fmt::print(stderr, "interrupted: the same command goes on\n");
  else
    fmt::print("{} errs by {:.2f} % in the mean on designs that it has not seen, after {} designs\n",
               result.model.string(), 100 * result.error, result.designs);
}

void add_common_options(CLI::App& command, LearningArguments& arguments) {
  add_family_options(command, arguments.family);
  command.add_option("--seed", arguments.options.data.seed, "Of the designs and loads")->capture_default_str();
  command.add_option("--threads", arguments.threads, "0: one for each core")->capture_default_str();
}

void add_plan_options(CLI::App& command, LearningPlan& plan) {
  const auto option = [&command](const char* name, auto& value, const char* about) {
    command.add_option(name, value, about)->capture_default_str()->group("Plan");
  };
  option("--even-designs", plan.even_designs, "Designs that are spread evenly over the box of parameters");
  option("--rounds", plan.rounds, "Rounds of designs that a committee of networks chooses");
  option("--round-designs", plan.round_designs, "Designs of a round");
  option("--members", plan.members, "Networks of a committee");
  option("--member-width", plan.member_width, "Neurons of their layers, a multiple of 16");
  option("--member-epochs", plan.member_epochs, "Passes of a member over the data");
  option("--width", plan.width, "Neurons of the network's layers, a multiple of 16");
  option("--epochs", plan.epochs, "Passes of the network over the data");
}

}  // namespace

void add_learning_commands(CLI::App& program, const StopSignals& signals, bool& interrupted) {
  const auto planned = std::make_shared<LearningArguments>();
  CLI::App* planner = program.add_subcommand("plan", "Print the options of \"learn\" for a number of core-seconds");
  add_common_options(*planner, *planned);
  planner->add_option("--core-seconds", planned->core_seconds, "Of all simulations and trainings")->required();
  planner->callback([=, &signals] { plan(*planned, signals); });

  const auto learned = std::make_shared<LearningArguments>();
  CLI::App* learner = program.add_subcommand(
      "learn", "Make a network of a family: simulate, choose designs, train; interrupted, the same command goes on");
  add_common_options(*learner, *learned);
  learner->add_option("--folder", learned->folder, "Folder of everything that is made; model.h5 is the network")
      ->required();
  learner->add_option("--error", learned->options.error, "Mean error at which no more designs are chosen; 0: never")
      ->capture_default_str();
  learner->add_option("--id", learned->options.id, "Of the model; the family's unless given");
  add_plan_options(*learner, learned->options.plan);
  learner->callback([=, &signals, &interrupted] { learn(*learned, signals, interrupted); });
}

}  // namespace supple::lab
