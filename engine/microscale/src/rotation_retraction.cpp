#include "rotation_retraction.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "supple/numerics/hessian_entries.h"

namespace supple::microscale {
namespace {

/// Steps that rotate no subtriangle by this much (rad) are straight. The curve would differ by the square of the angle.
constexpr double min_angle = 0.02;
/// Smaller rotations (rad) are ignored. Such subtriangles follow their neighbours.
constexpr double negligible_angle = 1e-3;
/// Shift of the Laplacian's diagonal, relative to the Laplacian's scale. It makes the Laplacian positive definite,
/// which otherwise leaves the translation of every connected part free.
constexpr double relative_shift = 1e-9;

/// Nodes of the four subtriangles of a triangle, and the factor between the barycentric gradients of a subtriangle and
/// those of the triangle. The middle one is upside down, hence -2.
constexpr int subtriangle_nodes[4][3] = {{0, 3, 5}, {3, 1, 4}, {5, 4, 2}, {4, 5, 3}};
const Eigen::Array4d subtriangle_scale(2, 2, 2, -2);

}  // namespace

RotationRetraction::RotationRetraction(const tiling::PeriodicMesh& mesh)
    : coordinates_{mesh.nodes.cols()}, follows_first_node_(true) {
  add_triangles(mesh);
  components_[0] = std::make_unique<Component>();
  factorize(std::vector<bool>(static_cast<std::size_t>(coordinates_.nodes), false), *components_[0]);
}

RotationRetraction::RotationRetraction(const tiling::PeriodicMesh& mesh, const std::vector<bool>& fixed)
    : coordinates_{mesh.nodes.cols()}, follows_first_node_(false) {
  add_triangles(mesh);
  fix(fixed);
}

void RotationRetraction::fix(const std::vector<bool>& fixed) {
  std::array<std::vector<bool>, 2> of_axis;
  for (std::size_t k = 0; k < fixed.size(); ++k) of_axis[k % 2].push_back(fixed[k]);
  follows_first_node_ = false;
  components_[1].reset();
  for (std::size_t axis = 0; axis < (of_axis[0] == of_axis[1] ? 1U : 2U); ++axis) {
    components_[axis] = std::make_unique<Component>();
    factorize(of_axis[axis], *components_[axis]);
  }
}

void RotationRetraction::add_triangles(const tiling::PeriodicMesh& mesh) {
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector2d a = mesh.corner(static_cast<int>(t), 0);
    Eigen::Matrix2d sides;
    sides << mesh.corner(static_cast<int>(t), 1) - a, mesh.corner(static_cast<int>(t), 2) - a;
    triangles_.push_back({mesh.triangles[t], sides.inverse(), sides.determinant() / 8});
  }
}

void RotationRetraction::factorize(const std::vector<bool>& fixed, Component& component) const {
  component.unknowns = numerics::Unknowns(fixed);
  numerics::HessianEntries entries(component.unknowns.numbering());
  for (const Triangle& triangle : triangles_) {
    Eigen::Matrix<double, 3, 2> gradient;
    gradient << -triangle.gradient.colwise().sum(), triangle.gradient;
    const Eigen::Matrix3d products = 4 * triangle.area * gradient * gradient.transpose();
    for (const auto& subtriangle : subtriangle_nodes)
      for (int k = 0; k < 3; ++k)
        for (int l = 0; l <= k; ++l) {
          const int row = triangle.node[static_cast<std::size_t>(subtriangle[k])];
          const int column = triangle.node[static_cast<std::size_t>(subtriangle[l])];
          entries.add(row, column, (k != l && row == column ? 2 : 1) * products(k, l));
        }
  }
  auto matrix = std::make_shared<numerics::BorderedMatrix>();
  entries.assemble(coordinates_.nodes, *matrix);
  const numerics::Hessian laplacian = std::shared_ptr<const numerics::BorderedMatrix>(matrix);
  component.laplacian.factorize(laplacian, relative_shift * numerics::matrix_scale(laplacian));
}

void RotationRetraction::add_gradients(const Triangle& triangle, const Eigen::VectorXd& x, Gradients& sum) {
  Eigen::Array<double, 2, 6> at;
  for (int k = 0; k < 6; ++k) at.col(k) = x.segment<2>(2 * triangle.node[static_cast<std::size_t>(k)]);
  for (int i = 0; i < 2; ++i) {
    Eigen::Array4d first;
    Eigen::Array4d second;
    for (int p = 0; p < 4; ++p) {
      first[p] = at(i, subtriangle_nodes[p][1]) - at(i, subtriangle_nodes[p][0]);
      second[p] = at(i, subtriangle_nodes[p][2]) - at(i, subtriangle_nodes[p][0]);
    }
    for (int j = 0; j < 2; ++j)
      sum[i + 2 * j] += subtriangle_scale * (first * triangle.gradient(0, j) + second * triangle.gradient(1, j));
  }
}

Eigen::VectorXd RotationRetraction::retract(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const {
  const Eigen::Matrix2d f0 = coordinates_.deformation_gradient(x);
  const Eigen::Matrix2d d0 = coordinates_.strain_change(step);
  Eigen::Matrix2Xd right_side = Eigen::Matrix2Xd::Zero(2, coordinates_.nodes);
  double largest_angle = 0;
  for (const Triangle& triangle : triangles_) {
    Gradients f;
    Gradients d;
    for (int k = 0; k < 4; ++k) {
      f[k].setConstant(f0(k));
      d[k].setConstant(d0(k));
    }
    add_gradients(triangle, x, f);
    add_gradients(triangle, step, d);
    // The angle is the skew part of D F^-1. A subtriangle may be inverted, but det F must not vanish.
    const Eigen::Array4d angle =
        (d[1] * f[3] - d[3] * f[1] - d[2] * f[0] + d[0] * f[2]) / (2 * (f[0] * f[3] - f[1] * f[2]));
    const double triangle_angle = angle.abs().maxCoeff();
    if (!(triangle_angle > negligible_angle)) continue;  // also if det F = 0 and the angle is not a number
    largest_angle = std::max(largest_angle, triangle_angle);
    const Eigen::Array4d c = angle.cos();
    const Eigen::Array4d s = angle.sin();
    // R (F + D - angle J F) - F - D, column by column. R is the rotation by the angle, and J that by a right angle.
    Gradients difference;
    for (int j = 0; j < 4; j += 2) {
      const Eigen::Array4d first_row = f[j] + d[j] + angle * f[j + 1];
      const Eigen::Array4d second_row = f[j + 1] + d[j + 1] - angle * f[j];
      difference[j] = triangle.area * subtriangle_scale * (c * first_row - s * second_row - f[j] - d[j]);
      difference[j + 1] = triangle.area * subtriangle_scale * (s * first_row + c * second_row - f[j + 1] - d[j + 1]);
    }
    for (int i = 0; i < 2; ++i) {
      const Eigen::Array4d first =
          difference[i] * triangle.gradient(0, 0) + difference[i + 2] * triangle.gradient(0, 1);
      const Eigen::Array4d second =
          difference[i] * triangle.gradient(1, 0) + difference[i + 2] * triangle.gradient(1, 1);
      for (int p = 0; p < 4; ++p) {
        right_side(i, triangle.node[static_cast<std::size_t>(subtriangle_nodes[p][0])]) -= first[p] + second[p];
        right_side(i, triangle.node[static_cast<std::size_t>(subtriangle_nodes[p][1])]) += first[p];
        right_side(i, triangle.node[static_cast<std::size_t>(subtriangle_nodes[p][2])]) += second[p];
      }
    }
  }
  Eigen::VectorXd moved = x + step;
  if (largest_angle < min_angle) return moved;
  const auto solve = [&right_side](const Component& component, Eigen::Index axis, Eigen::Index axes) {
    Eigen::MatrixXd known(component.unknowns.size(), axes);
    for (Eigen::Index k = 0; k < axes; ++k)
      known.col(k) = component.unknowns.restrict(right_side.row(axis + k).transpose());
    return component.unknowns.expand_core(component.laplacian.solve_core(known));
  };
  Eigen::MatrixXd change(coordinates_.nodes, 2);
  if (components_[1])
    change << solve(*components_[0], 0, 1), solve(*components_[1], 1, 1);
  else
    change = solve(*components_[0], 0, 2);
  const Eigen::RowVector2d common =
      follows_first_node_ ? Eigen::RowVector2d(change.row(0)) : Eigen::RowVector2d(Eigen::RowVector2d::Zero());
  for (Eigen::Index node = 0; node < coordinates_.nodes; ++node)
    moved.segment<2>(coordinates_.displacement(node)) += (change.row(node) - common).transpose();
  return moved;
}

}  // namespace supple::microscale
