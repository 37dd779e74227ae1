#include "supple/design/rest_shape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace supple::design {
namespace {

using std::numbers::pi;

constexpr int direction_count = 72;  // 2.5 degrees apart
constexpr int section_steps = 20;    // of the golden section, which narrow an angle to 1e-4 of the step

/// The least value of a function between two angles around a minimum, and where it is, by the golden section.
template <class Function>
std::pair<double, double> least_between(double from, double to, const Function& function) {
  const double ratio = (std::sqrt(5.0) - 1) / 2;
  double left = to - ratio * (to - from), right = from + ratio * (to - from);
  double at_left = function(left), at_right = function(right);
  for (int k = 0; k < section_steps; ++k) {
    if (at_left < at_right) {
      to = right;
      right = left;
      at_right = at_left;
      left = to - ratio * (to - from);
      at_left = function(left);
    } else {
      from = left;
      left = right;
      at_left = at_right;
      right = from + ratio * (to - from);
      at_right = function(right);
    }
  }
  return at_left < at_right ? std::pair{at_left, left} : std::pair{at_right, right};
}

/// The least value of a function of period pi, and where it is. `values` has it at even steps. Two minima may be nearly
/// equal, so that the step does not show which one is less: up to `max_minima` of the lowest ones are refined.
template <class Function>
std::pair<double, double> least_over_angles(const std::vector<double>& values, std::size_t max_minima,
                                            const Function& function) {
  const std::size_t n = values.size();
  std::vector<std::size_t> minima;
  for (std::size_t k = 0; k < n; ++k)
    if (values[k] < values[(k + n - 1) % n] && values[k] <= values[(k + 1) % n]) minima.push_back(k);
  std::sort(minima.begin(), minima.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  minima.resize(std::min(minima.size(), max_minima));
  const auto lowest = std::min_element(values.begin(), values.end());
  const double step = pi / static_cast<double>(n);
  std::pair best{*lowest, step * static_cast<double>(lowest - values.begin())};
  for (const std::size_t k : minima) {
    const double angle = step * static_cast<double>(k);
    best = std::min(best, least_between(angle - step, angle + step, function));
  }
  return best;
}

double root_mean_square(const Eigen::VectorXd& values) {
  return std::sqrt(values.squaredNorm() / static_cast<double>(values.size()));
}

/// Root mean square of the deviation of a profile from a reference; a stiffness is scaled to come as near as it can.
double deviation_from(const Eigen::VectorXd& profile, const ReferenceProfile& reference) {
  double factor = 1;
  if (reference.task == Task::stiffness) factor = profile.dot(reference.y) / profile.squaredNorm();
  return root_mean_square(factor * profile - reference.y);
}

/// 1 / S11 over direction for S11 = c^4 + `across` s^4 + `mixed` c^2 s^2, scaled to the root mean square 1.
Eigen::VectorXd orthotropic_stiffness(double across, double mixed) {
  Eigen::VectorXd y(direction_count);
  for (int k = 0; k < direction_count; ++k) {
    const double angle = reference_directions()[static_cast<std::size_t>(k)];
    const double c = std::pow(std::cos(angle), 2), s = std::pow(std::sin(angle), 2);
    y[k] = 1 / (c * c + across * s * s + mixed * c * s);
  }
  return y / root_mean_square(y);
}

}  // namespace

RestShape::RestShape(const Compliance& compliance) {
  // Tensor components: the third strain is twice the shear.
  const double xxxx = compliance(0, 0), yyyy = compliance(1, 1), xxyy = compliance(0, 1);
  const double xxxy = compliance(0, 2) / 2, yyxy = compliance(1, 2) / 2, xyxy = compliance(2, 2) / 4;
  // With these factors the sum of squares is that of all components of the tensor, which is the same in all axes.
  isotropic_ = {(xxxx - 2 * xxyy + 4 * xyxy + yyyy) / std::sqrt(8.0), (xxxx + 2 * xxyy + yyyy) / 2};
  fourfold_ = std::complex<double>(xxxx - 2 * xxyy - 4 * xyxy + yyyy, 4 * (xxxy - yyxy)) / std::sqrt(8.0);
  twofold_ = std::complex<double>(xxxx - yyyy, 2 * (xxxy + yyxy)) / std::sqrt(2.0);
  const double norm = std::sqrt(isotropic_.squaredNorm() + std::norm(twofold_) + std::norm(fourfold_));
  isotropic_ /= norm;
  twofold_ /= norm;
  fourfold_ /= norm;
}

double RestShape::min_distance(const RestShape& other) const {
  const double product = isotropic_.dot(other.isotropic_) + std::abs(twofold_) * std::abs(other.twofold_) +
                         std::abs(fourfold_) * std::abs(other.fourfold_);
  return std::sqrt(std::max(0.0, 2 - 2 * product));
}

double RestShape::distance(const RestShape& other) const {
  const std::complex<double> twofold = std::conj(twofold_) * other.twofold_;
  const std::complex<double> fourfold = std::conj(fourfold_) * other.fourfold_;
  // The turning parts add their squares minus twice this product, which has at most four maxima over half a turn.
  const auto negative_product = [&](double angle) {
    return -(twofold * std::polar(1.0, 2 * angle) + fourfold * std::polar(1.0, 4 * angle)).real();
  };
  constexpr int steps = 48;
  std::vector<double> values;
  values.reserve(steps);
  for (int k = 0; k < steps; ++k) values.push_back(negative_product(pi * k / steps));
  const double best = least_over_angles(values, 4, negative_product).first;
  const Eigen::Vector2d difference = isotropic_ - other.isotropic_;
  const double turning =
      std::norm(twofold_) + std::norm(other.twofold_) + std::norm(fourfold_) + std::norm(other.fourfold_);
  return std::sqrt(std::max(0.0, difference.squaredNorm() + turning + 2 * best));
}

const std::vector<double>& reference_directions() {
  static const std::vector<double> directions = [] {
    std::vector<double> result;
    result.reserve(direction_count);
    for (int k = 0; k < direction_count; ++k) result.push_back(pi * k / direction_count);
    return result;
  }();
  return directions;
}

const std::vector<ReferenceProfile>& reference_profiles() {
  static const std::vector<ReferenceProfile> profiles = [] {
    std::vector<ReferenceProfile> result;
    constexpr std::array<std::pair<std::string_view, double>, 11> ratios{{{"poisson_-0.9", -0.9},
                                                                          {"poisson_-0.7", -0.7},
                                                                          {"poisson_-0.5", -0.5},
                                                                          {"poisson_-0.3", -0.3},
                                                                          {"poisson_-0.15", -0.15},
                                                                          {"poisson_0", 0},
                                                                          {"poisson_0.15", 0.15},
                                                                          {"poisson_0.3", 0.3},
                                                                          {"poisson_0.5", 0.5},
                                                                          {"poisson_0.7", 0.7},
                                                                          {"poisson_0.8", 0.8}}};
    constexpr std::size_t stiffnesses = 7;
    result.reserve(ratios.size() + stiffnesses);
    for (const auto& [name, ratio] : ratios)
      result.push_back({name, Task::poisson, Eigen::VectorXd::Constant(direction_count, ratio)});
    result.push_back({"stiffness_isotropic", Task::stiffness, orthotropic_stiffness(1, 2)});
    result.push_back({"stiffness_elliptic_2", Task::stiffness, orthotropic_stiffness(2, 3)});
    result.push_back({"stiffness_elliptic_5", Task::stiffness, orthotropic_stiffness(5, 6)});
    result.push_back({"stiffness_elliptic_10", Task::stiffness, orthotropic_stiffness(10, 11)});
    result.push_back({"stiffness_soft_diagonals", Task::stiffness, orthotropic_stiffness(1, 6)});
    result.push_back({"stiffness_stiff_diagonals", Task::stiffness, orthotropic_stiffness(1, 1)});
    result.push_back({"stiffness_one_way", Task::stiffness, orthotropic_stiffness(5, 14)});
    return result;
  }();
  return profiles;
}

ProfileDistance distance(const Compliance& compliance, const ReferenceProfile& reference, double limit) {
  /// Fraction of the deviation in steps below which that at the best angle between them is not.
  constexpr double min_refinement = 0.7;
  const std::vector<double>& directions = reference_directions();
  const Eigen::VectorXd profile = rest_profile(compliance, reference.task, directions);
  const double scale = std::max(root_mean_square(reference.y), min_scale(reference.task));
  std::vector<double> values;
  Eigen::VectorXd turned(direction_count);
  for (int shift = 0; shift < direction_count; ++shift) {
    turned << profile.tail(shift), profile.head(direction_count - shift);
    values.push_back(deviation_from(turned, reference));
  }
  const auto at_angle = [&](double angle) {
    std::vector<double> shifted = directions;
    for (double& direction : shifted) direction -= angle;
    return deviation_from(rest_profile(compliance, reference.task, shifted), reference);
  };
  const double in_steps = *std::min_element(values.begin(), values.end());
  const std::size_t max_minima = min_refinement * in_steps > limit * scale ? 0 : 2;
  const auto [best, angle] = least_over_angles(values, max_minima, at_angle);
  ProfileDistance result;
  result.orientation = std::fmod(angle + pi, pi);
  result.deviation = best / scale;
  result.is_met = result.deviation <= met_deviation || (reference.task == Task::poisson && best <= met_deviation);
  return result;
}

ProfileRange range_over_directions(const Compliance& compliance, Task task) {
  const Eigen::VectorXd profile = rest_profile(compliance, task, reference_directions());
  return {profile.minCoeff(), profile.maxCoeff()};
}

}  // namespace supple::design
