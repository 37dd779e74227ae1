#include "ranked_candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "target_residuals.h"

namespace supple::design {
namespace {

/// Candidates are evaluated in several orientations. Neighbouring ones differ by at most this, rad, unless there would
/// be more than max_orientations.
constexpr double orientation_spacing = 0.4;
constexpr int max_orientations = 8;

}  // namespace

double relative_deviation(const std::vector<SampledTarget>& targets, const std::vector<double>& weights,
                          double outlier_threshold, const std::vector<Eigen::VectorXd>& profiles) {
  double sum = 0;
  double total = 0;
  for (std::size_t t = 0; t < targets.size(); ++t) {
    Eigen::VectorXd deviations = targets[t].deviations(profiles[t]) / targets[t].scale;
    if (outlier_threshold > 0)
      for (double& deviation : deviations) deviation = robust_deviation(deviation, outlier_threshold).value;
    sum += weights[t] * targets[t].weights.dot(deviations.cwiseAbs2());
    total += weights[t];
  }
  return std::isfinite(sum) ? std::sqrt(sum / total) : std::numeric_limits<double>::infinity();
}

const std::vector<SampledTarget>& RankedCandidates::targets() {
  if (coarse_.empty())
    for (const auto& target : problem_.targets) coarse_.push_back(coarsened(target, coarse_samples));
  return coarse_;
}

void RankedCandidates::evaluate(const Execution& execution) {
  if (table_) return;
  orientations_ = orientations();
  std::vector<ProfileSamples> profiles;
  profiles.reserve(targets().size() * orientations_.size());
  for (const double orientation : orientations_) {
    for (const auto& target : coarse_) {
      profiles.push_back(target.samples);
      profiles.back().orientation = orientation;
    }
  }
  const FreeParameters& bounds = problem_.bounds;
  const auto free = static_cast<int>(bounds.free_of_family().size());
  const int requested = problem_.options.candidates;
  const int number = free == 0 ? 1 : requested > 0 ? requested : default_candidates(free);
  table_ = problem_.space.candidates.table(family_part(bounds.lower), family_part(bounds.upper), number, profiles,
                                           problem_.space.buildable, execution);
}

Eigen::Index RankedCandidates::count() const {
  return table_->parameters.cols() * static_cast<Eigen::Index>(orientations_.size());
}

Eigen::VectorXd RankedCandidates::at(Eigen::Index candidate) const {
  const Eigen::Index n = table_->parameters.cols();
  return FreeParameters::all_of(table_->parameters.col(candidate % n),
                                orientations_[static_cast<std::size_t>(candidate / n)]);
}

Eigen::VectorXd RankedCandidates::values(Eigen::Index candidate) const {
  const Eigen::Index n = table_->parameters.cols();
  const Eigen::Index rows = table_->y.rows() / static_cast<Eigen::Index>(orientations_.size());
  return table_->y.col(candidate % n).segment(candidate / n * rows, rows);
}

std::vector<std::pair<double, Eigen::Index>> RankedCandidates::ranked(double outlier_threshold) const {
  std::vector<std::pair<double, Eigen::Index>> candidates;
  for (Eigen::Index c = 0; c < count(); ++c) candidates.emplace_back(error(c, outlier_threshold), c);
  std::sort(candidates.begin(), candidates.end());
  return candidates;
}

double RankedCandidates::error(Eigen::Index candidate, double outlier_threshold) const {
  Eigen::VectorXd all = values(candidate);
  all = scaled(coarse_, all, problem_.moduli.best(coarse_, problem_.weights, all).factor);
  std::vector<Eigen::VectorXd> profiles;
  profiles.reserve(coarse_.size());
  Eigen::Index begin = 0;
  for (const auto& target : coarse_) {
    profiles.emplace_back(all.segment(begin, target.y.size()));
    begin += target.y.size();
  }
  const double deviation = relative_deviation(coarse_, problem_.weights, outlier_threshold, profiles);
  if (!problem_.limits.are_needed() || !std::isfinite(deviation)) return deviation;
  return std::hypot(deviation, problem_.limits.at(family_part(at(candidate))).norm());
}

std::vector<double> RankedCandidates::orientations() const {
  const FreeParameters& bounds = problem_.bounds;
  if (!bounds.orientation_is_free()) return {orientation_in(bounds.fixed_values)};
  // The orientations are the midpoints of equal intervals of the range.
  const double min_orientation = orientation_in(bounds.lower);
  const double range = orientation_in(bounds.upper) - min_orientation;
  const int number = std::clamp(static_cast<int>(std::ceil(range / orientation_spacing)), 1, max_orientations);
  std::vector<double> orientations;
  orientations.reserve(static_cast<std::size_t>(number));
  for (int k = 0; k < number; ++k) orientations.push_back(min_orientation + (k + 0.5) * range / number);
  return orientations;
}

}  // namespace supple::design
