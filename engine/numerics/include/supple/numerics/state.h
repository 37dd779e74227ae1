#pragma once

#include <Eigen/Core>
#include <concepts>
#include <string_view>
#include <utility>

#include "supple/base/cancellation.h"

namespace supple::numerics {

/// The unknowns of a scene: a point of a manifold, with the frame in which tangent vectors and derivatives are written
/// there. Each room with physics has a state of its own, and only that room knows what it stands for.
///
/// - dimension(): the number of coordinates of a tangent vector, which are the degrees of freedom.
/// - move(step): the retraction. Moves the state along the tangent vector `step` (vectors add, frames turn, points of a
///   surface walk straightest paths) and returns the part of `step` that was travelled, in the frame before: each part
///   of the state stops by itself where something, a boundary, stops it.
/// - take_frame(): called once before derivatives at a state are asked for; a state whose frame goes stale (a chart)
///   chooses the one of the place where it is now.
/// - transport(tangent): carries a tangent vector of the state before the last move to this one, by an isometry. False
///   where no transport makes sense (across a kink): what was learned of the curvature is then forgotten.
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

/// A state that can go back on the way of its last move. Terms that look ahead and shorten the way need this.
template <class S>
concept Retractable = requires(S state, const S& from, double share) {
  /// Moves to the point at this share of the straight way from `from`.
  state.go_back(from, share);
};

/// A state whose moves may take long, and look at a token on their way. Copies look at it too.
template <class S>
concept Stoppable = requires(S state, const CancellationToken& cancellation) {
  state.stop_with(cancellation);
};

/// A point of a vector space: steps are added, and the frame is always the same.
struct VectorState {
  Eigen::VectorXd x;

  static constexpr std::string_view motion{};
  Eigen::Index dimension() const { return x.size(); }
  Eigen::VectorXd move(const Eigen::VectorXd& step) {
    x += step;
    return step;
  }
  void go_back(const VectorState& from, double share) { x = from.x + share * (x - from.x); }
  void take_frame() {}
  bool transport(Eigen::VectorXd& /*tangent*/) const { return true; }
};

}  // namespace supple::numerics
