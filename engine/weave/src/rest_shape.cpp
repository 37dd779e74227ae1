#include "rest_shape.h"

#include <cmath>

namespace supple::weave {
namespace {

EdgeWeights weights_of(const Edge& edge, const SliderSlots& slots) {
  EdgeWeights weights;
  for (int i = 0; i < slots.count(); ++i) {
    weights.from[static_cast<std::size_t>(i)] = slots.weight(edge.from, i);
    weights.to[static_cast<std::size_t>(i)] = slots.weight(edge.to, i);
  }
  return weights;
}

/// An edge's vector at rest, and its length and direction as functions of the sliders. The direction is an angle of
/// which only the derivatives are used.
struct Chord {
  Eigen::Vector2d vector;
  RestJet length;
  RestJet angle;
};

/// Computes the chord of an edge. With e = X(b) - X(a), its length l, its unit vector t and the normal n to it,
/// l_x = t . e_x, angle_x = n . e_x / l,
/// l_xy = (n . e_x)(n . e_y) / l + t . e_xy,
/// angle_xy = n . e_xy / l - ((t . e_x)(n . e_y) + (n . e_x)(t . e_y)) / l^2,
/// where x and y are sliders. e_xy is X'' at b minus X'' at a, each times the weights of x and y at that end.
Chord chord(const RodModel& model, const Edge& edge, const EdgeWeights& weights, int sliders, const Eigen::VectorXd& q,
            int order) {
  const StrandCurve& curve = model.curve(edge.strand);
  const StrandCurve::Point a = curve.at(model.coordinate(edge.from, q));
  const StrandCurve::Point b = curve.at(model.coordinate(edge.to, q));
  Chord result;
  result.vector = b.position - a.position;
  const double l = result.vector.norm();
  result.length.value = l;
  if (order < 1 || sliders == 0) return result;
  const Eigen::Vector2d t = result.vector / l;
  const Eigen::Vector2d n(-t[1], t[0]);
  // Components along t and along n of the derivatives of e by each slider, and of X' and X'' at the two ends.
  std::array<double, SliderSlots::max_sliders> along{};
  std::array<double, SliderSlots::max_sliders> across{};
  const double along_a = t.dot(a.first);
  const double along_b = t.dot(b.first);
  const double across_a = n.dot(a.first);
  const double across_b = n.dot(b.first);
  const double second_along_a = t.dot(a.second);
  const double second_along_b = t.dot(b.second);
  const double second_across_a = n.dot(a.second);
  const double second_across_b = n.dot(b.second);
  std::size_t entry = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(sliders); ++i) {
    along[i] = along_b * weights.to[i] - along_a * weights.from[i];
    across[i] = across_b * weights.to[i] - across_a * weights.from[i];
    result.length.first[i] = along[i];
    result.angle.first[i] = across[i] / l;
    for (std::size_t j = 0; j <= i; ++j, ++entry) {
      const double product_a = weights.from[i] * weights.from[j];
      const double product_b = weights.to[i] * weights.to[j];
      result.length.second[entry] = across[i] * across[j] / l + second_along_b * product_b - second_along_a * product_a;
      result.angle.second[entry] = (second_across_b * product_b - second_across_a * product_a) / l -
                                   (along[i] * across[j] + across[i] * along[j]) / (l * l);
    }
  }
  return result;
}

}  // namespace

double integrated_curvature(const Eigen::Vector2d& e, const Eigen::Vector2d& f) {
  return 2 * (e[0] * f[1] - e[1] * f[0]) / (std::sqrt(e.squaredNorm() * f.squaredNorm()) + e.dot(f));
}

RestLength::RestLength(const RodModel& model, const Edge& edge) : edge_(&edge) {
  slots_.add(edge.from);
  slots_.add(edge.to);
  weights_ = weights_of(edge, slots_);
  if (slots_.empty()) constant_ = chord(model, edge, weights_, 0, {}, 0).length;
}

RestJet RestLength::at(const RodModel& model, const Eigen::VectorXd& q, int order) const {
  return slots_.empty() ? constant_ : chord(model, *edge_, weights_, slots_.count(), q, order).length;
}

RestTurn::RestTurn(const RodModel& model, const Turn& turn)
    : turn_(&turn), tangent_(model.curve(turn.strand).at(turn.at.start).first.normalized()) {
  const auto edge = [&](int i) -> const Edge& { return model.edges()[static_cast<std::size_t>(i)]; };
  for (const int e : {turn.in, turn.out}) {
    if (e < 0) continue;
    slots_.add(edge(e).from);
    slots_.add(edge(e).to);
  }
  if (turn.in >= 0) in_ = weights_of(edge(turn.in), slots_);
  if (turn.out >= 0) out_ = weights_of(edge(turn.out), slots_);
  if (slots_.empty()) constant_ = evaluate(model, {}, 0);
}

RestTurnValue RestTurn::evaluate(const RodModel& model, const Eigen::VectorXd& q, int order) const {
  const auto side = [&](int edge, const EdgeWeights& weights) {
    if (edge < 0) return Chord{tangent_, {}, {}};
    return chord(model, model.edges()[static_cast<std::size_t>(edge)], weights, slots_.count(), q, order);
  };
  const Chord in = side(turn_->in, in_);
  const Chord out = side(turn_->out, out_);
  RestTurnValue value{0.5 * (in.length + out.length), {}};
  if (turn_->naturally_straight) return value;
  const double curvature = integrated_curvature(in.vector, out.vector);
  value.curvature = order < 1 ? RestJet(curvature) : integrated_curvature(curvature, out.angle - in.angle);
  return value;
}

RestTurnValue RestTurn::at(const RodModel& model, const Eigen::VectorXd& q, int order) const {
  return slots_.empty() ? constant_ : evaluate(model, q, order);
}

}  // namespace supple::weave
