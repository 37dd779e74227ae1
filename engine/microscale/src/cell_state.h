#pragma once

#include <Eigen/Core>
#include <string_view>
#include <utility>

#include "cell_coordinates.h"
#include "rotation_retraction.h"
#include "supple/numerics/state.h"

namespace supple::microscale {

/// Periodic displacements and macroscopic strain of a patch, in the coordinates of cell_coordinates.h. Parts turn on
/// their way instead of growing.
struct CellState : numerics::VectorState {
  const RotationRetraction* retraction;  ///< outlives the state; null: the state moves straight on

  // Implicit, so that terms can be asked for the coordinates alone.
  CellState(Eigen::VectorXd coordinates, const RotationRetraction* turning = nullptr)
      : VectorState{std::move(coordinates)}, retraction(turning) {}

  static constexpr std::string_view motion = "retraction";
  Eigen::VectorXd move(const Eigen::VectorXd& step) {
    if (!retraction) return VectorState::move(step);
    x = retraction->retract(x, step);
    return step;
  }
};

}  // namespace supple::microscale
