#include "rotation_retraction.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "supple/numerics/energy.h"

namespace supple::microscale {
namespace {

/// Steps that turn no triangle by more than this (rad) are taken straight: they differ by its square.
constexpr double smallest_angle = 0.02;
/// Parts that are connected with nothing could move freely: their share of the Laplacian's diagonal.
constexpr double relative_shift = 1e-9;

/// Nodes of the four pieces of a quadratic triangle, and the corners whose barycentric gradients theirs are multiples
/// of.
struct Division {
  std::array<int, 3> node;
  std::array<int, 3> corner;
  double multiple;
};
constexpr Division divisions[] = {
    {{0, 3, 5}, {0, 1, 2}, 2}, {{3, 1, 4}, {0, 1, 2}, 2}, {{5, 4, 2}, {0, 1, 2}, 2}, {{4, 5, 3}, {0, 1, 2}, -2}};

}  // namespace

RotationRetraction::RotationRetraction(const tiling::PeriodicMesh& mesh) : coordinates_{mesh.nodes.cols()} {
  numerics::HessianEntries entries(coordinates_.nodes);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Eigen::Vector2d a = mesh.corner(static_cast<int>(t), 0);
    Eigen::Matrix2d sides;
    sides << mesh.corner(static_cast<int>(t), 1) - a, mesh.corner(static_cast<int>(t), 2) - a;
    const Eigen::Matrix2d inverse = sides.inverse();
    const std::array<Eigen::Vector2d, 3> gradient{-(inverse.row(0) + inverse.row(1)).transpose(),
                                                  inverse.row(0).transpose(), inverse.row(1).transpose()};
    for (const Division& division : divisions) {
      Piece piece;
      for (std::size_t k = 0; k < 3; ++k) {
        piece.node[k] = mesh.triangles[t][static_cast<std::size_t>(division.node[k])];
        piece.gradient[k] = division.multiple * gradient[static_cast<std::size_t>(division.corner[k])];
      }
      piece.area = sides.determinant() / 8;
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t l = 0; l <= k; ++l) {
          const double both = k != l && piece.node[k] == piece.node[l] ? 2 : 1;
          entries.add(piece.node[k], piece.node[l], both * piece.area * piece.gradient[k].dot(piece.gradient[l]));
        }
      pieces_.push_back(piece);
    }
  }
  auto matrix = std::make_shared<numerics::BorderedMatrix>();
  entries.assemble(coordinates_.nodes, *matrix);
  const numerics::Hessian laplacian = std::shared_ptr<const numerics::BorderedMatrix>(matrix);
  laplacian_.factorize(laplacian, relative_shift * numerics::diagonal_scale(laplacian));
}

Eigen::VectorXd RotationRetraction::retract(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const {
  const Eigen::Matrix2d f0 = coordinates_.deformation_gradient(x);
  const Eigen::Matrix2d d0 = coordinates_.strain_change(step);
  Eigen::MatrixXd excess = Eigen::MatrixXd::Zero(coordinates_.nodes, 2);
  double largest = 0;
  for (const Piece& piece : pieces_) {
    Eigen::Matrix2d f = f0;
    Eigen::Matrix2d d = d0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Eigen::Index at = coordinates_.displacement(piece.node[k]);
      f += x.segment<2>(at) * piece.gradient[k].transpose();
      d += step.segment<2>(at) * piece.gradient[k].transpose();
    }
    // The angle is the skew part of D F^-1; the deformed piece need not be free of inversion, only of collapse.
    const double determinant = f.determinant();
    const double angle =
        (d(1, 0) * f(1, 1) - d(1, 1) * f(1, 0) - d(0, 1) * f(0, 0) + d(0, 0) * f(0, 1)) / (2 * determinant);
    if (!std::isfinite(angle)) continue;
    largest = std::max(largest, std::abs(angle));
    const double c = std::cos(angle);
    const double s = std::sin(angle);
    Eigen::Matrix2d spin;  // angle J F
    spin << -angle * f.row(1), angle * f.row(0);
    Eigen::Matrix2d rotation;
    rotation << c, -s, s, c;
    const Eigen::Matrix2d difference = rotation * (f + d - spin) - f - d;
    for (std::size_t k = 0; k < 3; ++k)
      excess.row(piece.node[k]) += piece.area * (difference * piece.gradient[k]).transpose();
  }
  Eigen::VectorXd moved = x + step;
  if (largest < smallest_angle) return moved;
  const Eigen::MatrixXd change = laplacian_.solve_core(excess);
  for (Eigen::Index node = 0; node < coordinates_.nodes; ++node)
    moved.segment<2>(coordinates_.displacement(node)) += (change.row(node) - change.row(0)).transpose();
  return moved;
}

}  // namespace supple::microscale
