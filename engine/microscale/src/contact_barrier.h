#pragma once

#include <limits>

#include "cell_coordinates.h"
#include "cell_term.h"
#include "contact_outline.h"
#include "contact_pairs.h"
#include "supple/microscale/material.h"
#include "supple/tiling/mesh.h"

namespace supple::microscale {

struct ContactOptions {
  /// kappa, MPa, > 0. Two faces at half their range press on each other with 1.19 kappa.
  double stiffness = 1;
  /// Distance at which contact begins, mm, > 0.
  double range = 0;
  /// Contact of a pair begins at this share of its distance at rest, if that is less than `range`; in (0, 1).
  double rest_fraction = 0.5;
};

/// The options that suit a mesh: the range is a named share of the beam width, the stiffness one of Young's modulus.
ContactOptions contact_options(const tiling::PeriodicMesh& mesh, const Material& material);

/// How near the outline comes to itself, over the pairs in reach; infinite where there is none.
struct ContactStatus {
  int pairs = 0;  ///< points and segments within their range
  /// Least distance over range.
  double smallest_ratio = std::numeric_limits<double>::infinity();
  double smallest_gap = std::numeric_limits<double>::infinity();  ///< mm
};

/// Self-contact of a periodic patch: a barrier between points and segments of the outline and all their images,
///   E = kappa sum_p l_p [ sum_s b(d_ps; r_ps) - sum_v b(d_pv; r_pv) ],
/// in MPa mm^2 per mm of thickness. p runs over the points of the outline and l_p is the rest length of outline that
/// belongs to p; s runs over the segments that do not end in p, v over the points between two such segments; d is a
/// distance, and
///   b(d; r) = -(d - r)^2 ln(d / r) / (2 r) for d < r, 0 beyond: twice continuously differentiable in d.
/// Subtracting what two segments share in their common end counts each place of the outline once, however finely it is
/// divided: along a chain of segments the bracket is b at all local minima of the distance minus b at all its local
/// maxima. It is never negative, grows beyond bounds as any distance goes to zero, and converges as the mesh is
/// refined.
///
/// r_ps = min(range, rest_fraction * d_ps at rest), r_pv is the lesser of its two segments' ranges: at rest the energy
/// and all its derivatives are exactly zero. Pairs that touch at rest are left out. Second derivatives are continuous
/// except where a point crosses the normal of a segment's end at which the outline bends.
///
/// Which pairs matter is known only along the step last given to `prepare_step`: a barrier belongs to one path and one
/// thread.
///
/// Li et al. 2020, Incremental Potential Contact; Li et al. 2023, Convergent Incremental Potential Contact.
class ContactBarrier : public CellTerm {
 public:
  /// Throws "simulation.invalid_option".
  ContactBarrier(const tiling::PeriodicMesh& mesh, const ContactOptions& options);

  /// Looks ahead along x + t step, 0 <= t <= 1, and returns the largest such t, in (0, 1], up to which no pair that
  /// comes within its range loses more than a named share of its present distance: conservative advancement along
  /// separating axes, so that nothing ever passes through. x must be free of intersections. Very far steps (hundred
  /// times the range) may be cut before anything comes near; a step that is not finite gives 0.
  ///
  /// About 25 us for 1000 points of the outline that stay near where they were when neighbours were last looked for,
  /// 0.3 ms where they are looked for anew.
  ///
  /// From then on the barrier may be evaluated for states between x and x + t step, and for those whose points lie
  /// within a hundredth of the range of them.
  double prepare_step(const Eigen::VectorXd& x, const Eigen::VectorXd& step) { return pairs_.prepare(x, step); }
  /// The same for the way between two states; bills the stage "contact search".
  double look_ahead(const CellState& from, const CellState& to, CostLedger* cost) override;
  /// Whether any pair may come within its range on the way that was prepared: if not, `add` has nothing to add.
  bool active() const override { return !pairs_.pairs().empty(); }

  std::string_view name() const override { return "contact_barrier"; }
  void add(const CellState& state, int order, numerics::EnergySum& sum) const override;
  void bill(CostLedger& cost, double seconds) const override;
  void add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const override;

  ContactStatus status(const Eigen::VectorXd& x) const;

  double stiffness() const { return options_.stiffness; }
  void set_stiffness(double stiffness) { options_.stiffness = stiffness; }
  /// What the stiffness should be once the equilibrium x was found: twice the present one where a pair is nearer than a
  /// named share of its range, the present one otherwise.
  double suggested_stiffness(const Eigen::VectorXd& x) const;

  double range() const { return options_.range; }
  /// Another range from now on, > 0, and the same stiffness: the next step must be prepared anew.
  void set_range(double range);

  /// Whether `add` adds, instead of each distance's Hessian, its positive semidefinite part.
  void set_convex(bool convex) { convex_ = convex; }

  const ContactOutline& outline() const { return pairs_.outline(); }
  /// Whether the outline crosses itself or an image at x; needs no preparation.
  bool intersects(const Eigen::VectorXd& x) const { return microscale::intersects(outline(), x); }

 private:
  template <class Sink>
  void visit(const Eigen::VectorXd& x, int order, bool convex, Sink&& sink) const;

  CellCoordinates coordinates_;
  ContactOptions options_;
  ContactPairs pairs_;
  bool convex_ = false;
};

}  // namespace supple::microscale
