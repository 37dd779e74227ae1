#include "supple/microscale/part_strain.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace supple::microscale {
namespace {

/// The barycentric coordinates of the integration points of elastic_kernel.cpp.
constexpr double integration_point[3][3] = {
    {2.0 / 3, 1.0 / 6, 1.0 / 6}, {1.0 / 6, 2.0 / 3, 1.0 / 6}, {1.0 / 6, 1.0 / 6, 2.0 / 3}};

/// The largest |s - 1| of the two singular values s of a deformation gradient.
double strain_of(const Eigen::Matrix2d& f) {
  // The sum and the difference of the singular values are the lengths of the conformal and the anticonformal part.
  const double sum = std::hypot(f(0, 0) + f(1, 1), f(1, 0) - f(0, 1));
  const double difference = std::hypot(f(0, 0) - f(1, 1), f(1, 0) + f(0, 1));
  return std::max(std::abs((sum + difference) / 2 - 1), std::abs((sum - difference) / 2 - 1));
}

}  // namespace

std::vector<double> triangle_strains(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2Xd& displacements) {
  std::vector<double> strains;
  strains.reserve(mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector2d a = mesh.corner(static_cast<int>(t), 0);
    Eigen::Matrix2d sides;
    sides << mesh.corner(static_cast<int>(t), 1) - a, mesh.corner(static_cast<int>(t), 2) - a;
    Eigen::Matrix<double, 3, 2> corner;
    corner.bottomRows<2>() = sides.inverse();
    corner.row(0) = -corner.bottomRows<2>().colwise().sum();
    double strain = 0;
    for (const auto& at : integration_point) {
      Eigen::Matrix2d f = Eigen::Matrix2d::Identity();
      for (int k = 0; k < 3; ++k) {
        const int next = (k + 1) % 3;
        f += displacements.col(mesh.triangles[t][static_cast<std::size_t>(k)]) * (4 * at[k] - 1) * corner.row(k);
        f += displacements.col(mesh.triangles[t][3 + static_cast<std::size_t>(k)]) * 4 *
             (at[k] * corner.row(next) + at[next] * corner.row(k));
      }
      strain = std::max(strain, strain_of(f));
    }
    strains.push_back(strain);
  }
  return strains;
}

double largest_strain(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2Xd& displacements) {
  const std::vector<double> strains = triangle_strains(mesh, displacements);
  return strains.empty() ? 0 : *std::max_element(strains.begin(), strains.end());
}

}  // namespace supple::microscale
