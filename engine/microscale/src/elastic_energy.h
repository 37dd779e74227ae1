#pragma once

#include <vector>

#include "cell_coordinates.h"
#include "cell_term.h"
#include "material_law.h"
#include "supple/base/lanes.h"
#include "supple/tiling/mesh.h"

namespace supple::microscale {

/// Elastic energy of the solid: quadratic triangles with straight sides at rest, three integration points each (exact
/// for the stiffness at rest). MPa mm^2 per mm of thickness.
///
/// The deformation gradient at a point is F + sum_k w_k (x) grad N_k. One evaluation of order 2 costs about 0.5 us per
/// triangle.
class ElasticEnergy : public CellTerm {
 public:
  ElasticEnergy(const tiling::PeriodicMesh& mesh, const Material& material);

  std::string_view name() const override;
  void add(const CellState& state, int order, numerics::EnergySum& sum) const override;
  void add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const override;
  /// A named share of the way to the first integration point where det F = 0; infinite if that lies well
  /// beyond the step.
  double largest_inversion_free_step(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const;
  double look_ahead(const CellState& from, const CellState& to, CostLedger* cost) override;
  /// As the stage "assembly": every scene has it.
  void bill(CostLedger& cost, double seconds) const override { cost.add_stage("assembly", seconds); }

  /// (sum over triangles of |nodal forces of the triangle|^2)^(1/2) at x, MPa mm: what the forces that balance in an
  /// equilibrium amount to; plus those of a strain of 1e-6, so that a patch without stress has a scale too.
  double force_scale(const Eigen::VectorXd& x) const;
  /// The least norm of the gradient that can be told from rounding errors, MPa mm.
  double force_rounding() const;

  /// The least det F over all triangles and all their points (det F is quadratic over a triangle).
  double smallest_jacobian(const Eigen::VectorXd& x) const;

 private:
  /// Triangles that are evaluated together, one in each lane of a vector.
  struct Batch {
    double gradient[3][2][lanes];  ///< of the barycentric coordinates, 1/mm
    double area[lanes];            ///< mm^2; 0 in lanes that pad the last batch
    int node[6][lanes];
    tiling::LatticeShift shift[6][lanes];
    bool distinct[lanes];  ///< whether the six nodes are six
  };
  struct Kernel;

  CellCoordinates coordinates_;
  MaterialLaw law_;
  double unit_forces_ = 0;  ///< of a stress of Young's modulus, summed like those of `force_scale`
  std::vector<Batch> batches_;
};

}  // namespace supple::microscale
