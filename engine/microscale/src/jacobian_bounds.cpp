#include "jacobian_bounds.h"

#include <Eigen/Dense>
#include <algorithm>

namespace supple::microscale {
namespace {

/// F at the point of a triangle whose barycentric coordinates are `point`.
Eigen::Matrix2d deformation_gradient(const Eigen::Matrix<double, 2, 3>& gradients,
                                     const Eigen::Matrix<double, 2, 6>& displacements,
                                     const Eigen::Matrix2d& strain_change, const Eigen::Vector3d& point) {
  Eigen::Matrix2d f = Eigen::Matrix2d::Identity() + strain_change;
  for (int k = 0; k < 3; ++k) {
    const int next = (k + 1) % 3;
    f += (4 * point[k] - 1) * displacements.col(k) * gradients.col(k).transpose();
    f += 4 * displacements.col(3 + k) * (point[k] * gradients.col(next) + point[next] * gradients.col(k)).transpose();
  }
  return f;
}

/// The least value on [0, 1] of the parabola f with f(0) = start, f(1/2) = middle and f(1) = end.
double smallest_on_side(double start, double middle, double end) {
  const double curvature = 2 * (start + end) - 4 * middle;
  const double slope = 4 * middle - 3 * start - end;
  double smallest = std::min(start, end);
  if (curvature > 0) {
    const double t = -slope / (2 * curvature);
    if (t > 0 && t < 1) smallest = std::min(smallest, start + t * (slope + t * curvature));
  }
  return smallest;
}

}  // namespace

double smallest_quadratic_jacobian(const Eigen::Matrix<double, 2, 3>& gradients,
                                   const Eigen::Matrix<double, 2, 6>& displacements,
                                   const Eigen::Matrix2d& strain_change) {
  const auto f = [&](double a, double b, double c) {
    return deformation_gradient(gradients, displacements, strain_change, {a, b, c});
  };
  const Eigen::Matrix2d corner = f(1, 0, 0);
  const Eigen::Matrix2d along_s = f(0, 1, 0) - corner;
  const Eigen::Matrix2d along_t = f(0, 0, 1) - corner;
  // det (A + s B + t C) = c0 + cs s + ct t + css s^2 + cst s t + ctt t^2. The mixed coefficient of two matrices is
  // det (A + B) - det A - det B.
  const auto mixed = [](const Eigen::Matrix2d& a, const Eigen::Matrix2d& b) {
    return a(0, 0) * b(1, 1) + a(1, 1) * b(0, 0) - a(0, 1) * b(1, 0) - a(1, 0) * b(0, 1);
  };
  const double c0 = corner.determinant();
  const double cs = mixed(corner, along_s);
  const double ct = mixed(corner, along_t);
  const double css = along_s.determinant();
  const double cst = mixed(along_s, along_t);
  const double ctt = along_t.determinant();
  const auto value = [&](double s, double t) { return c0 + s * (cs + css * s + cst * t) + t * (ct + ctt * t); };

  double smallest = smallest_on_side(value(0, 0), value(0.5, 0), value(1, 0));
  smallest = std::min(smallest, smallest_on_side(value(0, 0), value(0, 0.5), value(0, 1)));
  smallest = std::min(smallest, smallest_on_side(value(1, 0), value(0.5, 0.5), value(0, 1)));
  const double discriminant = 4 * css * ctt - cst * cst;
  if (discriminant > 0 && css > 0) {
    const double s = (cst * ct - 2 * ctt * cs) / discriminant;
    const double t = (cst * cs - 2 * css * ct) / discriminant;
    if (s > 0 && t > 0 && s + t < 1) smallest = std::min(smallest, value(s, t));
  }
  return smallest;
}

}  // namespace supple::microscale
