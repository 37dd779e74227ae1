#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "cell_coordinates.h"
#include "supple/numerics/cholesky.h"
#include "supple/tiling/mesh.h"

namespace supple::microscale {

/// Moves a patch along a direction on a curve on which its parts turn instead of growing.
///
/// A straight step turns a beam by moving its end along the tangent: it grows longer, its energy rises steeply, and
/// steps must be short. Here each triangle's deformation gradient F with the change D turns by the angle that D means
/// to first order and changes by the rest of D in the turned frame; the displacements follow by least squares, in which
/// the matrix is a Laplacian that is factorized once (rotation-strain coordinates: Huang, Tong, Zhou, Bao and Desbrun
/// 2011). The curve touches the straight line, and at small angles it is the straight line.
class RotationRetraction {
 public:
  explicit RotationRetraction(const tiling::PeriodicMesh& mesh);

  /// The state after `step` from `x` (coordinates as in cell_coordinates.h); the strain changes exactly by the step's.
  /// One pass over the triangles and, where they turn, one solve with two right-hand sides.
  Eigen::VectorXd retract(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const;

 private:
  /// A quadratic triangle, seen as four triangles of neighbouring nodes: those at its corners, and the middle one.
  struct Triangle {
    std::array<int, 6> node;
    Eigen::Matrix2d gradient;  ///< row k: of the barycentric coordinate of corner k + 1, 1/mm
    double area;               ///< of each of the four, mm^2
  };
  /// Part of the deformation gradient (columns of a 2 x 2 matrix, one after the other) in each of the four.
  using Gradients = Eigen::Array4d[4];
  static void add_gradients(const Triangle& triangle, const Eigen::VectorXd& x, Gradients& sum);

  CellCoordinates coordinates_;
  std::vector<Triangle> triangles_;
  numerics::ShiftedCholesky laplacian_;
};

}  // namespace supple::microscale
