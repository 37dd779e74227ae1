#include "homogenization.h"

#include <Eigen/Dense>

namespace supple::microscale {
namespace {

Eigen::Matrix2d symmetric(const Eigen::Vector3d& components) {
  return (Eigen::Matrix2d() << components[0], components[2], components[2], components[1]).finished();
}

}  // namespace

Eigen::Vector3d green_strain(const Eigen::Matrix2d& f) {
  const Eigen::Matrix2d h = f - Eigen::Matrix2d::Identity();
  const Eigen::Matrix2d e = 0.5 * (h + h.transpose() + h.transpose() * h);
  return {e(0, 0), e(1, 1), e(0, 1)};
}

Eigen::Vector3d second_piola_kirchhoff(const Eigen::Matrix2d& f, const Eigen::Vector4d& strain_gradient, double area) {
  const Eigen::Matrix2d p =
      (Eigen::Matrix2d() << strain_gradient[0], strain_gradient[1], strain_gradient[2], strain_gradient[3]).finished() /
      area;
  const Eigen::Matrix2d s = f.inverse() * p;
  return {s(0, 0), s(1, 1), 0.5 * (s(0, 1) + s(1, 0))};
}

Eigen::Matrix3d tangent_stiffness(const Eigen::Matrix2d& f, const Eigen::Vector3d& stress,
                                  const Eigen::Matrix4d& condensed, double area) {
  const Eigen::Matrix2d s = symmetric(stress);
  const Eigen::Matrix2d inverse_transpose = f.inverse().transpose();
  Eigen::Matrix2d h[3];
  Eigen::Matrix<double, 4, 3> components;
  for (int k = 0; k < 3; ++k) {
    Eigen::Vector3d strain = Eigen::Vector3d::Unit(k);
    strain[2] /= 2;
    h[k] = inverse_transpose * symmetric(strain);
    components.col(k) << h[k](0, 0), h[k](0, 1), h[k](1, 0), h[k](1, 1);
  }
  Eigen::Matrix3d tangent = components.transpose() * condensed * components / area;
  for (int k = 0; k < 3; ++k)
    for (int l = 0; l < 3; ++l) tangent(k, l) -= (s * h[k].transpose() * h[l]).trace();
  return 0.5 * (tangent + tangent.transpose());
}

}  // namespace supple::microscale
