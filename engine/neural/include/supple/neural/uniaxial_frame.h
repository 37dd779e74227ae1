#pragma once

#include <Eigen/Core>

namespace supple::neural {

/// Strains under a uniaxial load along d = (cos, sin): e = along E_dd + free x, where E_dd = d^T E d is given and
/// x = (E_nn, 2 E_dn) is free, n orthogonal to d. Vectors of strain are (E_xx, E_yy, 2 E_xy), of stress
/// (S_xx, S_yy, S_xy).
struct UniaxialFrame {
  /// `direction` in rad.
  explicit UniaxialFrame(double direction);
  UniaxialFrame() : UniaxialFrame(0) {}

  Eigen::Vector3d strain(double given, const Eigen::Vector2d& x) const { return along * given + free * x; }
  /// The stress d^T S d. S_xy counts twice in it, as 2 E_xy does in `along`.
  double directional(const Eigen::Vector3d& stress) const { return along.dot(stress); }

  /// The derivatives of `along` and `free` by the direction.
  UniaxialFrame slope() const;

  Eigen::Vector3d along;
  Eigen::Matrix<double, 3, 2> free;
};

/// The symmetric matrix of (11, 12, 13, 22, 23, 33).
Eigen::Matrix3d symmetric_matrix(const Eigen::Matrix<double, 6, 1>& components);

/// How far a state is from equilibrium: |free^T S| / max(|S|, |C| / 1000). UniaxialOptions::tolerance bounds it.
double uniaxial_residual(const UniaxialFrame& frame, const Eigen::Vector3d& stress, const Eigen::Matrix3d& tangent);

/// Computes |H|^-1 b. |H| has the absolute values of the eigenvalues of the symmetric H, none below a share of the
/// largest, so that -|H|^-1 gradient is a descent direction.
Eigen::Vector2d convex_solve(const Eigen::Matrix2d& h, const Eigen::Vector2d& b);

}  // namespace supple::neural
