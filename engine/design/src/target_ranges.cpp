#include "supple/design/target_ranges.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

namespace supple::design {
namespace {

/// Strains up to this fraction of the largest one are near rest.
constexpr double max_rest_fraction = 0.05;

/// Joins two samples or ranges that have the same fit: their deviations are a weighted root mean square.
std::optional<double> joined_deviation(const FitRange& a, const FitRange& b) {
  if (!a.deviation || !b.deviation) return std::nullopt;
  const double weight = a.weight + b.weight;
  const double fraction = weight > 0 ? a.weight / weight : 0.5;
  return std::sqrt(fraction * *a.deviation * *a.deviation + (1 - fraction) * *b.deviation * *b.deviation);
}

std::vector<Fit> fits_of(const SampledTarget& target, const Eigen::VectorXd& values) {
  const auto reached = target.reached(values);
  const Eigen::VectorXd deviations = target.deviations(values).cwiseAbs();
  std::vector<Fit> fits;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    const bool is_near = deviations[i] <= max_reached_deviation * target.scale;
    fits.push_back(!std::isfinite(values[i])                   ? Fit::missing
                   : reached[static_cast<std::size_t>(i)] != 0 ? Fit::reached
                   : is_near                                   ? Fit::near
                                                               : Fit::missed);
  }
  return fits;
}

/// Whether a sample is so near rest that each design has little stress there.
bool is_near_rest(const SampledTarget& target, std::size_t sample) {
  const auto& x = target.samples.x;
  return std::abs(x[sample]) <= max_rest_fraction * std::max(std::abs(x.front()), std::abs(x.back()));
}

/// Whether each sample says nothing about the design although it has weight: it is near rest, and the target is within
/// the tolerance of 0 and reached, as by each design with little stress near rest.
std::vector<bool> trivial_samples(const SampledTarget& target, const std::vector<Fit>& fits) {
  std::vector<bool> trivial(fits.size());
  if (target.samples.task != Task::stress_strain) return trivial;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    const double magnitude = std::abs(target.y[static_cast<Eigen::Index>(i)]);
    trivial[i] =
        target.has_weight(i) && fits[i] == Fit::reached && is_near_rest(target, i) && magnitude <= target.tolerance();
  }
  return trivial;
}

/// Gives trivial samples the worse of the fits of the next samples that say something, and samples without weight the
/// fit of the nearest one.
void judge_silent_samples(const SampledTarget& target, const std::vector<bool>& trivial, std::vector<Fit>& fits) {
  const auto own = fits;
  const auto is_silent = [&](std::size_t i) { return trivial[i] || !target.has_weight(i); };
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (!is_silent(i)) continue;
    std::optional<std::size_t> before;
    std::optional<std::size_t> after;
    for (std::size_t k = i; k > 0 && !before; --k)
      if (!is_silent(k - 1)) before = k - 1;
    for (std::size_t k = i + 1; k < fits.size() && !after; ++k)
      if (!is_silent(k)) after = k;
    if (!trivial[i]) {
      const bool takes_before = before && (!after || i - *before <= *after - i);
      if (takes_before || after) fits[i] = own[takes_before ? *before : *after];
      if (!before && !after) fits[i] = Fit::reached;
      continue;
    }
    for (const auto beside : {before, after})
      if (beside && own[*beside] != Fit::missing) fits[i] = std::max(fits[i], own[*beside]);
  }
}

/// Where the ranges meet that end with the sample before i and begin with i: at a trivial sample, or halfway.
double border_before(std::size_t i, const std::vector<double>& x, const std::vector<bool>& trivial) {
  if (trivial[i]) return x[i];
  return trivial[i - 1] ? x[i - 1] : (x[i - 1] + x[i]) / 2;
}

/// The root mean square over samples without weight alone counts each of them alike.
std::optional<double> deviation_of(const SampledTarget& target, const Eigen::VectorXd& values, const FitRange& range) {
  const auto n = static_cast<Eigen::Index>(range.last - range.first + 1);
  const auto first = static_cast<Eigen::Index>(range.first);
  const Eigen::ArrayXd squares = (target.deviations(values) / target.scale).segment(first, n).array().square();
  const Eigen::ArrayXd weights = target.weights.segment(first, n).array();
  const double mean =
      range.weight > 0 ? (weights > 0).select(weights * squares, 0.0).sum() / range.weight : squares.mean();
  return std::isfinite(mean) ? std::optional(std::sqrt(mean)) : std::nullopt;
}

}  // namespace

bool is_reached_as_a_whole(const SampledTarget& target, const Eigen::VectorXd& values) {
  const auto deviation = target.relative_rms(values);
  return deviation && (*deviation <= max_reached_deviation || target.is_reached(values));
}

std::string_view to_string(Fit fit) {
  switch (fit) {
    case Fit::reached:
      return "reached";
    case Fit::near:
      return "near";
    case Fit::missed:
      return "missed";
    case Fit::missing:
      return "missing";
  }
  return "";
}

std::vector<FitRange> fit_ranges(const SampledTarget& target, const Eigen::VectorXd& values) {
  const auto& x = target.samples.x;
  auto fits = fits_of(target, values);
  const auto trivial = trivial_samples(target, fits);
  judge_silent_samples(target, trivial, fits);
  std::vector<FitRange> ranges;
  for (std::size_t i = 0; i < fits.size(); ++i) {
    if (i > 0 && fits[i] == fits[i - 1]) {
      ranges.back().last = i;
      continue;
    }
    const double from = i == 0 ? x[0] : border_before(i, x, trivial);
    if (i > 0) ranges.back().to = from;
    FitRange range;
    range.from = from;
    range.first = range.last = i;
    range.fit = fits[i];
    ranges.push_back(range);
  }
  if (ranges.empty()) return ranges;
  const bool periodic = target.samples.task != Task::stress_strain;
  ranges.back().to = periodic ? x.front() + std::numbers::pi : x.back();
  for (FitRange& range : ranges) {
    const auto n = static_cast<Eigen::Index>(range.last - range.first + 1);
    range.weight = target.weights.segment(static_cast<Eigen::Index>(range.first), n).sum();
    range.deviation = deviation_of(target, values, range);
    range.part = part_of(target, range.first, range.last);
  }
  return ranges;
}

std::vector<FitRange> joined_across_period(std::vector<FitRange> ranges, Task task) {
  if (task == Task::stress_strain || ranges.size() < 2 || ranges.front().fit != ranges.back().fit) return ranges;
  FitRange& first = ranges.front();
  const FitRange& last = ranges.back();
  first.from = last.from - std::numbers::pi;
  first.first = last.first;
  first.deviation = joined_deviation(first, last);
  first.weight += last.weight;
  ranges.pop_back();
  return ranges;
}

}  // namespace supple::design
