#include "supple/neural/uniaxial_frame.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace supple::neural {
namespace {

/// Residuals are relative to the stress, or to this fraction of the stiffness if that is larger. Close to rest,
/// stresses are differences of numbers, with rounding errors of about 1e-14 of the stiffness.
constexpr double min_stress_ratio = 1e-3;
/// Lower limit of the eigenvalues of |H|, relative to the largest one.
constexpr double min_curvature_ratio = 1e-8;

}  // namespace

UniaxialFrame::UniaxialFrame(double direction) {
  const double c = std::cos(direction);
  const double s = std::sin(direction);
  along << c * c, s * s, 2 * c * s;
  free.col(0) << s * s, c * c, -2 * c * s;
  free.col(1) << -c * s, c * s, c * c - s * s;
}

UniaxialFrame UniaxialFrame::slope() const {
  UniaxialFrame slope;
  slope.along = 2 * free.col(1);
  slope.free.col(0) = -2 * free.col(1);
  slope.free.col(1) = free.col(0) - along;
  return slope;
}

Eigen::Matrix3d symmetric_matrix(const Eigen::Matrix<double, 6, 1>& c) {
  Eigen::Matrix3d m;
  m << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return m;
}

double uniaxial_residual(const UniaxialFrame& frame, const Eigen::Vector3d& stress, const Eigen::Matrix3d& tangent) {
  const double scale = std::max({stress.norm(), min_stress_ratio * tangent.norm(), 1e-300});
  return (frame.free.transpose() * stress).norm() / scale;
}

Eigen::Vector2d convex_solve(const Eigen::Matrix2d& h, const Eigen::Vector2d& b) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(h);
  Eigen::Vector2d values = eigen.eigenvalues().cwiseAbs();
  values = values.cwiseMax(std::max(min_curvature_ratio * values.maxCoeff(), 1e-30));
  return eigen.eigenvectors() * (eigen.eigenvectors().transpose() * b).cwiseQuotient(values);
}

}  // namespace supple::neural
