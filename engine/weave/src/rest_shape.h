#pragma once

#include <Eigen/Core>
#include <array>

#include "rod_elements.h"
#include "rod_model.h"
#include "supple/numerics/jet.h"

namespace supple::weave {

using numerics::Jet;
using numerics::Vector3;

/// Rest quantities as functions of the sliders that they depend on. They are those of the polygon that the nodes'
/// material coordinates s_i inscribe in the strand's rest curve X(s): a strand that lies as this polygon does, moved
/// rigidly or slid along itself, is at rest exactly. They need X'' in their second derivatives and no more.
using RestJet = Jet<SliderSlots::most>;

/// 2 tan(phi / 2) for the angle phi from e to f.
double planar_turn(const Eigen::Vector2d& e, const Eigen::Vector2d& f);
/// The turn of that value as a function of what the angle depends on.
template <int n>
Jet<n> planar_turn(double turn, const Jet<n>& angle) {
  // Its derivatives by the angle are 1 + turn^2 / 4 and turn (1 + turn^2 / 4) / 2.
  const double slope = 1 + 0.25 * turn * turn;
  return compose(angle, turn, slope, 0.5 * turn * slope);
}

/// How the material coordinates at an edge's ends follow the sliders of an element.
struct EdgeShares {
  std::array<double, SliderSlots::most> from{};
  std::array<double, SliderSlots::most> to{};
};

/// |X(to) - X(from)|, mm.
class RestLength {
 public:
  RestLength(const RodModel& model, const Edge& edge);
  const SliderSlots& slots() const { return slots_; }
  /// Derivatives up to `order`.
  RestJet at(const RodModel& model, const Eigen::VectorXd& q, int order) const;

 private:
  const Edge* edge_;
  SliderSlots slots_;
  EdgeShares shares_;
  RestJet constant_;
};

/// Length over which a turn is spread (half of each of its edges', mm) and signed turn 2 tan(angle / 2) between its
/// edges, or between its one edge and the curve's tangent where the joint holds it.
struct RestTurnValue {
  RestJet length;
  RestJet curvature;
};
class RestTurn {
 public:
  RestTurn(const RodModel& model, const Turn& turn);
  const SliderSlots& slots() const { return slots_; }
  /// Derivatives up to `order`.
  RestTurnValue at(const RodModel& model, const Eigen::VectorXd& q, int order) const;

 private:
  RestTurnValue evaluate(const RodModel& model, const Eigen::VectorXd& q, int order) const;

  const Turn* turn_;
  SliderSlots slots_;
  EdgeShares in_;
  EdgeShares out_;
  Eigen::Vector2d tangent_;  ///< of the curve at the turn
  RestTurnValue constant_;
};

}  // namespace supple::weave
