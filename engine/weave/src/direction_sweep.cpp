#include "direction_sweep.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace supple::weave {
namespace {

/// Maximum angle between neighbours that are compared, rad.
constexpr double max_neighbour_gap = 0.16;
/// The difference of two neighbours' energies should be the angle between them times a slope between theirs. It is
/// suspicious if it deviates from that by more than `unexplained_fraction` of the larger energy plus
/// `negligible_fraction` of the largest energy over all directions.
constexpr double unexplained_fraction = 0.01;
constexpr double negligible_fraction = 1e-5;
/// Relative difference of energies above which a lower energy is another equilibrium. Smaller differences are those of
/// one equilibrium or of mirror images.
constexpr double min_improvement = 1e-4;

double reduced_to_half_turn(double direction) {
  const double reduced = std::fmod(direction, std::numbers::pi);
  return reduced < 0 ? reduced + std::numbers::pi : reduced;
}

/// Energy of the second of two neighbours minus the nearest value that the slopes of both explain, N/m.
double unexplained_rise(const DirectionalResponse& first, const DirectionalResponse& second, double gap,
                        const HomogenizationOptions& options) {
  const auto [low, high] = std::minmax({energy_slope(first, options), energy_slope(second, options)});
  const double rise = second.state.energy_density - first.state.energy_density;
  return rise - std::clamp(rise, gap * low, gap * high);
}

}  // namespace

double energy_slope(const DirectionalResponse& response, const HomogenizationOptions& options) {
  const Eigen::Vector2d d(std::cos(response.direction), std::sin(response.direction));
  const Eigen::Vector2d n(-d[1], d[0]);
  const Eigen::Matrix2d& f = response.state.deformation_gradient;
  const Eigen::Matrix2d& p = response.state.nominal_stress;
  // Derivative of F^T d = stretch d by the direction: F'^T d = stretch n - F^T n.
  double slope = d.dot(p * ((1 + options.strain) * n - f.transpose() * n));
  // Derivative of n^T F d = 0, which holds if shear is suppressed: n^T F' d = d^T F d - n^T F n.
  if (!options.shear_free) slope += n.dot(p * d) * (d.dot(f * d) - n.dot(f * n));
  return slope;
}

DirectionOrder::DirectionOrder(const std::vector<DirectionalResponse>& responses) : indices_(responses.size()) {
  const auto angle = [&](std::size_t i) { return reduced_to_half_turn(responses[i].direction); };
  std::iota(indices_.begin(), indices_.end(), std::size_t{0});
  std::stable_sort(indices_.begin(), indices_.end(), [&](std::size_t a, std::size_t b) { return angle(a) < angle(b); });
  gaps_.reserve(size());
  for (std::size_t k = 0; k + 1 < size(); ++k) gaps_.push_back(angle(indices_[k + 1]) - angle(indices_[k]));
  if (size() > 0) gaps_.push_back(angle(indices_.front()) + std::numbers::pi - angle(indices_.back()));
}

std::optional<std::size_t> DirectionOrder::neighbour(std::size_t position, bool upwards) const {
  const std::size_t other = (position + (upwards ? 1 : size() - 1)) % size();
  if (other == position || gaps_[upwards ? position : other] > max_neighbour_gap) return std::nullopt;
  return other;
}

std::vector<SweepStart> suspicious_directions(const std::vector<DirectionalResponse>& responses,
                                              const DirectionOrder& order, const HomogenizationOptions& options) {
  double largest = 0;
  for (const DirectionalResponse& response : responses)
    if (response.state.stopped == Stop::converged) largest = std::max(largest, response.state.energy_density);
  std::vector<SweepStart> starts;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::optional<std::size_t> next = order.neighbour(k, true);
    if (!next) continue;
    const DirectionalResponse& one = responses[order.index(k)];
    const DirectionalResponse& other = responses[order.index(*next)];
    if (one.state.stopped == Stop::folded_flat || other.state.stopped == Stop::folded_flat) continue;
    const bool one_converged = one.state.stopped == Stop::converged;
    const bool other_converged = other.state.stopped == Stop::converged;
    double rise = 0;
    if (one_converged && other_converged) {
      rise = unexplained_rise(one, other, order.gap_after(k), options);
      const double larger = std::max(one.state.energy_density, other.state.energy_density);
      if (std::abs(rise) <= unexplained_fraction * larger + negligible_fraction * largest) continue;
    } else if (one_converged != other_converged) {
      rise = one_converged ? 1 : -1;
    }
    if (rise > 0) starts.push_back({k, true});
    if (rise < 0) starts.push_back({*next, false});
  }
  return starts;
}

bool is_better(const DirectionalResponse& response, const DirectionalResponse& other) {
  if (response.state.stopped != Stop::converged || !response.state.stable) return false;
  if (other.state.stopped != Stop::converged) return other.state.stopped != Stop::folded_flat;
  return response.state.energy_density < (1 - min_improvement) * other.state.energy_density;
}

void replace_by_better(std::vector<BetterResponse> found, std::vector<DirectionalResponse>& responses) {
  for (BetterResponse& better : found) {
    DirectionalResponse& current = responses[better.index];
    if (!is_better(better.response, current)) continue;
    better.response.state.iterations += current.state.iterations;
    better.response.state.load_steps += current.state.load_steps;
    better.response.state.branches += current.state.branches + 1;
    current = std::move(better.response);
  }
}

}  // namespace supple::weave
