#pragma once

#include <Eigen/Core>
#include <array>

#include "jet.h"
#include "rod_model.h"
#include "scatter.h"

namespace supple::weave {

/// Rest quantities as functions of the sliders that they depend on. They are those of the polygon that the nodes'
/// material coordinates s_i inscribe in the strand's rest curve X(s): a strand that lies as this polygon does, moved
/// rigidly or slid along itself, is at rest exactly. They need X'' in their second derivatives and no more.
using RestJet = Jet<SliderSlots::most>;

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
