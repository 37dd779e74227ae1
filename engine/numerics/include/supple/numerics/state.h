#pragma once

#include <Eigen/Core>
#include <concepts>
#include <string_view>
#include <utility>

#include "supple/base/cancellation.h"

namespace supple::numerics {

/// The state of a scene: a point of a manifold, with the frame in which tangent vectors and derivatives are written
/// there. Each room with physics has a state of its own, and only that room knows what it represents.
///
/// - dimension(): the number of coordinates of a tangent vector, which are the degrees of freedom.
/// - move(step): the retraction. It moves the state along the tangent vector `step` (vectors are added, frames turn,
///   points of a surface follow straightest geodesics). It returns the part of `step` that was travelled, in the frame
///   before the move: a boundary may stop single parts of the state.
/// - take_frame(): called once before derivatives at a state are evaluated. A state whose frame depends on the place (a
///   chart) then takes the frame of the place where it is now.
/// - transport(tangent): carries a tangent vector of the state before the last move to this one, by an isometry. It
///   returns false if no transport makes sense, as across a kink. The solver then discards what it has learned about
///   the curvature.
/// - motion: the stage to which moves are billed, or empty for none.
template <class S>
concept State = std::copyable<S> &&
    requires(S state, const S& fixed, const Eigen::VectorXd& step, Eigen::VectorXd& tangent) {
  { fixed.dimension() } -> std::convertible_to<Eigen::Index>;
  { state.move(step) } -> std::convertible_to<Eigen::VectorXd>;
  state.take_frame();
  { fixed.transport(tangent) } -> std::convertible_to<bool>;
  { S::motion } -> std::convertible_to<std::string_view>;
};

/// A state that can return along its last move. Terms that shorten a step in `look_ahead` need this.
template <class S>
concept Retractable = requires(S state, const S& from, double fraction) {
  /// Shortens the last move, which began at `from`, to this fraction of its straight path.
  state.shorten_move(from, fraction);
};

/// A state whose moves may take long, and check a token meanwhile. Its copies check the token too.
template <class S>
concept Stoppable = requires(S state, const CancellationToken& cancellation) {
  state.stop_with(cancellation);
};

/// A point of a vector space. Steps are added, and the frame is always the same.
struct VectorState {
  Eigen::VectorXd x;

  static constexpr std::string_view motion{};
  Eigen::Index dimension() const { return x.size(); }
  Eigen::VectorXd move(const Eigen::VectorXd& step) {
    x += step;
    return step;
  }
  void shorten_move(const VectorState& from, double fraction) { x = from.x + fraction * (x - from.x); }
  void take_frame() {}
  bool transport(Eigen::VectorXd& /*tangent*/) const { return true; }
};

}  // namespace supple::numerics
