#pragma once

#include <Eigen/Core>
#include <array>

#include "rod_elements.h"
#include "rod_model.h"
#include "supple/numerics/jet.h"

namespace supple::weave {

using numerics::Jet;
using numerics::Vector3;

/// Rest lengths and rest curvatures as functions of the sliders on which they depend. They are those of the polygon
/// that the nodes' material coordinates s_i inscribe in the strand's rest curve X(s). A strand that has the shape of
/// this polygon, moved rigidly or slid along itself, is therefore exactly at rest. The second derivatives need X'' and
/// no higher derivative.
using RestJet = Jet<SliderSlots::max_sliders>;

/// The integrated curvature 2 tan(phi / 2) for the angle phi from e to f.
double integrated_curvature(const Eigen::Vector2d& e, const Eigen::Vector2d& f);
/// The integrated curvature as a function of the variables on which the angle depends. Its value is `curvature`.
template <int n>
Jet<n> integrated_curvature(double curvature, const Jet<n>& angle) {
  // Its derivatives by the angle are 1 + curvature^2 / 4 and curvature (1 + curvature^2 / 4) / 2.
  const double slope = 1 + 0.25 * curvature * curvature;
  return compose(angle, curvature, slope, 0.5 * curvature * slope);
}

/// Weights of an element's sliders in the material coordinates at an edge's ends.
struct EdgeWeights {
  std::array<double, SliderSlots::max_sliders> from{};
  std::array<double, SliderSlots::max_sliders> to{};
};

/// Rest length |X(to) - X(from)| of an edge, mm.
class RestLength {
 public:
  RestLength(const RodModel& model, const Edge& edge);
  const SliderSlots& slots() const { return slots_; }
  /// The value, and its derivatives up to `order`.
  RestJet at(const RodModel& model, const Eigen::VectorXd& q, int order) const;

 private:
  const Edge* edge_;
  SliderSlots slots_;
  EdgeWeights weights_;
  RestJet constant_;
};

/// Rest length over which a turn is distributed (half of the sum of its edges' rest lengths, mm), and its signed
/// integrated rest curvature 2 tan(angle / 2). The angle is that between its edges, or between its one edge and the
/// tangent of the curve at the joint.
struct RestTurnValue {
  RestJet length;
  RestJet curvature;
};
class RestTurn {
 public:
  RestTurn(const RodModel& model, const Turn& turn);
  const SliderSlots& slots() const { return slots_; }
  /// The value, and its derivatives up to `order`.
  RestTurnValue at(const RodModel& model, const Eigen::VectorXd& q, int order) const;

 private:
  RestTurnValue evaluate(const RodModel& model, const Eigen::VectorXd& q, int order) const;

  const Turn* turn_;
  SliderSlots slots_;
  EdgeWeights in_;
  EdgeWeights out_;
  Eigen::Vector2d tangent_;  ///< unit tangent of the rest curve at the turn
  RestTurnValue constant_;
};

}  // namespace supple::weave
