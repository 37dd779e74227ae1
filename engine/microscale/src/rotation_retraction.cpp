#include "rotation_retraction.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "supple/numerics/hessian_entries.h"

namespace supple::microscale {
namespace {

/// Steps that turn no triangle by more than this (rad) are taken straight: they differ by its square.
constexpr double smallest_angle = 0.02;
/// Triangles that turn by less follow those that turn more.
constexpr double negligible_angle = 1e-3;
/// Parts that are connected with nothing could move freely: their share of the Laplacian's diagonal.
constexpr double relative_shift = 1e-9;

/// Nodes of the four parts of a triangle, in the order of the corners; the middle part is turned upside down, so that
/// its barycentric gradients are those of the corners times -2 instead of 2.
constexpr int part_nodes[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {4, 5, 3}};
const Eigen::Array4d part_scale(2, 2, 2, -2);

}  // namespace

RotationRetraction::RotationRetraction(const tiling::PeriodicMesh& mesh) : coordinates_{mesh.nodes.cols()} {
  numerics::HessianEntries entries(coordinates_.nodes);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector2d a = mesh.corner(static_cast<int>(t), 0);
    Eigen::Matrix2d sides;
    sides << mesh.corner(static_cast<int>(t), 1) - a, mesh.corner(static_cast<int>(t), 2) - a;
    const Triangle triangle{mesh.triangles[t], sides.inverse(), sides.determinant() / 8};
    Eigen::Matrix<double, 3, 2> gradient;
    gradient << -triangle.gradient.colwise().sum(), triangle.gradient;
    const Eigen::Matrix3d products = 4 * triangle.area * gradient * gradient.transpose();
    for (const auto& part : part_nodes)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l <= k; ++l) {
          const int row = triangle.node[static_cast<std::size_t>(part[k])];
          const int column = triangle.node[static_cast<std::size_t>(part[l])];
          entries.add(row, column, (k != l && row == column ? 2 : 1) * products(k, l));
        }
    triangles_.push_back(triangle);
  }
  auto matrix = std::make_shared<numerics::BorderedMatrix>();
  entries.assemble(coordinates_.nodes, *matrix);
  const numerics::Hessian laplacian = std::shared_ptr<const numerics::BorderedMatrix>(matrix);
  laplacian_.factorize(laplacian, relative_shift * numerics::matrix_scale(laplacian));
}

void RotationRetraction::add_gradients(const Triangle& triangle, const Eigen::VectorXd& x, Gradients& sum) {
  Eigen::Array<double, 2, 6> at;
  for (int k = 0; k < 6; ++k) at.col(k) = x.segment<2>(2 * triangle.node[static_cast<std::size_t>(k)]);
  for (int i = 0; i < 2; ++i) {
    Eigen::Array4d first;
    Eigen::Array4d second;
    for (int p = 0; p < 4; ++p) {
      first[p] = at(i, part_nodes[p][1]) - at(i, part_nodes[p][0]);
      second[p] = at(i, part_nodes[p][2]) - at(i, part_nodes[p][0]);
    }
    for (int j = 0; j < 2; ++j)
      sum[i + 2 * j] += part_scale * (first * triangle.gradient(0, j) + second * triangle.gradient(1, j));
  }
}

Eigen::VectorXd RotationRetraction::retract(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const {
  const Eigen::Matrix2d f0 = coordinates_.deformation_gradient(x);
  const Eigen::Matrix2d d0 = coordinates_.strain_change(step);
  Eigen::Matrix2Xd excess = Eigen::Matrix2Xd::Zero(2, coordinates_.nodes);
  double largest = 0;
  for (const Triangle& triangle : triangles_) {
    Gradients f;
    Gradients d;
    for (int k = 0; k < 4; ++k) {
      f[k].setConstant(f0(k));
      d[k].setConstant(d0(k));
    }
    add_gradients(triangle, x, f);
    add_gradients(triangle, step, d);
    // The angle is the skew part of D F^-1; a part need not be free of inversion, only of collapse.
    const Eigen::Array4d angle =
        (d[1] * f[3] - d[3] * f[1] - d[2] * f[0] + d[0] * f[2]) / (2 * (f[0] * f[3] - f[1] * f[2]));
    const double turned = angle.abs().maxCoeff();
    if (!(turned > negligible_angle)) continue;  // also where a part has collapsed and has no angle
    largest = std::max(largest, turned);
    const Eigen::Array4d c = angle.cos();
    const Eigen::Array4d s = angle.sin();
    // R (F + D - angle J F) - F - D, column by column.
    Gradients difference;
    for (int j = 0; j < 4; j += 2) {
      const Eigen::Array4d above = f[j] + d[j] + angle * f[j + 1];
      const Eigen::Array4d below = f[j + 1] + d[j + 1] - angle * f[j];
      difference[j] = triangle.area * part_scale * (c * above - s * below - f[j] - d[j]);
      difference[j + 1] = triangle.area * part_scale * (s * above + c * below - f[j + 1] - d[j + 1]);
    }
    for (int i = 0; i < 2; ++i) {
      const Eigen::Array4d first =
          difference[i] * triangle.gradient(0, 0) + difference[i + 2] * triangle.gradient(0, 1);
      const Eigen::Array4d second =
          difference[i] * triangle.gradient(1, 0) + difference[i + 2] * triangle.gradient(1, 1);
      for (int p = 0; p < 4; ++p) {
        excess(i, triangle.node[static_cast<std::size_t>(part_nodes[p][0])]) -= first[p] + second[p];
        excess(i, triangle.node[static_cast<std::size_t>(part_nodes[p][1])]) += first[p];
        excess(i, triangle.node[static_cast<std::size_t>(part_nodes[p][2])]) += second[p];
      }
    }
  }
  Eigen::VectorXd moved = x + step;
  if (largest < smallest_angle) return moved;
  const Eigen::MatrixXd change = laplacian_.solve_core(excess.transpose());
  for (Eigen::Index node = 0; node < coordinates_.nodes; ++node)
    moved.segment<2>(coordinates_.displacement(node)) += (change.row(node) - change.row(0)).transpose();
  return moved;
}

}  // namespace supple::microscale
