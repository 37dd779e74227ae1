#pragma once

#include <Eigen/Core>
#include <string_view>
#include <utility>

#include "cell_coordinates.h"
#include "rotation_retraction.h"
#include "supple/numerics/state.h"

namespace supple::microscale {

/// Periodic displacements and macroscopic strain of a patch, in the coordinates of cell_coordinates.h. A step rotates
/// parts of the patch, where a straight step would stretch them; see RotationRetraction.
struct CellState : numerics::VectorState {
  const RotationRetraction* retraction;  ///< must outlive the state; null if the state moves on straight lines

  // The constructor is implicit, so that callers can pass coordinates where a term takes a state.
  CellState(Eigen::VectorXd coordinates, const RotationRetraction* optional_retraction = nullptr)
      : VectorState{std::move(coordinates)}, retraction(optional_retraction) {}

  static constexpr std::string_view motion = "retraction";
  Eigen::VectorXd move(const Eigen::VectorXd& step) {
    if (!retraction) return VectorState::move(step);
    x = retraction->retract(x, step);
    return step;
  }
};

}  // namespace supple::microscale
