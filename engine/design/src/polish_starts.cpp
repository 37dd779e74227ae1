#include "polish_starts.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "supple/base/error.h"
#include "supple/base/random.h"

namespace supple::design {
namespace {

/// Number of random points from which the corrected network is searched for other minima, besides a search of the whole
/// box. Increase it for families with many parameters; it costs no simulations.
constexpr int random_starts = 16;
/// Maximum number of these minima from which a descent starts. Each descent costs an allotment of simulations.
constexpr int max_other_starts = 3;
/// Maximum deviation (relative root mean square) of the corrected network at a minimum from which a descent starts.
/// Increase it if targets are met only roughly in any case.
constexpr double max_start_deviation = 0.1;
/// Designs closer than this to a simulated one are not simulated again; fraction of the bounds' widths.
constexpr double same_design_distance = 1e-3;
/// Minima closer than this to each other count as one; fraction of the bounds' widths.
constexpr double same_minimum_distance = 0.02;
/// Fraction of max_rounds, in [0, 1], after which no descent starts from another minimum; the remaining rounds are for
/// the survey. Reduce it if the network's minima rarely lead to the target.
constexpr double starts_fraction = 0.5;
/// Number of consecutive surveyed designs without improvement after which polishing ends. Increase it if simulations
/// are cheap or the network is poor.
constexpr int max_unsuccessful_surveys = 8;

}  // namespace

std::optional<Eigen::VectorXd> OtherStarts::next() {
  // A descent from another minimum takes many rounds.
  if (rounds_.count() > starts_fraction * rounds_.options().max_rounds && std::isfinite(rounds_.best().deviation))
    return std::nullopt;
  if (!starts_) starts_ = search();
  while (!starts_->empty()) {
    const Eigen::VectorXd x = std::move(starts_->front());
    starts_->erase(starts_->begin());
    if (distance_to_nearest(x, rounds_.tried()) >= same_design_distance) return x;
  }
  return std::nullopt;
}

/// The first search covers the whole box. The others start from random points.
std::vector<Eigen::VectorXd> OtherStarts::search() const {
  const CorrectedModel& model = rounds_.model();
  std::vector<Minimum> minima;
  RandomStream random("polish", 1);
  for (int i = 0; i <= random_starts && rounds_.seconds() < rounds_.options().max_seconds; ++i) {
    DesignProblem problem = corrected_problem();
    if (i > 0) {
      Eigen::VectorXd x(model.width().size());
      for (double& coordinate : x) coordinate = random.uniform(0, 1);
      const Eigen::VectorXd parameters = model.parameters_at(x);
      problem.initial = family_part(parameters);
      problem.initial_orientation = orientation_in(parameters);
    }
    auto found = minimum_of(problem);
    if (!found) continue;
    const auto same = std::find_if(minima.begin(), minima.end(), [&](const Minimum& other) {
      return (found->x - other.x).cwiseAbs().maxCoeff() < same_minimum_distance;
    });
    if (same == minima.end()) {
      minima.push_back(std::move(*found));
    } else if (found->deviation < same->deviation) {
      *same = std::move(*found);
    }
  }
  std::stable_sort(minima.begin(), minima.end(),
                   [](const Minimum& a, const Minimum& b) { return a.deviation < b.deviation; });
  std::vector<Eigen::VectorXd> starts;
  for (Minimum& minimum : minima)
    if (minimum.deviation < max_start_deviation && static_cast<int>(starts.size()) < max_other_starts)
      starts.push_back(std::move(minimum.x));
  return starts;
}

/// The problem for the network with the correction at the best design so far.
DesignProblem OtherStarts::corrected_problem() const {
  const CorrectedModel& model = rounds_.model();
  const SimulatedDesign& best = rounds_.best();
  DesignProblem problem = rounds_.problem();
  problem.initial.reset();
  if (std::isfinite(best.deviation)) {
    problem.corrections = model.split_by_target(best.correction());
    const double modulus = model.modulus_for(best.simulated).modulus;
    if (!problem.moduli.empty()) problem.moduli = {{modulus, modulus}};
  }
  return problem;
}

/// The best design of a problem by the network; none if it has no equilibrium or violates a limit. Without a starting
/// point the whole box is searched.
std::optional<OtherStarts::Minimum> OtherStarts::minimum_of(const DesignProblem& problem) const {
  const CorrectedModel& model = rounds_.model();
  DesignOptions options;
  options.envelope = Switch::off;
  options.trust = Switch::off;  // the simulation decides
  options.multi_start = problem.initial ? Switch::off : Switch::automatic;
  options.equilibrium_tolerance = model.search_tolerance();
  try {
    const Design found = find_design(space_, problem, options, Execution{rounds_.cancellation()});
    return Minimum{model.normalized(FreeParameters::all_of(found.parameters, found.orientation)),
                   found.error.relative_rms};
  } catch (const NoDesign&) {
    return std::nullopt;
  }
}

std::optional<Eigen::VectorXd> SurveyedStarts::next() {
  const auto& observations = rounds_.observations();
  if (unsuccessful_ >= max_unsuccessful_surveys || observations.empty()) return std::nullopt;
  if (!survey_) survey_.emplace(rounds_.model(), observations, rounds_.tried(), rounds_.cancellation());
  return survey_->next(observations, rounds_.tried(), (1 - min_predicted_reduction) * rounds_.best().deviation);
}

}  // namespace supple::design
