#pragma once

#include <optional>
#include <vector>

#include "anchor_distances.h"
#include "supple/base/execution.h"
#include "supple/numerics/objective.h"

namespace supple::surface {

/// E(p) = sum w_i g(p, x_i)^2 / (2 sum w_i) on the surface (thesis eq. 3.16, weighted), for the minimizer.
///
/// Steps are tangent vectors in tangent_frame of the state's face; they are walked by the exponential map. A step out
/// of the surface at a boundary edge slides along the edge.
///
/// What E is like. With the faces between an anchor and p unfolded, g^2 / 2 is the squared distance of two points of
/// the plane, or of a bent path whose last piece is shorter than the whole: its Hessian t t^T + (g / L) n n^T is at
/// least the identity. So every smooth piece of E is strictly convex and a point of vanishing gradient is a local
/// minimum. Where pieces meet:
/// - Across an edge, and where a path begins to bend at a saddle vertex, E is continuously differentiable.
/// - At a cut locus and at a vertex of less than 2 pi, E is the least of several smooth pieces. Such a kink is never a
///   minimum, and a piece's own Newton step decreases E at least as much as it decreases the piece.
/// - At a saddle vertex, or a boundary vertex of more than pi, E is like the tip of a cone and may have its minimum
/// there
///   whatever small changes the anchors undergo. A line search cannot end on such a tip by chance: `snap` tries it.
/// At every vertex the derivative depends on the direction; `evaluate` gives its least value and direction as the
/// gradient there (zero at a minimum) and the identity, the Hessian of a flat piece, as Hessian.
class KarcherObjective : public numerics::Objective {
 public:
  /// The weights are positive and of sum 1. `distances` outlives the objective.
  KarcherObjective(const TriangleMesh& mesh, AnchorDistances& distances, std::vector<double> weights,
                   const SurfacePoint& start, const Execution& execution);

  const SurfacePoint& point() const { return current_.point; }
  /// Moves the current state there.
  void place(const SurfacePoint& point);

  /// E at any point; the state stays.
  double value_at(const SurfacePoint& point) const;
  /// Makes sure that the current state is evaluated. Later evaluations of it cost nothing.
  void prepare() { evaluate_state(current_); }
  /// Whether the current state is a vertex where E is not differentiable.
  bool on_tip();
  /// Whether no anchor has a second, equally short path to the current state.
  bool away_from_cut_loci();

  Eigen::Index dimension() const override { return 2; }
  numerics::Evaluation evaluate(int order) override;
  double move(const Eigen::VectorXd& step) override;
  void accept() override;
  void reject() override;
  bool transport(Eigen::VectorXd& tangent) const override;
  std::optional<double> snap() override;

 private:
  struct State {
    SurfacePoint point;
    bool vertex = false;  ///< exactly at a vertex whose angle is not 2 pi
    bool evaluated = false;
    bool certain = true;  ///< away from cut loci
    bool tip = false;     ///< a vertex where directional derivatives differ from those of a smooth function
    numerics::Evaluation evaluation;
  };

  State state_at(const SurfacePoint& point) const;
  void evaluate_state(State& state) const;
  void evaluate_vertex(State& state) const;
  void evaluate_smooth(State& state) const;

  const TriangleMesh& mesh_;
  AnchorDistances& distances_;
  std::vector<double> weights_;
  const Execution& execution_;
  State current_;
  std::optional<State> trial_;
  double turn_ = 0;                           ///< transport angle of the last move
  bool slid_ = false;                         ///< the last move was bent along a boundary edge
  double reach_ = 0;                          ///< longest step that was tried since the last accepted one
  std::vector<std::int32_t> faces_tried_;     ///< where the trials since then ended
  std::vector<std::int32_t> vertices_tried_;  ///< by snap, since then
};

}  // namespace supple::surface
