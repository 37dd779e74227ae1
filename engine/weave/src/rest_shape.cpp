#include "rest_shape.h"

namespace supple::weave {
namespace {

using RestVector = Vector2<RestJet>;

RestVector position(const RodModel& model, int strand, const MaterialCoordinate& c, const SliderSlots& slots,
                    const Eigen::VectorXd& q) {
  const StrandCurve::Point p = model.curve(strand).at(model.coordinate(c, q));
  RestJet s(0);
  for (int i = 0; i < slots.count(); ++i) s.first[static_cast<std::size_t>(i)] = slots.share(c, i);
  return {compose(s, p.position[0], p.first[0], p.second[0]), compose(s, p.position[1], p.first[1], p.second[1])};
}

RestVector chord(const RodModel& model, const Edge& edge, const SliderSlots& slots, const Eigen::VectorXd& q) {
  const RestVector head = position(model, edge.strand, edge.to, slots, q);
  const RestVector tail = position(model, edge.strand, edge.from, slots, q);
  return {head.x - tail.x, head.y - tail.y};
}

RestVector tangent(const RodModel& model, const Turn& turn) {
  const Eigen::Vector2d t = model.curve(turn.strand).at(turn.at.start).first.normalized();
  return {RestJet(t[0]), RestJet(t[1])};
}

RestTurnValue evaluate(const RodModel& model, const Turn& turn, const SliderSlots& slots, const Eigen::VectorXd& q) {
  const auto edge = [&](int i) -> const Edge& { return model.edges()[static_cast<std::size_t>(i)]; };
  const RestVector before = turn.in >= 0 ? chord(model, edge(turn.in), slots, q) : tangent(model, turn);
  const RestVector after = turn.out >= 0 ? chord(model, edge(turn.out), slots, q) : tangent(model, turn);
  const RestJet a = norm(before);
  const RestJet b = norm(after);
  RestTurnValue value;
  if (turn.in >= 0) value.length = 0.5 * a;
  if (turn.out >= 0) value.length = value.length + 0.5 * b;
  if (turn.naturally_straight) return value;
  value.curvature = 2 * cross(before, after) * inverse(a * b + dot(before, after));
  return value;
}

}  // namespace

RestLength::RestLength(const RodModel& model, const Edge& edge) : edge_(&edge) {
  slots_.add(edge.from);
  slots_.add(edge.to);
  if (slots_.empty()) {
    const RestVector c = chord(model, edge, slots_, {});
    constant_ = norm(c);
  }
}

RestJet RestLength::at(const RodModel& model, const Eigen::VectorXd& q) const {
  if (slots_.empty()) return constant_;
  return norm(chord(model, *edge_, slots_, q));
}

RestTurn::RestTurn(const RodModel& model, const Turn& turn) : turn_(&turn) {
  for (const int e : {turn.in, turn.out}) {
    if (e < 0) continue;
    slots_.add(model.edges()[static_cast<std::size_t>(e)].from);
    slots_.add(model.edges()[static_cast<std::size_t>(e)].to);
  }
  if (slots_.empty()) constant_ = evaluate(model, turn, slots_, {});
}

RestTurnValue RestTurn::at(const RodModel& model, const Eigen::VectorXd& q) const {
  return slots_.empty() ? constant_ : evaluate(model, *turn_, slots_, q);
}

}  // namespace supple::weave
