#include "polish_rounds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>
#include <string>
#include <utility>

#include "supple/base/best_so_far.h"
#include "supple/base/error.h"
#include "supple/microscale/simulation_error.h"
#include "supple/tiling/tiling_error.h"

namespace supple::design {
namespace {

double seconds_since(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Number of samples of a target that are simulated, at most `limit`. They can be samples of the target itself if a
/// divisor of its number of intervals gives at least half of `limit` samples. Otherwise they lie between those.
int samples_to_simulate(const Target& target, int limit) {
  const bool over_strain = target.task == Task::stress_strain;
  const int target_samples = static_cast<int>(sample_target(target).y.size());
  if (target_samples <= limit) return target_samples;
  // Samples over strain include both ends. Samples over directions divide a period.
  const int intervals = over_strain ? target_samples - 1 : target_samples;
  for (int count = over_strain ? limit - 1 : limit; 2 * count >= limit; --count)
    if (count > 0 && intervals % count == 0) return over_strain ? count + 1 : count;
  return limit;
}

DesignProblem with_few_samples(DesignProblem problem, int limit) {
  for (Target& target : problem.targets) target.samples = samples_to_simulate(target, limit);
  return problem;
}

Eigen::VectorXd joined(const std::vector<Eigen::VectorXd>& parts) {
  Eigen::Index n = 0;
  for (const Eigen::VectorXd& part : parts) n += part.size();
  Eigen::VectorXd values(n);
  n = 0;
  for (const Eigen::VectorXd& part : parts) {
    values.segment(n, part.size()) = part;
    n += part.size();
  }
  return values;
}

}  // namespace

PolishRounds::PolishRounds(const DesignSpace& space, const DesignProblem& problem, const SimulateProfile& simulate,
                           const PolishOptions& options, const Execution& execution, const OnPolishRound& on_round)
    : problem_(with_few_samples(problem, options.samples)),
      simulate_(simulate),
      options_(options),
      execution_(execution),
      on_round_(on_round),
      model_(space, problem_, options.equilibrium_tolerance),
      start_(Clock::now()) {}

void PolishRounds::resume(const Polished& before) {
  rounds_ = before.rounds;
  for (const PolishRound& round : before.rounds) {
    longest_round_ = std::max(longest_round_, round.seconds);
    tried_.push_back(model_.normalized(FreeParameters::all_of(round.parameters, round.orientation)));
  }
  best_.x = model_.normalized(FreeParameters::all_of(before.parameters, before.orientation));
  best_.simulated = scaled(model_.targets(), joined(before.simulated), 1 / before.stress_factor);
  best_.model = scaled(model_.targets(), joined(before.model), 1 / before.stress_factor);
  best_.deviation = before.target_error.value_or(infinite);
  if (std::isfinite(best_.deviation)) observations_.push_back({best_.x, best_.correction()});
}

SimulatedDesign PolishRounds::simulate_found(const Eigen::VectorXd& parameters) {
  return simulate(Proposal::search, model_.normalized(parameters), parameters);
}

SimulatedDesign PolishRounds::simulate(Proposal proposal, const Eigen::VectorXd& x) {
  return simulate(proposal, x, model_.parameters_at(x));
}

SimulatedDesign PolishRounds::simulate(Proposal proposal, const Eigen::VectorXd& x, const Eigen::VectorXd& parameters) {
  const auto begin = Clock::now();
  PolishRound round;
  round.proposal = proposal;
  round.parameters = family_part(parameters);
  round.orientation = orientation_in(parameters);
  SimulatedDesign trial;
  trial.x = x;
  run_simulation(parameters, trial, round);
  if (std::isfinite(trial.deviation)) round.target_error = trial.deviation;
  round.accepted = rounds_.empty() ? round.target_error.has_value() : trial.deviation < best_.deviation;
  if (!round.accepted && round.reason.empty()) round.reason = "Its simulated deviation is not less.";
  tried_.push_back(x);
  if (std::isfinite(trial.deviation)) observations_.push_back({x, trial.correction()});
  // The design of the search is the answer until another one is accepted, even if its simulation failed.
  if (round.accepted || rounds_.empty()) best_ = trial;
  record(std::move(round), begin);
  return trial;
}

/// Writes the simulated values into `trial`. If the design has to be refused, the reason goes into the round.
void PolishRounds::run_simulation(const Eigen::VectorXd& parameters, SimulatedDesign& trial, PolishRound& round) {
  const auto begin = Clock::now();
  try {
    if (round.proposal != Proposal::search) round.reason = model_.excess_at(parameters);
    if (!round.reason.empty()) return;
    Eigen::VectorXd simulated(model_.samples());
    Eigen::Index at = 0;
    const Execution inner{execution_.cancellation, nullptr, execution_.cost};
    for (const SampledTarget& target : model_.targets()) {
      simulated.segment(at, target.y.size()) = simulate_(round.parameters, oriented(target.samples, parameters), inner);
      at += target.y.size();
    }
    trial.deviation = model_.deviation(simulated);
    trial.simulated = std::move(simulated);
    trial.model = model_.at(parameters).values;
    if (!std::isfinite(trial.deviation)) round.reason = "The simulation does not reach every sample.";
    if (!trial.model.allFinite()) {
      trial.deviation = rounds_.empty() ? trial.deviation : infinite;
      round.reason = "The network has no equilibrium at every sample.";
    }
  } catch (const Cancelled& stop) {
    if (keeps_best(stop.reason())) record_stopped(std::move(round), stop.reason(), begin);
    throw;
  } catch (const std::bad_alloc&) {
    record_stopped(std::move(round), StopReason::memory, begin);
    throw;
  } catch (const tiling::TilingError& error) {
    round.reason = error.what();
  } catch (const microscale::SimulationError& error) {
    round.reason = error.what();
  }
}

void PolishRounds::record_stopped(PolishRound round, StopReason reason, Clock::time_point begin) {
  round.reason = stop_sentence(reason, " before the simulation had ended.");
  record(std::move(round), begin);
}

void PolishRounds::record(PolishRound round, Clock::time_point begin) {
  round.seconds = seconds_since(begin);
  longest_round_ = std::max(longest_round_, round.seconds);
  if (execution_.progress) {
    const double fraction = static_cast<double>(rounds_.size() + 1) / (options_.max_rounds + 1);
    execution_.progress->report(std::min(fraction, 0.99), "polish");
  }
  rounds_.push_back(std::move(round));
  if (on_round_) on_round_(rounds_.back());
}

double PolishRounds::seconds() const { return seconds_since(start_); }

std::optional<PolishTermination> PolishRounds::termination() const {
  if (best_.deviation <= options_.tolerance) return PolishTermination::reached;
  if (model_.width().size() == 0) return PolishTermination::no_improvement;
  if (count() > options_.max_rounds) return PolishTermination::round_limit;
  if (seconds() + longest_round_ > options_.max_seconds) return PolishTermination::time_limit;
  return std::nullopt;
}

Polished PolishRounds::result(PolishTermination stopped) const {
  Polished result;
  result.rounds = rounds_;
  result.stopped = is_stopped(stopped) || std::isfinite(best_.deviation) ? stopped : PolishTermination::not_simulated;
  // The parameters of the round, because normalizing parameters and converting them back would round them.
  const PolishRound* best = &rounds_.front();
  for (const PolishRound& round : rounds_)
    if (round.accepted) best = &round;
  result.parameters = best->parameters;
  result.orientation = best->orientation;
  const auto chosen = model_.modulus_for(
      best_.simulated.size() > 0
          ? best_.simulated
          : Eigen::VectorXd(Eigen::VectorXd::Constant(model_.samples(), std::numeric_limits<double>::quiet_NaN())));
  result.material = chosen.material;
  result.youngs_modulus = chosen.modulus;
  result.stress_factor = chosen.factor;
  const auto at_modulus = [&](const Eigen::VectorXd& values) {
    return model_.split_by_target(values.size() > 0 ? scaled(model_.targets(), values, chosen.factor) : values);
  };
  result.simulated = at_modulus(best_.simulated);
  result.model = at_modulus(best_.model);
  if (std::isfinite(best_.deviation)) result.target_error = best_.deviation;
  result.targets = model_.targets();
  for (SampledTarget& target : result.targets) target.samples.orientation = result.orientation;
  return result;
}

}  // namespace supple::design
