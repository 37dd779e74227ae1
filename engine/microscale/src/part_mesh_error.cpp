#include "supple/microscale/part_mesh_error.h"

#include <cmath>
#include <cstddef>

namespace supple::microscale {
namespace {

/// Sums of squares of a quantity and of its differences.
struct SquaredDifference {
  double difference = 0;
  double size = 0;

  void add(double value, double other) {
    difference += (value - other) * (value - other);
    size += value * value;
  }
  /// None if there is a difference from a quantity that is zero.
  std::optional<double> relative() const {
    if (size > 0) return std::sqrt(difference / size);
    return difference > 0 ? std::nullopt : std::optional(0.0);
  }
};

}  // namespace

std::optional<PartMeshError> part_mesh_error(const PartSimulationResult& result, const PartSimulationResult& coarse) {
  SquaredDifference force, energy;
  bool any = false;
  for (std::size_t k = 0; k < result.states.size(); ++k) {
    const PartState& state = result.states[k];
    if (state.stopped != PartStop::converged) continue;
    if (k >= coarse.states.size() || coarse.states[k].stopped != PartStop::converged) return std::nullopt;
    const PartState& other = coarse.states[k];
    any = true;
    energy.add(state.energy, other.energy);
    for (std::size_t s = 0; s < state.supports.size(); ++s)
      for (const int axis : {0, 1}) force.add(state.supports[s].force[axis], other.supports[s].force[axis]);
  }
  const auto force_error = force.relative();
  const auto energy_error = energy.relative();
  if (!any || !force_error || !energy_error) return std::nullopt;
  return PartMeshError{*force_error, *energy_error};
}

}  // namespace supple::microscale
