#include "rest_shape.h"

#include <cmath>

namespace supple::weave {
namespace {

EdgeShares shares_of(const Edge& edge, const SliderSlots& slots) {
  EdgeShares shares;
  for (int i = 0; i < slots.count(); ++i) {
    shares.from[static_cast<std::size_t>(i)] = slots.share(edge.from, i);
    shares.to[static_cast<std::size_t>(i)] = slots.share(edge.to, i);
  }
  return shares;
}

/// An edge's vector at rest, and its length and direction (an angle, whose value nobody asks for) as functions of the
/// sliders.
struct Chord {
  Eigen::Vector2d vector;
  RestJet length;
  RestJet angle;
};

/// With e = X(b) - X(a), its length l, its unit vector t and the normal n to it: l_x = t . e_x, angle_x = n . e_x / l,
/// l_xy = (n . e_x)(n . e_y) / l + t . e_xy, angle_xy = n . e_xy / l - ((t . e_x)(n . e_y) + (n . e_x)(t . e_y)) / l^2,
/// where e_xy is -X''(a), X''(b) or, for different ends, zero.
Chord chord(const RodModel& model, const Edge& edge, const EdgeShares& shares, int sliders, const Eigen::VectorXd& q,
            int order) {
  const StrandCurve& curve = model.curve(edge.strand);
  const StrandCurve::Point a = curve.at(model.coordinate(edge.from, q));
  const StrandCurve::Point b = curve.at(model.coordinate(edge.to, q));
  Chord made;
  made.vector = b.position - a.position;
  const double l = made.vector.norm();
  made.length.value = l;
  if (order < 1 || sliders == 0) return made;
  const Eigen::Vector2d t = made.vector / l;
  const Eigen::Vector2d n(-t[1], t[0]);
  // Along and across, by a slider: the rates of e, and of the two ends those at which they curve.
  std::array<double, SliderSlots::most> along{};
  std::array<double, SliderSlots::most> across{};
  const double along_a = t.dot(a.first);
  const double along_b = t.dot(b.first);
  const double across_a = n.dot(a.first);
  const double across_b = n.dot(b.first);
  const double curve_along_a = t.dot(a.second);
  const double curve_along_b = t.dot(b.second);
  const double curve_across_a = n.dot(a.second);
  const double curve_across_b = n.dot(b.second);
  std::size_t entry = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(sliders); ++i) {
    along[i] = along_b * shares.to[i] - along_a * shares.from[i];
    across[i] = across_b * shares.to[i] - across_a * shares.from[i];
    made.length.first[i] = along[i];
    made.angle.first[i] = across[i] / l;
    for (std::size_t j = 0; j <= i; ++j, ++entry) {
      const double both_a = shares.from[i] * shares.from[j];
      const double both_b = shares.to[i] * shares.to[j];
      made.length.second[entry] = across[i] * across[j] / l + curve_along_b * both_b - curve_along_a * both_a;
      made.angle.second[entry] = (curve_across_b * both_b - curve_across_a * both_a) / l -
                                 (along[i] * across[j] + across[i] * along[j]) / (l * l);
    }
  }
  return made;
}

}  // namespace

double planar_turn(const Eigen::Vector2d& e, const Eigen::Vector2d& f) {
  return 2 * (e[0] * f[1] - e[1] * f[0]) / (std::sqrt(e.squaredNorm() * f.squaredNorm()) + e.dot(f));
}

RestLength::RestLength(const RodModel& model, const Edge& edge) : edge_(&edge) {
  slots_.add(edge.from);
  slots_.add(edge.to);
  shares_ = shares_of(edge, slots_);
  if (slots_.empty()) constant_ = chord(model, edge, shares_, 0, {}, 0).length;
}

RestJet RestLength::at(const RodModel& model, const Eigen::VectorXd& q, int order) const {
  return slots_.empty() ? constant_ : chord(model, *edge_, shares_, slots_.count(), q, order).length;
}

RestTurn::RestTurn(const RodModel& model, const Turn& turn)
    : turn_(&turn), tangent_(model.curve(turn.strand).at(turn.at.start).first.normalized()) {
  const auto edge = [&](int i) -> const Edge& { return model.edges()[static_cast<std::size_t>(i)]; };
  for (const int e : {turn.in, turn.out}) {
    if (e < 0) continue;
    slots_.add(edge(e).from);
    slots_.add(edge(e).to);
  }
  if (turn.in >= 0) in_ = shares_of(edge(turn.in), slots_);
  if (turn.out >= 0) out_ = shares_of(edge(turn.out), slots_);
  if (slots_.empty()) constant_ = evaluate(model, {}, 0);
}

RestTurnValue RestTurn::evaluate(const RodModel& model, const Eigen::VectorXd& q, int order) const {
  const auto side = [&](int edge, const EdgeShares& shares) {
    if (edge < 0) return Chord{tangent_, {}, {}};
    return chord(model, model.edges()[static_cast<std::size_t>(edge)], shares, slots_.count(), q, order);
  };
  const Chord in = side(turn_->in, in_);
  const Chord out = side(turn_->out, out_);
  RestTurnValue value{0.5 * (in.length + out.length), {}};
  if (turn_->naturally_straight) return value;
  const double turn = planar_turn(in.vector, out.vector);
  value.curvature = order < 1 ? RestJet(turn) : planar_turn(turn, out.angle - in.angle);
  return value;
}

RestTurnValue RestTurn::at(const RodModel& model, const Eigen::VectorXd& q, int order) const {
  return slots_.empty() ? constant_ : evaluate(model, q, order);
}

}  // namespace supple::weave
