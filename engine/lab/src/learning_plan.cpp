#include <algorithm>
#include <cmath>
#include <string>

#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/lab/design_sequence.h"
#include "supple/lab/design_simulation.h"
#include "supple/lab/family_learning.h"

namespace supple::lab {
namespace {

/// Core-seconds that one state takes in one epoch, fitted to what networks of 32 to 256 neurons take
/// (docs/notes/models.md).
double state_seconds(int width) { return 2.5e-5 + 8e-9 * width * width; }

/// Fraction of the core-seconds that simulations get. Errors fall with designs for longer than with epochs.
constexpr double simulation_share = 0.65;
/// Even designs for each parameter and one more, without which networks do not even judge each other.
constexpr int min_designs_per_dimension = 15;
/// With fewer designs than this the members of a committee differ by chance.
constexpr std::int64_t min_designs_of_committees = 100;
constexpr std::int64_t max_designs = 20'000;
constexpr int wide = 96;
constexpr int narrow = 64;
constexpr int min_epochs = 150;
constexpr int max_epochs = 2000;

double training_seconds(const LearningPlan& plan, int states) {
  double seconds = 0;
  for (int round = 0; round < plan.rounds; ++round) {
    const auto designs = static_cast<double>(plan.even_designs + round * plan.round_designs);
    seconds += plan.members * plan.member_epochs * designs * states * state_seconds(plan.member_width);
  }
  const auto designs = static_cast<double>(plan.even_designs + plan.rounds * plan.round_designs);
  return seconds + plan.epochs * designs * states * state_seconds(plan.width);
}

/// The plan with this number of designs, without its epochs.
LearningPlan with_designs(std::int64_t designs) {
  LearningPlan plan;
  if (designs < min_designs_of_committees) plan.rounds = 0;
  plan.round_designs = plan.rounds > 0 ? designs / (2 * plan.rounds) : 0;
  plan.even_designs = designs - plan.rounds * plan.round_designs;
  return plan;
}

}  // namespace

LearningCost cost_of(const LearningPlan& plan, double design_seconds, int states) {
  const auto designs = static_cast<double>(plan.even_designs + plan.rounds * plan.round_designs);
  return {designs * design_seconds, training_seconds(plan, states)};
}

LearningPlan plan_within(double core_seconds, double design_seconds, int states, int parameters) {
  const std::int64_t min_designs = std::int64_t{min_designs_per_dimension} * (parameters + 1);
  // The cheapest plan with this number of designs.
  const auto cheapest = [](std::int64_t designs) {
    auto plan = with_designs(designs);
    plan.width = narrow;
    plan.epochs = min_epochs;
    return plan;
  };
  if (const double needed = cost_of(cheapest(min_designs), design_seconds, states).total(); needed > core_seconds) {
    const std::string message =
        "A network of " + std::to_string(parameters) + " parameters takes about " + number_text(std::ceil(needed)) +
        " core-seconds at least: " + std::to_string(min_designs) + " designs of " + number_text(design_seconds) +
        " s each, and their training; there are " + number_text(core_seconds);
    throw Error("training.small_budget", message + ".", {{"budget/core_seconds", message}});
  }
  // The largest number of designs that their fraction of the time and the training of the cheapest plan allow.
  std::int64_t designs = min_designs;
  std::int64_t too_many = max_designs + 1;
  while (too_many - designs > 1) {
    const std::int64_t middle = (designs + too_many) / 2;
    const auto cost = cost_of(cheapest(middle), design_seconds, states);
    const bool fits = cost.simulation <= simulation_share * core_seconds && cost.total() <= core_seconds;
    (fits ? designs : too_many) = middle;
  }
  LearningPlan plan = with_designs(designs);
  for (const int width : {wide, narrow}) {
    plan.width = width;
    plan.epochs = 0;
    const double left = core_seconds - cost_of(plan, design_seconds, states).total();
    const double epochs = left / (static_cast<double>(designs) * states * state_seconds(width));
    plan.epochs = static_cast<int>(std::clamp<double>(epochs, min_epochs, max_epochs));
    if (epochs >= 2 * min_epochs) break;
  }
  return plan;
}

int states_of(const DatasetOptions& options) {
  int states = 0;
  for (const auto& path : planned_design(options, 0).paths) states += static_cast<int>(path.stretches.size());
  return states;
}

double design_seconds(const DatasetOptions& options, const CancellationToken& cancellation) {
  constexpr int designs = 4;
  // The corners of the box come first, and are not usual designs.
  const std::int64_t first = options.list.empty() && options.parameters.empty() && options.corners
                                 ? std::int64_t{1} << family_of(options).parameters.size()
                                 : 0;
  double seconds = 0;
  int simulated = 0;
  std::string why;
  for (int i = 0; i < designs; ++i) {
    const auto design = simulate_design(options, planned_design(options, first + i), cancellation);
    if (why.empty()) why = design.error_message;
    if (design.rows.empty()) continue;
    seconds += design.seconds;
    ++simulated;
  }
  if (simulated == 0)
    throw Error("training.too_few_designs",
                "None of the first " + std::to_string(designs) + " designs of the family can be simulated: " + why);
  return seconds / simulated;
}

}  // namespace supple::lab
