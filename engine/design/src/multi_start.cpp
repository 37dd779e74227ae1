#include "search_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

namespace supple::design {
namespace {

/// Threshold of outliers, as a fraction of the target's scale, for every other starting point. Where profiles jump, the
/// squares of a few samples would hide that all others agree.
constexpr double outlier_fraction = 0.1;
/// The best of the minima with few samples are refined with all samples: one for this many starting points, but at most
/// `max_refined_minima`.
constexpr int starts_per_refined_minimum = 4;
constexpr int max_refined_minima = 4;
/// Minima with few samples that are closer than this count as one; fraction of the bounds' widths.
constexpr double same_minimum_radius = 0.01;

/// The candidates in the order of one criterion.
struct Ranking {
  double outlier_threshold = 0;                             ///< threshold of outliers, as in TargetResiduals
  std::vector<std::pair<double, Eigen::Index>> candidates;  ///< errors and candidates, ordered by increasing error
  std::size_t next = 0;
};

/// The best remaining candidate that is not near one of those taken, with its error.
std::optional<std::pair<double, Eigen::VectorXd>> next_start(const SearchState& state, Ranking& ranking,
                                                             const std::vector<Eigen::VectorXd>& taken) {
  while (ranking.next < ranking.candidates.size()) {
    const auto& [error, candidate] = ranking.candidates[ranking.next++];
    const Eigen::VectorXd start = state.candidates.at(candidate);
    if (!state.problem.is_near_any(taken, start, min_start_distance)) return std::pair{error, start};
  }
  return std::nullopt;
}

bool is_good_enough(const SearchState& state) {
  return state.best.is_good() && state.problem.options.multi_start != Switch::on;
}

void refine_minima(const SearchState& state, LocalSearch& local, std::vector<LocalSearch::CoarseMinimum> minima) {
  std::stable_sort(minima.begin(), minima.end(),
                   [](const auto& a, const auto& b) { return a.deviation < b.deviation; });
  const SearchProblem& problem = state.problem;
  const auto max_refined =
      static_cast<std::size_t>(std::clamp(problem.max_starts() / starts_per_refined_minimum, 1, max_refined_minima));
  std::vector<Eigen::VectorXd> refined;
  for (const auto& minimum : minima) {
    if (is_good_enough(state)) return;
    if (state.best.is_found() && (refined.size() >= max_refined || !(minimum.deviation < 2 * state.best.merit())))
      return;
    const Eigen::VectorXd all = all_parameters(problem.bounds.fixed_values, problem.bounds.free, minimum.x);
    if (problem.is_near_any(refined, all, same_minimum_radius)) continue;
    refined.push_back(all);
    local.refine(minimum.x, minimum.outlier_threshold);
  }
}

}  // namespace

void search_from_candidates(const SearchState& state, LocalSearch& local, const Execution& execution) {
  const SearchProblem& problem = state.problem;
  state.candidates.evaluate(execution);
  std::array<Ranking, 2> rankings;
  rankings[0] = {outlier_fraction, state.candidates.ranked(outlier_fraction)};
  rankings[1] = {0, state.candidates.ranked(0)};
  std::vector<Eigen::VectorXd> taken;
  if (problem.problem.initial) taken.push_back(problem.requested_start());
  const bool only_one = problem.options.multi_start == Switch::off;
  std::vector<LocalSearch::CoarseMinimum> minima;
  for (std::size_t index = 0;; index = 1 - index) {
    if (state.counts.starts >= problem.max_starts() || (only_one && state.best.is_found())) break;
    if (is_good_enough(state)) break;
    const auto start = next_start(state, rankings[index], taken);
    if (!start || (!std::isfinite(start->first) && (state.best.is_found() || !minima.empty()))) break;
    taken.push_back(start->second);
    if (only_one || !problem.has_many_samples()) {
      local.search_from(start->second);
      continue;
    }
    auto minimum = local.coarse_minimum(start->second, rankings[index].outlier_threshold);
    if (!minimum) continue;
    if (minimum->deviation <= good_deviation)
      local.refine(minimum->x, minimum->outlier_threshold);
    else
      minima.push_back(std::move(*minimum));
  }
  refine_minima(state, local, std::move(minima));
}

}  // namespace supple::design
