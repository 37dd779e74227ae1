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

/// Held-out designs are left out a tenth at a time.
constexpr int most_folds = 10;
/// Offsets are those of groups of like ratings; so many designs make one group more.
constexpr int designs_of_a_group = 8;
constexpr int most_groups = 6;
/// The thesis's worst error of a uniaxial stress (4.4.3).
constexpr double thesis_worst = 0.0357;
constexpr std::array<double, 7> plotted_levels{0.5, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98};

int groups_of(int designs) { return std::clamp(designs / designs_of_a_group, 1, most_groups); }

/// Of n designs that are drawn alike a share (1 + 1/n) level has to be below for the next to be below with `level`.
double raised(double level, int designs) { return std::min(1.0, level * (1 + 1.0 / designs)); }

Eigen::VectorXd joined(const std::vector<Eigen::VectorXd>& parts) {
  Eigen::Index size = 0;
  for (const auto& part : parts) size += part.size();
  Eigen::VectorXd all(size);
  Eigen::Index at = 0;
  for (const auto& part : parts) {
    all.segment(at, part.size()) = part;
    at += part.size();
  }
  return all;
}

/// The ratings of the held-out states by a fit without them, and their log errors, all but those of a fold that is left
/// out of everything (negative: none).
std::pair<Eigen::VectorXd, Eigen::VectorXd> rated(const ErrorRegression& regression, int without) {
  std::vector<Eigen::VectorXd> ratings;
  std::vector<Eigen::VectorXd> logarithms;
  for (int f = 0; f < regression.folds(); ++f) {
    if (f == without) continue;
    ratings.push_back(regression.rate(regression.fit(f, without), f));
    logarithms.push_back(regression.logarithms(f));
  }
  return {joined(ratings), joined(logarithms)};
}

/// A held-out state as bars saw it that know nothing of its design.
struct JudgedState {
  double bar = 0;
  double error = 0;
  double relative = 0;
};

neural::JudgedBars summary(std::vector<JudgedState> judged, const std::vector<double>& out_of_box, int designs,
                           double trusted) {
  neural::JudgedBars result;
  result.designs = designs;
  result.states = static_cast<std::int64_t>(judged.size());
  for (const auto& state : judged) {
    const bool beyond = state.relative > thesis_worst;
    const std::int64_t in_range = state.bar <= trusted ? 1 : 0;
    ++(beyond ? result.beyond : result.within);
    ++(beyond ? result.beyond_in_box : result.within_in_box);
    (beyond ? result.beyond_in_range : result.within_in_range) += in_range;
  }
  for (const double error : out_of_box) ++(error > thesis_worst ? result.beyond : result.within);
  std::stable_sort(judged.begin(), judged.end(),
                   [](const JudgedState& a, const JudgedState& b) { return a.bar < b.bar; });
  const auto share = [&](std::size_t begin, std::size_t end) {
    const auto first = judged.begin() + static_cast<std::ptrdiff_t>(begin);
    const auto last = judged.begin() + static_cast<std::ptrdiff_t>(end);
    const auto fine = std::count_if(first, last, [](const JudgedState& state) { return state.error <= state.bar; });
    return static_cast<double>(fine) / static_cast<double>(end - begin);
  };
  const auto n = judged.size();
  result.share = share(0, n);
  result.median_bar = judged[n / 2].bar;
  constexpr std::size_t tenths = 10;
  for (std::size_t i = 0; i < tenths; ++i) {
    const auto begin = i * n / tenths;
    const auto end = (i + 1) * n / tenths;
    result.stated.push_back(judged[(begin + end) / 2].bar);
    result.observed.push_back(share(begin, end));
  }
  return result;
}

/// Makes the scale of one quantity, judges it, and says how shares at other levels would do.
SharesByLevel calibrate_quantity(const CalibrationStates::Of& states, int folds, int designs, neural::Quantity quantity,
                                 const neural::Calibration& calibration, neural::ErrorScale& scale) {
  const ErrorRegression regression(states.observed, folds, calibration.floor, scale);
  scale.coefficients = regression.fit(-1, -1);
  const auto [ratings, logarithms] = rated(regression, -1);
  scale.given = conformal_offsets(ratings, logarithms, raised(calibration.level, designs), groups_of(designs));

  SharesByLevel levels{{plotted_levels.begin(), plotted_levels.end()}, {}};
  std::vector<double> fine(plotted_levels.size(), 0);
  std::vector<JudgedState> judged;
  for (int f = 0; f < folds; ++f) {
    std::vector<std::size_t> states_of_fold;
    std::set<int> designs_of_fold;
    for (std::size_t i = 0; i < states.observed.fold.size(); ++i) {
      if (states.observed.fold[i] != f) continue;
      states_of_fold.push_back(i);
      designs_of_fold.insert(states.observed.design[i]);
    }
    const int others = std::max(1, designs - static_cast<int>(designs_of_fold.size()));
    const auto of_others = rated(regression, f);
    const Eigen::VectorXd own = regression.rate(regression.fit(f, -1), f);
    const auto bars = [&](double level) {
      const auto table = conformal_offsets(of_others.first, of_others.second, raised(level, others), groups_of(others));
      std::vector<double> result;
      for (const double rating : own) result.push_back(neural::bar_of(calibration, rating + table.at(rating)));
      return result;
    };
    const auto stated = bars(calibration.level);
    for (std::size_t j = 0; j < states_of_fold.size(); ++j) {
      const auto i = states_of_fold[j];
      judged.push_back({stated[j], states.observed.error[static_cast<Eigen::Index>(i)], states.relative[i]});
    }
    for (std::size_t l = 0; l < plotted_levels.size(); ++l) {
      const auto of_level = bars(plotted_levels[l]);
      for (std::size_t j = 0; j < states_of_fold.size(); ++j)
        fine[l] += states.observed.error[static_cast<Eigen::Index>(states_of_fold[j])] <= of_level[j] ? 1 : 0;
    }
  }
  for (const double count : fine) levels.observed.push_back(count / static_cast<double>(judged.size()));
  scale.given.judged = summary(std::move(judged), states.out_of_box, designs, neural::trusted_error(quantity));
  return levels;
}

/// Offsets for designs that searches have found, by what their errors are over the ratings of a fit without them.
void calibrate_searched(const CalibrationStates::Of& states, int folds, int designs, neural::Quantity quantity,
                        const neural::Calibration& calibration, neural::ErrorScale& scale) {
  const auto n = states.observed.error.size();
  Eigen::VectorXd ratings(n);
  Eigen::VectorXd logarithms(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    ratings[i] = neural::rating(scale, states.observed.features.row(i).transpose());
    logarithms[i] = std::log(std::min(states.observed.error[i], neural::largest_error) + calibration.floor);
  }
  scale.searched = conformal_offsets(ratings, logarithms, raised(calibration.level, designs), groups_of(designs));
  std::vector<JudgedState> judged;
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
    const auto table =
        conformal_offsets(ratings(others), logarithms(others), raised(calibration.level, count), groups_of(count));
    for (const auto i : own) {
      const double bar = neural::bar_of(calibration, ratings[i] + table.at(ratings[i]));
      judged.push_back({bar, states.observed.error[i], states.relative[static_cast<std::size_t>(i)]});
    }
  }
  scale.searched.judged = summary(std::move(judged), states.out_of_box, designs, neural::trusted_error(quantity));
}

}  // namespace

CalibrationResult calibrate(neural::Model model, const ModelData& data, const CancellationToken& cancellation,
                            const References& references) {
  const auto states = calibration_states(model, data, references, most_folds, cancellation);
  CalibrationResult result;
  neural::Calibration calibration;
  calibration.by_fresh_designs = !references.drawn.empty();
  for (const auto quantity : neural::all_quantities) {
    cancellation.throw_if_requested();
    const auto q = static_cast<std::size_t>(quantity);
    result.levels[q] = calibrate_quantity(states.of[q], states.folds, states.held_designs, quantity, calibration,
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
