#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "supple/weave/homogenization.h"

namespace supple::weave {

/// The derivative of the energy density of an equilibrium by the direction along which the cell is strained, N/m per
/// rad. With F^T d = stretch d it is P : F', where only the part of F' that is prescribed does work.
double energy_slope(const DirectionalResponse& response, const HomogenizationOptions& options);

/// Directions in the order of their angles over half a turn, after which the first one follows again.
class DirectionOrder {
 public:
  explicit DirectionOrder(const std::vector<DirectionalResponse>& responses);
  std::size_t size() const { return indices_.size(); }
  /// The index of the direction at a position in the order.
  std::size_t index(std::size_t position) const { return indices_[position]; }
  /// The position before or after this one, if the directions are at most 0.16 rad apart.
  std::optional<std::size_t> neighbour(std::size_t position, bool upwards) const;
  double gap_after(std::size_t position) const { return gaps_[position]; }  ///< rad

 private:
  std::vector<std::size_t> indices_;
  std::vector<double> gaps_;
};

/// A direction whose equilibrium is carried over to the directions beside it, one after the other, as long as that
/// finds lower energies.
struct SweepStart {
  std::size_t position = 0;  ///< in the order
  bool upwards = true;       ///< towards larger angles
};

/// The directions beside which the energy is suspicious: it rises to a neighbour by more than the slopes of both
/// explain, or the neighbour has no equilibrium. O(n) for n directions.
std::vector<SweepStart> suspicious_directions(const std::vector<DirectionalResponse>& responses,
                                              const DirectionOrder& order, const HomogenizationOptions& options);

/// Whether a response is an equilibrium of less energy than another one for the same direction, or the other is none.
bool is_better(const DirectionalResponse& response, const DirectionalResponse& than);

/// A better response for the direction with this index.
struct BetterResponse {
  std::size_t index = 0;
  DirectionalResponse response{};
};
/// Replaces responses by the best ones that were found. The counts of what was computed add up, and another branch
/// counts as left.
void take_better(std::vector<BetterResponse> found, std::vector<DirectionalResponse>& responses);

}  // namespace supple::weave
