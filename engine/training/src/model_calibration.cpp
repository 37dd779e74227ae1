#include "supple/training/model_calibration.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>
#include <utility>

#include "calibration_states.h"
#include "error_regression.h"

namespace supple::training {
namespace {

/// Folds of the cross-validation over held-out designs.
constexpr int max_folds = 10;
/// Held-out designs for each group of states with similar ratings (conformal_offsets).
constexpr int designs_per_group = 8;
constexpr int max_groups = 6;
/// Largest relative error of a uniaxial stress that is reported in [Thesis, sec. 4.4.1].
constexpr double thesis_max_error = 0.0357;
constexpr std::array<double, 7> plotted_levels{0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98};

int group_count(int designs) { return std::clamp(designs / designs_per_group, 1, max_groups); }

/// Level of the quantile of n exchangeable errors that bounds the next one with probability `level` [Vovk2005].
double conformal_level(double level, int designs) { return std::min(1.0, level * (1 + 1.0 / designs)); }

Eigen::VectorXd concatenated(const std::vector<Eigen::VectorXd>& vectors) {
  Eigen::Index size = 0;
  for (const auto& vector : vectors) size += vector.size();
  Eigen::VectorXd all(size);
  Eigen::Index begin = 0;
  for (const auto& vector : vectors) {
    all.segment(begin, vector.size()) = vector;
    begin += vector.size();
  }
  return all;
}

/// The ratings of the held-out states and their log errors. Each fold is rated by a fit without it. The excluded fold
/// (negative: none) is left out of the fits and of the result.
std::pair<Eigen::VectorXd, Eigen::VectorXd> held_out_ratings(const ErrorRegression& regression, int excluded_fold) {
  std::vector<Eigen::VectorXd> ratings;
  std::vector<Eigen::VectorXd> log_errors;
  for (int f = 0; f < regression.folds(); ++f) {
    if (f == excluded_fold) continue;
    ratings.push_back(regression.rate(regression.fit(f, excluded_fold), f));
    log_errors.push_back(regression.log_errors(f));
  }
  return {concatenated(ratings), concatenated(log_errors)};
}

/// A held-out state, and its error bar that was made without its design.
struct EvaluatedState {
  double bar = 0;
  double error = 0;           ///< as in neural::Quantity
  double relative_error = 0;  ///< relative to the simulated value (QuantityStates::relative_error)
};

neural::BarCoverage summary(std::vector<EvaluatedState> evaluated, const std::vector<double>& out_of_box, int designs,
                            double trusted_bar) {
  neural::BarCoverage result;
  result.designs = designs;
  result.states = static_cast<std::int64_t>(evaluated.size());
  for (const auto& state : evaluated) {
    const bool beyond = state.relative_error > thesis_max_error;
    const std::int64_t in_range = state.bar <= trusted_bar ? 1 : 0;
    ++(beyond ? result.beyond : result.within);
    ++(beyond ? result.beyond_in_box : result.within_in_box);
    (beyond ? result.beyond_in_range : result.within_in_range) += in_range;
  }
  for (const double error : out_of_box) ++(error > thesis_max_error ? result.beyond : result.within);
  std::stable_sort(evaluated.begin(), evaluated.end(),
                   [](const EvaluatedState& a, const EvaluatedState& b) { return a.bar < b.bar; });
  const auto coverage = [&](std::size_t begin, std::size_t end) {
    const auto first = evaluated.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = evaluated.begin() + static_cast<std::ptrdiff_t>(end);
    const auto covered =
        std::count_if(first, last, [](const EvaluatedState& state) { return state.error <= state.bar; });
    return static_cast<double>(covered) / static_cast<double>(end - begin);
  };
  const auto n = evaluated.size();
  result.share = coverage(0, n);
  result.median_bar = evaluated[n / 2].bar;
  constexpr std::size_t tenths = 10;
  for (std::size_t i = 0; i < tenths; ++i) {
    const auto begin = i * n / tenths;
    const auto end = (i + 1) * n / tenths;
    result.stated.push_back(evaluated[(begin + end) / 2].bar);
    result.observed.push_back(coverage(begin, end));
  }
  return result;
}

/// Makes the scale of one quantity and measures the coverage of its bars by cross-validation. Returns the coverage of
/// bars for other levels too.
CoverageByLevel calibrate_quantity(const CalibrationStates::QuantityStates& states, int folds, int designs,
                                   neural::Quantity quantity, const neural::Calibration& calibration,
                                   neural::ErrorScale& scale) {
  const ErrorRegression regression(states.observed, folds, calibration.floor, scale);
  scale.coefficients = regression.fit(-1, -1);
  const auto [ratings, log_errors] = held_out_ratings(regression, -1);
  scale.given =
      conformal_offsets(ratings, log_errors, conformal_level(calibration.level, designs), group_count(designs));

  CoverageByLevel levels{{plotted_levels.begin(), plotted_levels.end()}, {}};
  std::vector<double> covered(plotted_levels.size(), 0);
  std::vector<EvaluatedState> evaluated;
  for (int f = 0; f < folds; ++f) {
    std::vector<std::size_t> states_of_fold;
    std::set<int> designs_of_fold;
    for (std::size_t i = 0; i < states.observed.fold.size(); ++i) {
      if (states.observed.fold[i] != f) continue;
      states_of_fold.push_back(i);
      designs_of_fold.insert(states.observed.design[i]);
    }
    const int other_count = std::max(1, designs - static_cast<int>(designs_of_fold.size()));
    const auto rated_others = held_out_ratings(regression, f);
    const Eigen::VectorXd own_ratings = regression.rate(regression.fit(f, -1), f);
    const auto bars = [&](double level) {
      const auto table = conformal_offsets(rated_others.first, rated_others.second, conformal_level(level, other_count),
                                           group_count(other_count));
      std::vector<double> result;
      for (const double rating : own_ratings) result.push_back(neural::bar_of(calibration, rating + table.at(rating)));
      return result;
    };
    const auto stated_bars = bars(calibration.level);
    for (std::size_t j = 0; j < states_of_fold.size(); ++j) {
      const auto i = states_of_fold[j];
      evaluated.push_back(
          {stated_bars[j], states.observed.error[static_cast<Eigen::Index>(i)], states.relative_error[i]});
    }
    for (std::size_t l = 0; l < plotted_levels.size(); ++l) {
      const auto level_bars = bars(plotted_levels[l]);
      for (std::size_t j = 0; j < states_of_fold.size(); ++j)
        covered[l] += states.observed.error[static_cast<Eigen::Index>(states_of_fold[j])] <= level_bars[j] ? 1 : 0;
    }
  }
  for (const double count : covered) levels.observed.push_back(count / static_cast<double>(evaluated.size()));
  scale.given.judged = summary(std::move(evaluated), states.out_of_box, designs, neural::max_trusted_error(quantity));
  return levels;
}

/// Adds offsets for designs that searches have found. The fit of `scale` does not include these designs, so that they
/// all calibrate the offsets. The coverage is measured by cross-validation over them.
void calibrate_searched(const CalibrationStates::QuantityStates& states, int folds, int designs,
                        neural::Quantity quantity, const neural::Calibration& calibration, neural::ErrorScale& scale) {
  const auto n = states.observed.error.size();
  Eigen::VectorXd ratings(n);
  Eigen::VectorXd log_errors(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    ratings[i] = neural::rating(scale, states.observed.features.row(i).transpose());
    log_errors[i] = std::log(std::min(states.observed.error[i], neural::largest_error) + calibration.floor);
  }
  scale.searched =
      conformal_offsets(ratings, log_errors, conformal_level(calibration.level, designs), group_count(designs));
  std::vector<EvaluatedState> evaluated;
  for (int f = 0; f < folds; ++f) {
    std::vector<Eigen::Index> own;
    std::vector<Eigen::Index> others;
    std::set<int> other_designs;
    for (Eigen::Index i = 0; i < n; ++i) {
      const auto state = static_cast<std::size_t>(i);
      if (states.observed.fold[state] == f) {
        own.push_back(i);
      } else {
        others.push_back(i);
        other_designs.insert(states.observed.design[state]);
      }
    }
    const auto count = static_cast<int>(other_designs.size());
    const auto table = conformal_offsets(ratings(others), log_errors(others), conformal_level(calibration.level, count),
                                         group_count(count));
    for (const auto i : own) {
      const double bar = neural::bar_of(calibration, ratings[i] + table.at(ratings[i]));
      evaluated.push_back({bar, states.observed.error[i], states.relative_error[static_cast<std::size_t>(i)]});
    }
  }
  scale.searched.judged =
      summary(std::move(evaluated), states.out_of_box, designs, neural::max_trusted_error(quantity));
}

}  // namespace

CalibrationResult calibrate(neural::Model model, const ModelData& data, const CancellationToken& cancellation,
                            const ReferenceData& references) {
  const auto states = calibration_states(model, data, references, max_folds, cancellation);
  CalibrationResult result;
  neural::Calibration calibration;
  calibration.by_fresh_designs = !references.drawn.empty();
  for (const auto quantity : neural::all_quantities) {
    cancellation.throw_if_requested();
    const auto q = static_cast<std::size_t>(quantity);
    result.levels[q] = calibrate_quantity(states.given[q], states.folds, states.held_out_designs, quantity, calibration,
                                          calibration.scales[q]);
    if (states.searched_designs > 0)
      calibrate_searched(states.searched[q], states.searched_folds, states.searched_designs, quantity, calibration,
                         calibration.scales[q]);
  }
  result.model = std::move(model);
  result.model.calibration = std::move(calibration);
  return result;
}

}  // namespace supple::training
