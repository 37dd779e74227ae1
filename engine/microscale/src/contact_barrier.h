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
  /// kappa, MPa, > 0. The pressure between two faces at half their range is 1.19 kappa.
  double stiffness = 1;
  /// Distance at which contact begins, mm, > 0.
  double range = 0;
  /// Contact of a pair begins at this fraction of its distance at rest, if that is less than `range`; in (0, 1).
  double rest_fraction = 0.5;
};

/// The options that suit a mesh: the range in proportion to the beam width, and the stiffness to Young's modulus.
ContactOptions contact_options(const tiling::PeriodicMesh& mesh, const Material& material);

/// How near the outline comes to itself, as far as the prepared pairs tell. Minima are infinite if there are no pairs.
struct ContactStatus {
  int pairs = 0;  ///< number of pairs within their range
  /// Least ratio of a pair's distance to its range.
  double smallest_ratio = std::numeric_limits<double>::infinity();
  /// Least distance, mm.
  double smallest_gap = std::numeric_limits<double>::infinity();
};

/// Self-contact of a periodic patch: a barrier between points and segments of the outline and all their images,
///   E = kappa sum_p l_p [ sum_s b(d_ps; r_ps) - sum_v b(d_pv; r_pv) ],
/// in MPa mm^2 per mm of thickness. p runs over the points of the outline, and l_p is the rest length of outline that
/// is assigned to p. s runs over the segments that do not end in p, and v over the points between two such segments. d
/// is a distance. The function
///   b(d; r) = -(d - r)^2 ln(d / r) / (2 r) for d < r, 0 beyond
/// is twice continuously differentiable in d. Where two segments meet, the second sum subtracts what the first one
/// counts twice, so that the outline counts once however finely it is divided. Along a chain of segments, the bracket
/// is the sum of b at all local minima of the distance, minus that at all local maxima. It is never negative, grows
/// beyond bounds as any distance goes to zero, and converges as the mesh is refined.
///
/// r_ps = min(range, rest_fraction * d_ps at rest), and r_pv is the lesser of the ranges of the two segments at v. At
/// rest, the energy and all its derivatives are therefore exactly zero. Pairs that touch at rest are left out. Second
/// derivatives are continuous, except where a point crosses the normal of a segment at a corner of the outline.
///
/// The pairs are known only along the step that was last given to `prepare_step`. A barrier therefore belongs to one
/// path and one thread.
///
/// Sources: incremental potential contact [Li2020], and its variant that converges with the mesh [Li2023].
class ContactBarrier : public CellTerm {
 public:
  /// Throws "simulation.invalid_option".
  ContactBarrier(const tiling::PeriodicMesh& mesh, const ContactOptions& options);

  /// Finds the pairs for the states x + t step, 0 <= t <= 1, and returns a t in (0, 1]. Up to it, the distance of every
  /// pair that comes within its range stays at least a fifth of what it is at x. See conservative_ccd_step: no point
  /// passes through a segment. x must be free of intersections. A step on which points move by more than a hundred
  /// times the range may be shortened before anything comes near. A step that is not finite gives 0.
  ///
  /// 1000 points of the outline take about 25 us, or 0.3 ms if they have moved so far that their neighbours must be
  /// searched anew.
  ///
  /// The barrier may then be evaluated for the states between x and x + t step, and for states whose points lie within
  /// a hundredth of the range of those.
  double prepare_step(const Eigen::VectorXd& x, const Eigen::VectorXd& step) { return pairs_.prepare(x, step); }
  /// Prepares the step between two states, and bills the stage "contact search".
  double look_ahead(const CellState& from, const CellState& to, CostLedger* cost) override;
  /// Whether any pair may come within its range on the prepared step. If not, `add` adds nothing.
  bool active() const override { return !pairs_.pairs().empty(); }

  std::string_view name() const override { return "contact_barrier"; }
  void add(const CellState& state, int order, numerics::EnergySum& sum) const override;
  void bill(CostLedger& cost, double seconds) const override;
  void add_alternating_hessians(const Eigen::VectorXd& x, AlternatingEntries& entries) const override;

  ContactStatus status(const Eigen::VectorXd& x) const;

  double stiffness() const { return options_.stiffness; }
  void set_stiffness(double stiffness) { options_.stiffness = stiffness; }
  /// The stiffness that suits the equilibrium x: twice the present one if a pair is nearer than a tenth of its range,
  /// and the present one otherwise.
  double suggested_stiffness(const Eigen::VectorXd& x) const;

  double range() const { return options_.range; }
  /// Sets the range, mm, > 0. The barrier may be evaluated only after the next `prepare_step`.
  void set_range(double range);

  /// Sets whether `add` adds only the positive semidefinite part of the Hessian of each pair.
  void set_convex(bool convex) { convex_ = convex; }

  const ContactOutline& outline() const { return pairs_.outline(); }
  /// Whether the outline crosses itself or an image of itself at x. No step needs to be prepared for it.
  bool intersects(const Eigen::VectorXd& x) const { return microscale::intersects(outline(), x); }

 private:
  /// Calls sink(pair, local) for each barrier that is not zero at x, with its derivatives up to `order`.
  template <class Sink>
  void visit(const Eigen::VectorXd& x, int order, bool convex, Sink&& sink) const;

  CellCoordinates coordinates_;
  ContactOptions options_;
  ContactPairs pairs_;
  bool convex_ = false;
};

}  // namespace supple::microscale
