#include "supple/design/target.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/design/design_fault.h"

namespace supple::design {
namespace {

constexpr double period = std::numbers::pi;
constexpr int default_samples = 10;
constexpr int default_directions = 50;

bool over_directions(Task task) { return task != Task::stress_strain; }

void check_strains(const Target& target, std::vector<Error::Detail>& faults) {
  const auto [min_strain, max_strain] = strain_limits(target.measure);
  const auto check = [&faults, low = min_strain, high = max_strain](double strain, const std::string& where) {
    if (strain > low && strain <= high) return;
    faults.push_back({where, "must be a strain above " + number_text(low) + " and at most " + number_text(high) +
                                 ", got " + number_text(strain)});
  };
  if (over_directions(target.task)) return check(target.strain, "strain");
  for (std::size_t i = 0; i < target.control_points.size() && faults.size() < 20; ++i)
    check(target.control_points[i][0], "target/control_points/" + std::to_string(i) + "/0");
}

void check(const Target& target) {
  std::vector<Error::Detail> faults;
  const auto& points = target.control_points;
  if (points.size() < 2) faults.push_back({"target/control_points", "must have at least 2 points"});
  const double range = points.size() < 2 ? 0 : std::max(points.back()[0] - points.front()[0], 1e-12);
  for (std::size_t i = 0; i < points.size() && faults.size() < 20; ++i) {
    const std::string where = "target/control_points/" + std::to_string(i);
    if (!(points[i].cwiseAbs().maxCoeff() <= largest_coordinate))
      faults.push_back({where, "must have coordinates from -1e6 to 1e6"});
    else if (i > 0 && !(points[i][0] - points[i - 1][0] > min_fraction_of_range * range))
      faults.push_back({where + "/0", "must be greater than the x before it, " + number_text(points[i - 1][0]) +
                                          ", by more than a billionth of the range of all"});
  }
  if (faults.empty() && over_directions(target.task) && !(points.back()[0] < points.front()[0] + period))
    faults.push_back({"target/control_points/" + std::to_string(points.size() - 1) + "/0",
                      "must be less than pi beyond the first x: directions repeat after half a turn"});
  check_strains(target, faults);
  const auto check_list = [&](const std::vector<double>& list, const char* name) {
    if (!list.empty() && list.size() != points.size())
      faults.push_back({std::string("target/") + name, "must have one entry for each of the " +
                                                           std::to_string(points.size()) + " control points, got " +
                                                           std::to_string(list.size())});
  };
  check_list(target.weights, "weights");
  check_list(target.bands, "bands");
  if (!faults.empty())
    throw InvalidTarget("design.invalid_target", faults.front().where + ": " + faults.front().message + ".", faults);
}

/// Smaller fractions of the largest weight are rounding errors of the interpolation at a control point without weight.
constexpr double weight_rounding = 1e-9;

void normalize(SampledTarget& sampled) {
  const double rounding = weight_rounding * sampled.weights.maxCoeff();
  for (double& weight : sampled.weights)
    if (weight <= rounding) weight = 0;
  const double sum = sampled.weights.sum();
  const auto n = static_cast<double>(sampled.weights.size());
  // If the weights are zero at every sample, all samples get the same weight.
  if (sum > 0)
    sampled.weights /= sum;
  else
    sampled.weights.setConstant(1 / n);
  sampled.scale = std::max(min_scale(sampled.samples.task), std::sqrt(sampled.weights.dot(sampled.y.cwiseAbs2())));
}

}  // namespace

double min_scale(Task task) { return task == Task::poisson ? 0.1 : 1e-6; }

Eigen::VectorXd SampledTarget::deviations(const Eigen::VectorXd& profile) const {
  const Eigen::ArrayXd deviation = (profile - y).array();
  return deviation - deviation.cwiseMin(bands.array()).cwiseMax(-bands.array());
}

std::optional<double> SampledTarget::relative_rms(const Eigen::VectorXd& profile) const {
  const Eigen::ArrayXd squares = weights.array() * (deviations(profile) / scale).array().square();
  const double mean_square = (weights.array() > 0).select(squares, 0.0).sum();
  if (!std::isfinite(mean_square)) return std::nullopt;
  return std::sqrt(mean_square);
}

double SampledTarget::tolerance() const {
  const double relative = reached_fraction * scale;
  return samples.task == Task::poisson ? std::max(relative, reached_poisson_deviation) : relative;
}

std::vector<std::uint8_t> SampledTarget::reached(const Eigen::VectorXd& profile) const {
  const Eigen::VectorXd magnitudes = deviations(profile).cwiseAbs();
  std::vector<std::uint8_t> flags;
  flags.reserve(static_cast<std::size_t>(magnitudes.size()));
  for (const double deviation : magnitudes) flags.push_back(deviation <= tolerance() ? 1 : 0);
  return flags;
}

bool SampledTarget::is_reached(const Eigen::VectorXd& profile) const {
  const auto flags = reached(profile);
  for (std::size_t i = 0; i < flags.size(); ++i)
    if (has_weight(i) && flags[i] == 0) return false;
  return true;
}

Eigen::Index SampledTarget::worst_sample(const Eigen::VectorXd& profile) const {
  Eigen::Index worst = 0;
  (weights.array() > 0).select(deviations(profile).array().abs(), -1.0).maxCoeff(&worst);
  return worst;
}

SampledTarget sample_target(const Target& target) {
  check(target);
  std::vector<double> x;
  std::vector<double> y;
  for (const auto& point : target.control_points) {
    x.push_back(point[0]);
    y.push_back(point[1]);
  }
  const bool periodic = over_directions(target.task);
  const std::optional<double> repeats = periodic ? std::optional(period) : std::nullopt;
  const numerics::Interpolant curve(x, y, target.interpolation, repeats);
  const auto constant = [&x](double value) { return std::vector<double>(x.size(), value); };
  const numerics::Interpolant weights(x, target.weights.empty() ? constant(1) : target.weights,
                                      numerics::Interpolation::linear, repeats);
  const numerics::Interpolant bands(x, target.bands.empty() ? constant(0) : target.bands,
                                    numerics::Interpolation::linear, repeats);
  SampledTarget sampled;
  sampled.samples = {target.task, target.direction, target.strain, target.measure, {}};
  const int n = target.samples > 0 ? target.samples : periodic ? default_directions : default_samples;
  sampled.samples.x.resize(static_cast<std::size_t>(n));
  sampled.y.resize(n);
  sampled.weights.resize(n);
  sampled.bands.resize(n);
  for (int i = 0; i < n; ++i) {
    const double fraction = periodic ? static_cast<double>(i) / n : static_cast<double>(i) / std::max(1, n - 1);
    const double at = periodic ? period * fraction : x.front() + (x.back() - x.front()) * fraction;
    sampled.samples.x[static_cast<std::size_t>(i)] = at;
    sampled.y[i] = curve(at);
    sampled.weights[i] = std::max(0.0, weights(at));
    sampled.bands[i] = std::max(0.0, bands(at));
  }
  normalize(sampled);
  return sampled;
}

SampledTarget coarsened(const SampledTarget& target, int samples) {
  const Eigen::Index n = target.y.size();
  if (samples >= n) return target;
  // Directions are periodic: the last sample lies one interval before the period ends. Strains include both ends.
  const bool periodic = over_directions(target.samples.task);
  SampledTarget coarse;
  coarse.samples = target.samples;
  coarse.samples.x.resize(static_cast<std::size_t>(samples));
  coarse.y.resize(samples);
  coarse.weights.resize(samples);
  coarse.bands.resize(samples);
  for (int k = 0; k < samples; ++k) {
    const Eigen::Index i = periodic ? k * n / samples : k * (n - 1) / (samples - 1);
    coarse.samples.x[static_cast<std::size_t>(k)] = target.samples.x[static_cast<std::size_t>(i)];
    coarse.y[k] = target.y[i];
    coarse.weights[k] = target.weights[i];
    coarse.bands[k] = target.bands[i];
  }
  normalize(coarse);
  return coarse;
}

}  // namespace supple::design
