// The search for designs whose error bars are shorter.
#include <algorithm>
#include <chrono>
#include <vector>

#include "search_steps.h"

namespace supple::design {
namespace {

/// Maximum number of candidates that are evaluated, and maximum number of designs around the best one that are then
/// evaluated.
constexpr int max_trust_evaluations = 32;
/// Initial and final distance of the pattern search around the best design, as fractions of the bounds' widths.
constexpr double initial_distance = 0.1;
constexpr double min_distance = 0.01;

/// Compares candidates with the best design, and returns their number.
int compare_candidates(const SearchState& state, const Execution& execution) {
  const SearchProblem& problem = state.problem;
  state.candidates.evaluate(execution);
  std::vector<Eigen::VectorXd> tried;
  for (const auto& [error, candidate] : state.candidates.ranked(0)) {
    if (!(error < state.best.merit()) || tried.size() >= max_trust_evaluations) break;
    const Eigen::VectorXd all = state.candidates.at(candidate);
    if (problem.is_near_any(tried, all, min_start_distance)) continue;
    tried.push_back(all);
    state.best.compare(problem.bounds.free_part(all), DesignTermination::trusted);
  }
  return static_cast<int>(tried.size());
}

/// Changes one parameter of the best design after the other. The distance is halved if no neighbour is better. Returns
/// the number of designs that were evaluated.
int pattern_search(const SearchState& state) {
  const FreeParameters& bounds = state.problem.bounds;
  const Eigen::VectorXd lower = bounds.free_part(bounds.lower);
  const Eigen::VectorXd width = bounds.free_part(bounds.upper) - lower;
  int evaluations = 0;
  double distance = initial_distance;
  while (distance >= min_distance) {
    const double before = state.best.merit();
    for (Eigen::Index k = 0; k < width.size(); ++k) {
      for (const double offset : {-distance, distance}) {
        if (!state.best.is_uncertain() || evaluations >= max_trust_evaluations) return evaluations;
        Eigen::VectorXd x = bounds.free_part(state.best.parameters());
        const double old_value = x[k];
        x[k] = std::clamp(old_value + offset * width[k], lower[k], lower[k] + width[k]);
        if (x[k] == old_value) continue;
        ++evaluations;
        state.best.compare(x, DesignTermination::trusted);
      }
    }
    if (!(state.best.merit() < before)) distance /= 2;
  }
  return evaluations;
}

}  // namespace

TrustEffort search_trusted_designs(const SearchState& state, const Execution& execution) {
  const auto begin = std::chrono::steady_clock::now();
  TrustEffort effort;
  effort.evaluations = compare_candidates(state, execution);
  effort.evaluations += pattern_search(state);
  effort.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return effort;
}

}  // namespace supple::design
