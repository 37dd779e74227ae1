#include "direction_sweep.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace supple::weave {
namespace {

/// Neighbours farther apart than this say too little about each other, rad.
constexpr double widest_gap = 0.16;
/// The difference of two neighbours' energies is the gap between them times a slope between theirs.
/// Nothing is suspicious below this share of the larger energy, or of the largest one over all directions.
constexpr double unexplained_share = 0.01;
constexpr double negligible_share = 1e-5;
/// Energies closer than this, relative, are those of one equilibrium or of mirror images.
constexpr double least_improvement = 1e-4;

double turned_into_half_turn(double direction) {
  const double turned = std::fmod(direction, std::numbers::pi);
  return turned < 0 ? turned + std::numbers::pi : turned;
}

/// How much more energy (or less, if negative) the second of two neighbours has than the slopes of both explain, N/m.
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
  // The derivative of F^T d = stretch d: F'^T d = stretch n - F^T n.
  double slope = d.dot(p * ((1 + options.strain) * n - f.transpose() * n));
  // The derivative of n^T F d = 0, where shear is suppressed: n^T F' d = d^T F d - n^T F n.
  if (!options.shear_free) slope += n.dot(p * d) * (d.dot(f * d) - n.dot(f * n));
  return slope;
}

DirectionOrder::DirectionOrder(const std::vector<DirectionalResponse>& responses) : indices_(responses.size()) {
  const auto angle = [&](std::size_t i) { return turned_into_half_turn(responses[i].direction); };
  std::iota(indices_.begin(), indices_.end(), std::size_t{0});
  std::stable_sort(indices_.begin(), indices_.end(), [&](std::size_t a, std::size_t b) { return angle(a) < angle(b); });
  gaps_.reserve(size());
  for (std::size_t k = 0; k + 1 < size(); ++k) gaps_.push_back(angle(indices_[k + 1]) - angle(indices_[k]));
  if (size() > 0) gaps_.push_back(angle(indices_.front()) + std::numbers::pi - angle(indices_.back()));
}

std::optional<std::size_t> DirectionOrder::neighbour(std::size_t position, bool upwards) const {
  const std::size_t other = (position + (upwards ? 1 : size() - 1)) % size();
  if (other == position || gaps_[upwards ? position : other] > widest_gap) return std::nullopt;
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
      if (std::abs(rise) <= unexplained_share * larger + negligible_share * largest) continue;
    } else if (one_converged != other_converged) {
      rise = one_converged ? 1 : -1;
    }
    if (rise > 0) starts.push_back({k, true});
    if (rise < 0) starts.push_back({*next, false});
  }
  return starts;
}

bool is_better(const DirectionalResponse& response, const DirectionalResponse& than) {
  if (response.state.stopped != Stop::converged || !response.state.stable) return false;
  if (than.state.stopped != Stop::converged) return than.state.stopped != Stop::folded_flat;
  return response.state.energy_density < (1 - least_improvement) * than.state.energy_density;
}

void take_better(std::vector<BetterResponse> found, std::vector<DirectionalResponse>& responses) {
  for (BetterResponse& better : found) {
    DirectionalResponse& kept = responses[better.index];
    if (!is_better(better.response, kept)) continue;
    better.response.state.iterations += kept.state.iterations;
    better.response.state.load_steps += kept.state.load_steps;
    better.response.state.branches += kept.state.branches + 1;
    kept = std::move(better.response);
  }
}

}  // namespace supple::weave
