#pragma once

#include <Eigen/Core>

namespace supple::neural {

/// The components of strain under a uniaxial load along d = (cos, sin): e = along E_dd + free x. The axial strain
/// E_dd = d^T E d is given, and the strains x = (E_nn, 2 E_dn) are free; n is orthogonal to d. Vectors of strain are
/// (E_xx, E_yy, 2 E_xy), and vectors of stress are (S_xx, S_yy, S_xy).
struct UniaxialFrame {
  /// `direction` is in rad.
  explicit UniaxialFrame(double direction);
  UniaxialFrame() : UniaxialFrame(0) {}

  Eigen::Vector3d strain(double axial_strain, const Eigen::Vector2d& x) const {
    return along * axial_strain + free * x;
  }
  /// The stress d^T S d. S_xy counts twice in it, as 2 E_xy does in `along`.
  double directional(const Eigen::Vector3d& stress) const { return along.dot(stress); }

  /// The derivatives of `along` and `free` with respect to the direction.
  UniaxialFrame slope() const;

  Eigen::Vector3d along;
  Eigen::Matrix<double, 3, 2> free;
};

/// The symmetric matrix with the components (11, 12, 13, 22, 23, 33).
Eigen::Matrix3d symmetric_matrix(const Eigen::Matrix<double, 6, 1>& components);

/// The residual of a state: |free^T S| / max(|S|, |C| / 1000). UniaxialOptions::tolerance is its limit.
double uniaxial_residual(const UniaxialFrame& frame, const Eigen::Vector3d& stress, const Eigen::Matrix3d& tangent);

/// Computes |H|^-1 b. |H| has the eigenvectors of the symmetric H and the absolute values of its eigenvalues. Those
/// below 1e-8 of the largest one are replaced by this limit. Hence -|H|^-1 gradient is a descent direction.
Eigen::Vector2d convex_solve(const Eigen::Matrix2d& h, const Eigen::Vector2d& b);

}  // namespace supple::neural
