#pragma once

#include <Eigen/Core>
#include <string_view>
#include <utility>

#include "cell_coordinates.h"
#include "rotation_retraction.h"

namespace supple::microscale {

/// Periodic displacements and macroscopic strain of a patch, in the coordinates of cell_coordinates.h. Parts turn on
/// their way instead of growing.
struct CellState {
  Eigen::VectorXd x;
  const RotationRetraction* retraction;  ///< outlives the state; null: the state moves straight on

  // Implicit, so that terms can be asked for the coordinates alone.
  CellState(Eigen::VectorXd coordinates, const RotationRetraction* turning = nullptr)
      : x(std::move(coordinates)), retraction(turning) {}

  static constexpr std::string_view motion = "retraction";
  Eigen::Index dimension() const { return x.size(); }
  Eigen::VectorXd move(const Eigen::VectorXd& step) {
    if (retraction)
      x = retraction->retract(x, step);
    else
      x += step;
    return step;
  }
  void go_back(const CellState& from, double share) { x = from.x + share * (x - from.x); }
  void take_frame() {}
  bool transport(Eigen::VectorXd& /*tangent*/) const { return true; }
};

}  // namespace supple::microscale
