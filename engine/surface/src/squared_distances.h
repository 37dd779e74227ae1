#pragma once

#include <string_view>
#include <vector>

#include "anchor_distances.h"
#include "karcher_state.h"
#include "supple/numerics/system.h"

namespace supple::surface {

/// E(p) = sum w_i g(p, x_i)^2 / (2 sum w_i) on the surface (thesis eq. 3.16, weighted).
///
/// What E is like. With the faces between an anchor and p unfolded, g^2 / 2 is the squared distance of two points of
/// the plane, or of a bent path whose last piece is shorter than the whole: its Hessian t t^T + (g / L) n n^T is at
/// least the identity. So every smooth piece of E is strictly convex and a point of vanishing gradient is a local
/// minimum. Where pieces meet:
/// - Across an edge, and where a path begins to bend at a saddle vertex, E is continuously differentiable.
/// - At a cut locus and at a vertex of less than 2 pi, E is the least of several smooth pieces. Such a kink is never a
///   minimum, and a piece's own Newton step decreases E at least as much as it decreases the piece.
/// - At a saddle vertex, or a boundary vertex of more than pi, E is like the tip of a cone and may have its minimum
///   there whatever small changes the anchors undergo. A line search cannot end on such a tip by chance: it is a kink
///   that is tried by itself.
/// At every vertex the derivative depends on the direction; `add` gives its least value and direction as the gradient
/// there (zero at a minimum) and the identity, the Hessian of a flat piece, as Hessian.
class SquaredDistances : public numerics::Term<KarcherState> {
 public:
  /// The weights are positive and of sum 1. `mesh` and `distances` outlive the term.
  SquaredDistances(const TriangleMesh& mesh, AnchorDistances& distances, std::vector<double> weights);

  std::string_view name() const override { return "squared_distances"; }
  void prepare(KarcherState& state, int order, const Execution& execution) override;
  void add(const KarcherState& state, int order, numerics::EnergySum& sum) const override;
  bool has_kinks() const override { return true; }
  std::vector<Kink> kinks(const KarcherState& current, const std::vector<KarcherState>& tried,
                          double reach) const override;
  void bill(CostLedger& cost, double seconds) const override { cost.add_stage("derivatives", seconds); }

  /// E at any point; one evaluation of all distances.
  double value_at(const SurfacePoint& point, const Execution& execution) const;

 private:
  double value_of(const std::vector<AnchorGeodesic>& found) const;
  void add_on_tip(const KarcherState& state, numerics::EnergySum& sum) const;

  const TriangleMesh& mesh_;
  AnchorDistances& distances_;
  std::vector<double> weights_;
};

/// Whether E is not differentiable at a state of which the distances are found: on a tip with an anchor elsewhere.
bool kinked(const KarcherState& state);
/// Whether no anchor has a second, equally short path to a state of which the distances are found.
bool away_from_cut_loci(const KarcherState& state);

}  // namespace supple::surface
