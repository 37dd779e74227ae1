#include "supple/json/trainings.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "endpoint.h"
#include "handlers.h"
#include "request_pointers.h"
#include "results.h"
#include "supple/base/durable_file.h"
#include "supple/store/store.h"
#include "supple/tiling/definition_text.h"
#include "supple/tiling/tiling_error.h"
#include "supple/trainings/lab_lines.h"
#include "supple/trainings/lab_process.h"

namespace supple::routes {
namespace {

namespace fs = std::filesystem;

/// Everything that a training needs, in the thread that runs it.
struct Training {
  json::TrainingRequest request;
  std::string definition;  ///< of the family, as supple-lab reads it
  std::string owner;
  LabSettings lab;
  fs::path data;  ///< the server's data folder
  const store::ModelStore* models = nullptr;

  /// Names the training's folder. The same request of the same owner goes on where an earlier one was stopped.
  std::string hash() const {
    return store::sha256(owner + '\n' + definition + '\n' + plain_number(request.core_seconds) + '\n' +
                         plain_number(request.error) + '\n' + std::to_string(request.seed));
  }
  fs::path folder() const { return data / "trainings" / hash().substr(0, 32); }
  std::string model_id() const {
    std::string id;
    for (const char c : request.family) id += c == '_' ? '-' : static_cast<char>(std::tolower(c));
    return id + "-" + hash().substr(0, 8);
  }
};

std::string content_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The fault that supple-lab reports in its last lines: "supple-lab: SENTENCE (CODE)".
[[noreturn]] void throw_fault(const trainings::LabEnding& ending) {
  constexpr std::string_view begin = "supple-lab: ";
  const auto first = ending.errors.rfind(begin);
  const auto line =
      first == std::string::npos
          ? std::string()
          : ending.errors.substr(first + begin.size(), ending.errors.find('\n', first) - first - begin.size());
  const auto open = line.rfind(" (");
  const auto code =
      open == std::string::npos || !line.ends_with(')') ? std::string() : line.substr(open + 2, line.size() - open - 3);
  // These are the faults of a request, and those of the disk. All others are unexpected.
  constexpr std::array<std::array<const char*, 2>, 5> faults_and_fields{
      {{"training.small_budget", "/budget/core_seconds"},
       {"training.too_few_designs", "/family"},
       {"training.diverged", "/family"},
       {"dataset.in_use", ""},
       {"file.write_failed", ""}}};
  for (const auto& [known, field] : faults_and_fields) {
    if (code != known) continue;
    const auto sentence = line.substr(0, open);
    if (*field == '\0') throw Error(code, sentence);
    throw Error(code, sentence, {{field, sentence}});
  }
  throw Error("training.failed", "supple-lab ended with status " + std::to_string(ending.status) + ": " +
                                     (line.empty() ? ending.errors : line));
}

/// Runs supple-lab. Throws what a stop request throws, and the fault that it ends with.
template <class OnLine>
void run_lab(const Training& training, std::vector<std::string> arguments, const Execution& execution,
             const OnLine& on_line) {
  const auto definition = training.folder() / "definition.txt";
  if (!fs::exists(definition)) {
    fs::create_directories(training.folder());
    write_atomically(definition, {training.definition});
  }
  for (const auto& argument :
       {std::string("--definition"), definition.string(), std::string("--seed"), std::to_string(training.request.seed)})
    arguments.push_back(argument);
  const auto ending = trainings::run_lab(
      {.program = training.lab.program, .arguments = std::move(arguments), .memory = training.lab.memory},
      execution.cancellation, on_line);
  execution.cancellation.throw_if_requested();
  if (ending.status != 0) throw_fault(ending);
}

std::string text_of(const trainings::LabPlan& plan) {
  return plan.options + "\nsimulation " + plain_number(plan.simulation_seconds) + "\ntraining " +
         plain_number(plan.training_seconds) + "\n";
}

/// The plan of a training, which is made once, so that a run that goes on has the same one.
trainings::LabPlan plan_of(const Training& training, const Execution& execution) {
  const auto path = training.folder() / "plan.txt";
  trainings::LabPlanReader reader;
  if (fs::exists(path)) {
    std::istringstream lines(content_of(path));
    for (std::string line; std::getline(lines, line);) reader.read(line);
    if (auto plan = reader.plan()) return *plan;
  }
  const StageTimer timer(execution.cost, "plan");
  trainings::LabPlanReader fresh;
  run_lab(training, {"plan", "--core-seconds", plain_number(training.request.core_seconds)}, execution,
          [&](std::string_view line) { fresh.read(line); });
  const auto plan = fresh.plan();
  if (!plan) throw Error("training.failed", "supple-lab printed no plan.");
  write_atomically(path, {text_of(*plan)});
  return *plan;
}

json::TrainingEstimate estimate_of(const trainings::LabPlan& plan) {
  const auto chosen = plan.rounds * plan.round_designs;
  return {plan.simulation_seconds, plan.training_seconds, plan.even_designs + chosen, chosen};
}

/// Bills the committees of small networks that choose designs, of which `finished` have measured their error.
void bill_committees(const Execution& execution, const trainings::LabPlan& plan, std::int64_t finished) {
  std::string why = "the budget has too few designs for small networks to judge them";
  if (plan.rounds > 0)
    why = plain_number(static_cast<double>(plan.rounds)) + " rounds of " +
          plain_number(static_cast<double>(plan.round_designs)) + " designs are planned";
  if (finished > 0 && finished < plan.rounds) why += "; the error that was asked for was reached before";
  execution.cost->add_effect("committee", finished > 0, why, finished);
}

/// Puts the finished model where the server reads models, and waits until it is there.
void serve(const Training& training, const Execution& execution) {
  const auto folder = training.data / "models";
  fs::create_directories(folder);
  const auto id = training.model_id();
  write_atomically(folder / (store::ModelStore::mark_of(training.owner) + "-" + id + ".h5"),
                   {content_of(training.folder() / "network" / "model.h5")});
  constexpr int checks = 600;
  for (int k = 0; k < checks; ++k) {
    for (const auto& model : training.models->models(training.owner))
      if (model->model.id == id) return;
    execution.cancellation.throw_if_requested();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  throw Error("training.failed", "The finished model " + id + " is not read by the server; its log says why.");
}

store::Result plan(const Training& training, const Execution& outer) {
  trainings::LabPlan made;
  const auto bill = billed(outer, [&](const Execution& execution) {
    made = plan_of(training, execution);
    bill_committees(execution, made, 0);
  });
  return json_result(json::write_training_plan(training.request.family, estimate_of(made), bill));
}

store::Result train(const Training& training, const Execution& outer) {
  json::FinishedTraining finished{
      .model = training.model_id(), .family = training.request.family, .errors = {}, .estimate = {}};
  const auto bill = billed(outer, [&](const Execution& execution) {
    const auto made = plan_of(training, execution);
    finished.estimate = estimate_of(made);
    std::vector<std::string> arguments{"learn",        "--folder", (training.folder() / "network").string(), "--id",
                                       finished.model, "--error",  plain_number(training.request.error)};
    std::istringstream options(made.options);
    for (std::string option; options >> option;) arguments.push_back(option);
    const StageTimer timer(execution.cost, "learning");
    run_lab(training, std::move(arguments), execution, [&](std::string_view line) {
      if (execution.progress && line == "saved") execution.progress->saved();
      if (const auto progress = trainings::progress_in(line))
        if (execution.progress) execution.progress->report(progress->fraction, progress->stage);
      if (const auto error = trainings::error_in(line)) {
        finished.errors.push_back({error->error, error->designs});
        if (execution.progress)
          execution.progress->publish(json::write_partial_training(finished.family, finished.errors));
      }
    });
    // The last error is that of the finished network.
    bill_committees(execution, made, std::ssize(finished.errors) - 1);
    serve(training, execution);
  });
  return json_result(json::write_training(finished, bill));
}

Training training_of(const EndpointRequest& asked, const Loader& loader, const Services& services) {
  auto limits = loader.limits();
  limits.max_deadline = limits.default_deadline = services.limits.max_training;
  limits.deadline_setting = "--max-training";
  Training training{.request = json::parse_training(asked.body, limits, loader.cancellation()),
                    .definition = {},
                    .owner = loader.owner(),
                    .lab = services.lab,
                    .data = services.data,
                    .models = services.models};
  const auto family =
      fault_of_field<tiling::FamilyNotFound>("/family", [&] { return loader.family(training.request.family); });
  if (!family->definition)
    throw Error("family.no_definition", "The family " + training.request.family + " has no definition.",
                {{"/family", "has no definition"}});
  training.definition = tiling::to_text(*family->definition);
  if (services.lab.program.empty())
    throw Error("training.unavailable", "This server has no supple-lab, which trains networks.");
  return training;
}

template <class Run>
Endpoint::Prepare prepare_with(const Services& services, Run run) {
  return [&services, run](const EndpointRequest& asked, const Loader& loader) {
    auto training = training_of(asked, loader, services);
    const double deadline = training.request.deadline;
    return PreparedComputation{
        .deadline = deadline,
        .run = [training = std::move(training), run](const Execution& execution) { return run(training, execution); }};
  };
}

}  // namespace

void add_training_routes(http::Router& router, Services& services) {
  add_endpoint(router, services, {.kind = "training-plans", .prepare = prepare_with(services, plan)});
  add_endpoint(router, services, {.kind = "trainings", .is_long = true, .prepare = prepare_with(services, train)});
}

}  // namespace supple::routes
