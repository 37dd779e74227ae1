#pragma once

#include <vector>

#include "cell_coordinates.h"
#include "cell_term.h"
#include "material_law.h"
#include "supple/base/lanes.h"
#include "supple/tiling/mesh.h"

namespace supple::microscale {

/// Elastic energy of the solid, in MPa mm^2 per mm of thickness. Triangles are quadratic with straight sides at rest.
/// Each has three integration points, which integrate the stiffness at rest exactly.
///
/// The deformation gradient at a point is F + sum_k w_k (x) grad N_k. One evaluation of order 2 costs about 0.5 us per
/// triangle.
class ElasticEnergy : public CellTerm {
 public:
  ElasticEnergy(const tiling::PeriodicMesh& mesh, const Material& material);

  std::string_view name() const override;
  void add(const CellState& state, int order, numerics::EnergySum& sum) const override;
  void add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const override;
  /// Fraction of `step` that may be taken from x: max_inversion_fraction of the one at which det F first vanishes at an
  /// integration point. It may exceed 1, and is infinite if that is well beyond the step.
  double largest_inversion_free_step(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const;
  double look_ahead(const CellState& from, const CellState& to, CostLedger* cost) override;
  void bill(CostLedger& cost, double seconds) const override { cost.add_stage("assembly", seconds); }

  /// The size of the forces that balance each other in an equilibrium, MPa mm: (sum over triangles of |nodal forces of
  /// the triangle|^2)^(1/2) at x. The forces of a strain of 1e-6 are added, so that the scale is positive at rest too.
  double force_scale(const Eigen::VectorXd& x) const;
  /// The norm of the gradient's rounding errors, MPa mm.
  double force_rounding() const;

  /// The least det F over all triangles and all their points (det F is quadratic over a triangle).
  double smallest_jacobian(const Eigen::VectorXd& x) const;

 private:
  /// Triangles that are evaluated together, one in each lane of a vector.
  struct Batch {
    double gradient[3][2][lanes];  ///< gradients of the barycentric coordinates, 1/mm
    double area[lanes];            ///< mm^2; 0 in lanes that pad the last batch
    int node[6][lanes];
    tiling::LatticeShift shift[6][lanes];
    bool distinct[lanes];  ///< whether no node occurs twice among the six
  };
  struct Kernel;

  CellCoordinates coordinates_;
  MaterialLaw law_;
  double unit_forces_ = 0;  ///< the sum of `force_scale` for a stress of Young's modulus in each triangle, MPa mm
  std::vector<Batch> batches_;
};

}  // namespace supple::microscale
