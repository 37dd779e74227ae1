#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <vector>

#include "cell_coordinates.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/unknowns.h"
#include "supple/tiling/mesh.h"

namespace supple::microscale {

/// A retraction: moves a patch along a curve on which a step rotates its parts instead of stretching them.
///
/// A straight step rotates a beam by moving its end along the tangent. The beam grows longer, its energy rises steeply,
/// and steps must be short. Here, a change D of a triangle's deformation gradient F is split into a rotation and a
/// strain (rotation-strain coordinates [Huang2011]). F is rotated by the angle to which D corresponds to first order,
/// and the rest of D is added in the rotated frame. The displacements follow by least squares, whose matrix is a
/// Laplacian that is factorized once. The curve is tangent to the straight step. Steps with small angles are straight.
class RotationRetraction {
 public:
  /// Node 0 moves by its own step alone.
  explicit RotationRetraction(const tiling::PeriodicMesh& mesh);
  /// The displacements that `fixed` names move by their own steps alone; `fixed` has two entries for each node, and
  /// names at least one displacement along either axis.
  RotationRetraction(const tiling::PeriodicMesh& mesh, const std::vector<bool>& fixed);
  /// Fixes other displacements, and no longer those from before.
  void fix(const std::vector<bool>& fixed);

  /// The state after `step` from `x`, in the coordinates of cell_coordinates.h. The macroscopic strain changes exactly
  /// by that of the step. Takes one pass over the triangles and, if they rotate, one solve with two right-hand sides.
  Eigen::VectorXd retract(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const;

 private:
  /// A quadratic triangle, which is divided into four subtriangles of neighbouring nodes: three at the corners, and the
  /// middle one.
  struct Triangle {
    std::array<int, 6> node;
    Eigen::Matrix2d gradient;  ///< row k: gradient of the barycentric coordinate of corner k + 1, 1/mm
    double area;               ///< area of each subtriangle, mm^2
  };
  /// A 2 x 2 matrix for each subtriangle: component (i, j) is at [i + 2 j], one entry for each of the four.
  using Gradients = Eigen::Array4d[4];
  /// Adds the gradients of the displacements x in the four subtriangles.
  static void add_gradients(const Triangle& triangle, const Eigen::VectorXd& x, Gradients& sum);

  /// The Laplacian of the displacements along one axis that are not fixed, factorized.
  struct Component {
    numerics::Unknowns unknowns{0};
    numerics::ShiftedCholesky laplacian;
  };
  void add_triangles(const tiling::PeriodicMesh& mesh);
  void factorize(const std::vector<bool>& fixed, Component& component) const;

  CellCoordinates coordinates_;
  std::vector<Triangle> triangles_;
  bool follows_first_node_;  ///< whether no displacement is fixed, and all nodes are moved so that node 0 stays
  /// One Laplacian for both axes, if the same nodes are fixed along both; otherwise one for each axis.
  std::array<std::unique_ptr<Component>, 2> components_;
};

}  // namespace supple::microscale
