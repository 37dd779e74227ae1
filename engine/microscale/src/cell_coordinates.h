#pragma once

#include <Eigen/Core>

namespace supple::microscale {

/// The degrees of freedom of a periodic patch with n nodes: x = (w_0x, w_0y, ..., w_(n-1)y, F_xx - 1, F_xy, F_yx,
/// F_yy - 1).
///
/// A point that lies at rest at X (anywhere in the plane, lattice shifts included) moves to F X + w, where w is the
/// periodic displacement of its node. Positions are linear in x, and x = 0 is the state of rest.
struct CellCoordinates {
  Eigen::Index nodes = 0;

  static constexpr Eigen::Index strain_components = 4;
  Eigen::Index size() const { return 2 * nodes + strain_components; }
  /// Index of the first of a node's two displacements.
  Eigen::Index displacement(Eigen::Index node) const { return 2 * node; }
  /// Index of the first of the four components of F - I.
  Eigen::Index strain() const { return 2 * nodes; }

  Eigen::Matrix2d deformation_gradient(const Eigen::VectorXd& x) const {
    return Eigen::Matrix2d::Identity() + strain_change(x);
  }
  /// F - I, if x is a state. The change of F, if x is a step.
  Eigen::Matrix2d strain_change(const Eigen::VectorXd& x) const {
    const auto f = x.tail<4>();
    return (Eigen::Matrix2d() << f[0], f[1], f[2], f[3]).finished();
  }
};

}  // namespace supple::microscale
