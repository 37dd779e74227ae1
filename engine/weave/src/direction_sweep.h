#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "supple/weave/homogenization.h"

namespace supple::weave {

/// The derivative of the energy density of an equilibrium by the direction angle along which the cell is strained, N/m
/// per rad. It is P : F', where F' is the derivative of the deformation gradient with F^T d = stretch d. Only the
/// prescribed part of F' does work.
double energy_slope(const DirectionalResponse& response, const HomogenizationOptions& options);

/// Directions sorted by their angles over half a turn. The first one follows the last one.
class DirectionOrder {
 public:
  explicit DirectionOrder(const std::vector<DirectionalResponse>& responses);
  std::size_t size() const { return indices_.size(); }
  /// The index of the direction at a position in this order.
  std::size_t index(std::size_t position) const { return indices_[position]; }
  /// The position before or after this one; nothing if the two directions are more than 0.16 rad apart.
  std::optional<std::size_t> neighbour(std::size_t position, bool upwards) const;
  double gap_after(std::size_t position) const { return gaps_[position]; }  ///< angle to the next direction, rad

 private:
  std::vector<std::size_t> indices_;
  std::vector<double> gaps_;
};

/// A direction whose equilibrium is the initial state for the next direction, and so on from direction to direction as
/// long as lower energies are found.
struct SweepStart {
  std::size_t position = 0;  ///< in the DirectionOrder
  bool upwards = true;       ///< towards larger angles
};

/// The starts of sweeps, each next to a suspicious direction. A direction is suspicious if its energy exceeds the
/// neighbour's by more than the slopes of both explain, or if it has no equilibrium. O(n) for n directions.
std::vector<SweepStart> suspicious_directions(const std::vector<DirectionalResponse>& responses,
                                              const DirectionOrder& order, const HomogenizationOptions& options);

/// Whether `response` is a stable equilibrium whose energy is lower than that of `other` for the same direction, or
/// `other` is no equilibrium. A cell that folded flat is not replaced.
bool is_better(const DirectionalResponse& response, const DirectionalResponse& other);

/// A better response for the direction with the index `index`.
struct BetterResponse {
  std::size_t index = 0;
  DirectionalResponse response{};
};
/// Replaces responses by the best ones that were found. Counts of iterations and load steps are added up, and the
/// replacement counts as one more unstable equilibrium that was left.
void replace_by_better(std::vector<BetterResponse> found, std::vector<DirectionalResponse>& responses);

}  // namespace supple::weave
