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
  /// A triangle of three neighbouring nodes, four in each quadratic triangle.
  struct Piece {
    std::array<int, 3> node;
    std::array<Eigen::Vector2d, 3> gradient;  ///< of the barycentric coordinates, 1/mm
    double area;                              ///< mm^2
  };

  CellCoordinates coordinates_;
  std::vector<Piece> pieces_;
  numerics::ShiftedCholesky laplacian_;
};

}  // namespace supple::microscale
