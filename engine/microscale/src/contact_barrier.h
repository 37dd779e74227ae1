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
  double rest_fraction = 0.6;
};

/// The options that suit a mesh: range a twentieth of the beam width, stiffness a named share of Young's modulus.
ContactOptions contact_options(const tiling::PeriodicMesh& mesh, const Material& material);

/// How near the outline comes to itself, over the pairs in reach; infinite where none is.
struct ContactStatus {
  int pairs = 0;  ///< points and segments within their range
  /// Least distance over range of all pairs in reach.
  double smallest_ratio = std::numeric_limits<double>::infinity();
  double smallest_gap = std::numeric_limits<double>::infinity();  ///< mm
};

/// Self-contact of a periodic patch: a barrier between points and segments of the outline and all their images,
///   E = kappa sum_p l_p [ sum_s b(d_ps; r_ps) - sum_v b(d_pv; r_pv) ],
/// in MPa mm^2 per mm of thickness. p runs over the points of the outline, l_p is the outline's rest length that
/// belongs to p, s over the segments that do not end in p, v over the points between two such segments; d is the
/// distance, and
///   b(d; r) = -(d - r)^2 ln(d / r) / (2 r) for d < r, 0 beyond: twice continuously differentiable in d.
/// A straight chain of segments counts once however finely it is divided, since what several segments share in a
/// common end is subtracted there; so the energy converges as the mesh is refined. It stays at least b(d; r) of the
/// nearest segment.
///
/// r_ps = min(range, rest_fraction * d_ps at rest), r_pv the lesser of its two segments' ranges: at rest the energy and
/// all its derivatives are exactly zero. Pairs that touch at rest are left out. The energy has continuous second
/// derivatives except where a point crosses the normal of a segment's end (and the outline bends there).
///
/// Which pairs matter is known only along the step last given to `prepare`: a barrier belongs to one path and one
/// thread.
///
/// Li et al. 2020, Incremental Potential Contact; Li et al. 2023, Convergent Incremental Potential Contact.
class ContactBarrier : public CellTerm {
 public:
  /// Throws "simulation.invalid_option".
  ContactBarrier(const tiling::PeriodicMesh& mesh, const ContactOptions& options);

  /// Looks ahead along x + t step, 0 <= t <= 1, and returns the largest such t, in (0, 1], up to which no pair that
  /// comes within its range loses more than a named share of its present distance: conservative advancement with
  /// separating axes, so that nothing passes through. x must be free of intersections. Far steps (many times the
  /// range) may be cut before anything touches; 0 where the step is not finite.
  ///
  /// From then on the barrier may be evaluated for states between x and x + t step, and for those whose points lie
  /// within a hundredth of the range of them.
  double prepare(const Eigen::VectorXd& x, const Eigen::VectorXd& step);
  /// Whether any pair comes within its range on the way that was prepared: if not, `add` has nothing to add.
  bool near() const { return !pairs_.pairs().empty(); }

  std::string_view name() const override { return "contact_barrier"; }
  void add(const Eigen::VectorXd& x, int order, numerics::EnergySum& sum) const override;
  void add_alternating_hessian(const Eigen::VectorXd& x, Alternation alternation,
                               numerics::HessianEntries& entries) const override;

  ContactStatus status(const Eigen::VectorXd& x) const;

  double stiffness() const { return options_.stiffness; }
  void set_stiffness(double stiffness) { options_.stiffness = stiffness; }
  /// What the stiffness should be after the equilibrium x was found: twice the present one where a pair is nearer than
  /// a named share of its range, the present one otherwise.
  double suggested_stiffness(const Eigen::VectorXd& x) const;

  /// Whether `add` adds, instead of each pair's Hessian, its positive semidefinite part.
  void set_convex(bool convex) { convex_ = convex; }

  const ContactOutline& outline() const { return pairs_.outline(); }
  /// Whether the outline crosses itself or an image at x; needs no preparation.
  bool intersects(const Eigen::VectorXd& x) const { return microscale::intersects(outline(), x); }

 private:
  template <class Sink>
  void visit(const Eigen::VectorXd& x, int order, Sink&& sink) const;

  CellCoordinates coordinates_;
  ContactOptions options_;
  ContactPairs pairs_;
  bool convex_ = false;
};

}  // namespace supple::microscale
