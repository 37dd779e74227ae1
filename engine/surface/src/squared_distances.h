#pragma once

#include <string_view>
#include <vector>

#include "anchor_distances.h"
#include "karcher_state.h"
#include "supple/numerics/system.h"

namespace supple::surface {

/// E(p) = sum w_i g(p, x_i)^2 / (2 sum w_i) on the surface, weighted [Thesis, eq. 3.16].
///
/// If the faces between an anchor and p are unfolded, g is the distance of two points in the plane, or the length of a
/// path that bends and whose last straight piece has length L. The Hessian of g^2 / 2 is t t^T + (g / L) n n^T, which
/// is at least the identity. So every smooth piece of E is strictly convex, and a point of vanishing gradient is a
/// local minimum. Pieces meet as follows:
/// - Across an edge, and where a path begins to bend at a saddle vertex, E is continuously differentiable.
/// - At a cut locus, and at a vertex with an angle below 2 pi, E is the minimum of several smooth pieces. Such a kink
///   is never a minimum. The Newton step of one piece decreases E at least as much as it decreases the piece.
/// - At a saddle vertex, or a boundary vertex with an angle above pi, E is shaped like the tip of a cone. Its minimum
///   may lie there, also after small changes of the anchors. A line search does not end at a tip by chance; see
///   KarcherVertexSearch.
/// At every vertex the derivative depends on the direction. There `add` uses as gradient the steepest descent direction
/// times its slope (zero at a minimum), and as Hessian the identity, which is the Hessian of a flat piece.
class SquaredDistances : public numerics::Term<KarcherState> {
 public:
  /// The weights are positive and have the sum 1. `mesh` and `distances` must outlive the term.
  SquaredDistances(const TriangleMesh& mesh, AnchorDistances& distances, std::vector<double> weights);

  std::string_view name() const override { return "squared_distances"; }
  void prepare(KarcherState& state, int order, const Execution& execution) override;
  void add(const KarcherState& state, int order, numerics::EnergySum& sum) const override;
  void bill(CostLedger& cost, double seconds) const override { cost.add_stage("derivatives", seconds); }

  /// E at any point. Takes one evaluation of all distances.
  double value_at(const SurfacePoint& point, const Execution& execution) const;

 private:
  double value_of(const std::vector<AnchorGeodesic>& geodesics) const;
  void add_on_tip(const KarcherState& state, numerics::EnergySum& sum) const;

  const TriangleMesh& mesh_;
  AnchorDistances& distances_;
  std::vector<double> weights_;
};

/// Whether E is not differentiable at the state because it is at a tip and an anchor is elsewhere. Needs the geodesics.
bool is_at_kink(const KarcherState& state);
/// Whether the shortest path to each anchor is certainly unique. Needs the geodesics.
bool away_from_cut_loci(const KarcherState& state);

}  // namespace supple::surface
