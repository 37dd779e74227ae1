#include "rod_model.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace supple::weave {
namespace {

/// Places of a strand this close to each other, relative to its length, are the same node.
constexpr double node_tolerance = 1e-7;

/// A place on a strand that must be a node: a crossing, an anchor or an end.
struct RequiredNode {
  double coordinate = 0;
  int node = -1;
  Eigen::Vector2i shift{0, 0};  ///< lattice offset of the copy of the node that the strand's own copy meets
  int slider = -1;
  int joint = -1;
  bool end = false;       ///< whether it exists only because the strand ends there
  double half_width = 0;  ///< radius of the widest strand that crosses there, mm
};

double turn_between(const StrandCurve& curve, double from, double to) {
  if (curve.straight()) return 0;
  // The turning angle is the integral of the curvature. A sum over a fixed number of points is accurate enough to
  // choose a number of segments.
  constexpr int points = 16;
  double sum = 0;
  for (int i = 0; i < points; ++i) sum += curve.at(from + (to - from) * (i + 0.5) / points).second.norm();
  return sum / points * (to - from);
}

MaterialCoordinate coordinate_of(const RequiredNode& required, double offset = 0) {
  MaterialCoordinate c;
  c.start = required.coordinate + offset;
  if (required.slider >= 0) {
    c.slider[0] = required.slider;
    c.weight[0] = 1;
  }
  return c;
}

MaterialCoordinate between(const MaterialCoordinate& a, const MaterialCoordinate& b, double t) {
  MaterialCoordinate c;
  c.start = (1 - t) * a.start + t * b.start;
  c.slider = {a.slider[0], b.slider[0]};
  c.weight = {(1 - t) * a.weight[0], t * b.weight[0]};
  return c;
}

}  // namespace

class ModelBuilder {
 public:
  ModelBuilder(RodModel& model, const std::vector<Anchor>& anchors)
      : model_(model), weave_(model.weave()), anchors_(anchors), required_nodes_(weave_.strands.size()) {}

  void build() {
    add_crossings();
    add_anchors();
    for (int s = 0; s < static_cast<int>(weave_.strands.size()); ++s) add_strand(s);
    number_unknowns();
  }

 private:
  int new_node(const Eigen::Vector2d& at) {
    model_.nodes_.push_back(at);
    return static_cast<int>(model_.nodes_.size()) - 1;
  }

  void add_crossings() {
    for (int c = 0; c < static_cast<int>(weave_.crossings.size()); ++c) {
      model_.check_for_stop();
      const auto& members = weave_.crossings[static_cast<std::size_t>(c)].members;
      const int node = new_node(rest_position(weave_, members.front()));
      const auto fused = std::count_if(members.begin(), members.end(), [](const auto& m) { return !m.slides; });
      const int joint = fused >= 2 ? model_.joints_++ : -1;
      model_.crossing_node_.push_back(node);
      model_.crossing_joint_.push_back(joint);
      for (int m = 0; m < static_cast<int>(members.size()); ++m) {
        const CrossingMember& member = members[static_cast<std::size_t>(m)];
        RequiredNode required{member.coordinate, node, -member.shift, -1, member.slides ? -1 : joint};
        for (const CrossingMember& other : members)
          if (&other != &member)
            required.half_width =
                std::max(required.half_width, weave_.strands[static_cast<std::size_t>(other.strand)].radius);
        if (member.slides) {
          required.slider = static_cast<int>(model_.sliders_.size());
          model_.sliders_.push_back({c, m, member.strand, member.coordinate, -member.backward, member.forward});
        }
        required_nodes_[static_cast<std::size_t>(member.strand)].push_back(required);
      }
    }
  }

  void add_anchors() {
    for (const Anchor& anchor : anchors_) {
      model_.check_for_stop();
      auto& required_nodes = required_nodes_[static_cast<std::size_t>(anchor.strand)];
      const StrandCurve& curve = model_.curve(anchor.strand);
      const double length = curve.length();
      const bool open = curve.ends() == Ends::open;
      // On a strand without ends, the last coordinate is the same node as the first one.
      const auto near = std::find_if(required_nodes.begin(), required_nodes.end(), [&](const RequiredNode& k) {
        const double apart = std::abs(k.coordinate - anchor.coordinate);
        return (open ? apart : std::min(apart, length - apart)) <= node_tolerance * length;
      });
      if (near == required_nodes.end()) {
        const bool end = open && (anchor.coordinate <= node_tolerance * length ||
                                  anchor.coordinate >= (1 - node_tolerance) * length);
        const double coordinate = open || anchor.coordinate < length ? anchor.coordinate : 0;
        required_nodes.push_back(
            RequiredNode{.coordinate = coordinate, .node = new_node(curve.at(coordinate).position), .end = end});
        if (anchor.clamped) required_nodes.back().joint = model_.joints_++;
        model_.anchor_node_.push_back(required_nodes.back().node);
        model_.anchor_joint_.push_back(required_nodes.back().joint);
      } else {
        if (anchor.clamped && near->joint < 0 && near->slider < 0) near->joint = model_.joints_++;
        model_.anchor_node_.push_back(near->node);
        model_.anchor_joint_.push_back(near->joint);
      }
    }
  }

  void add_strand(int strand) {
    auto& required_nodes = required_nodes_[static_cast<std::size_t>(strand)];
    const StrandCurve& curve = model_.curve(strand);
    std::sort(required_nodes.begin(), required_nodes.end(),
              [](const RequiredNode& a, const RequiredNode& b) { return a.coordinate < b.coordinate; });
    const double near = node_tolerance * curve.length();
    if (curve.ends() == Ends::open) {
      if (required_nodes.empty() || required_nodes.front().coordinate > near)
        required_nodes.insert(required_nodes.begin(),
                              RequiredNode{.coordinate = 0, .node = new_node(curve.at(0).position), .end = true});
      if (required_nodes.back().coordinate < curve.length() - near)
        required_nodes.push_back(RequiredNode{
            .coordinate = curve.length(), .node = new_node(curve.at(curve.length()).position), .end = true});
    } else if (required_nodes.empty()) {
      required_nodes.push_back(RequiredNode{.coordinate = 0, .node = new_node(curve.at(0).position)});
    }
    add_edges(strand, required_nodes);
  }

  /// Adds edges between the required nodes, turns at all nodes where two edges meet, and gaps where something slides.
  void add_edges(int strand, const std::vector<RequiredNode>& required_nodes) {
    const StrandCurve& curve = model_.curve(strand);
    const bool loop = curve.ends() != Ends::open;
    const std::size_t intervals = required_nodes.size() - (loop ? 0 : 1);
    const auto first_edge = static_cast<int>(model_.edges_.size());
    bool jointed = false;
    for (std::size_t i = 0; i < intervals; ++i) {
      const RequiredNode& from = required_nodes[i];
      const bool wraps = i + 1 == required_nodes.size();
      RequiredNode to = required_nodes[(i + 1) % required_nodes.size()];
      if (wraps) to.shift += cells_of_translation(curve.translation());
      const double offset = wraps ? curve.length() : 0;
      add_interval(strand, from, to, offset, loop && intervals == 1 ? 3 : 1);
      jointed = jointed || from.joint >= 0 || to.joint >= 0;
    }
    const auto last_edge = static_cast<int>(model_.edges_.size()) - 1;
    if (loop) {
      add_turns_at(strand, last_edge, first_edge, required_nodes.front());
    } else {
      if (required_nodes.front().joint >= 0) add_turns_at(strand, -1, first_edge, required_nodes.front());
      if (required_nodes.back().joint >= 0) add_turns_at(strand, last_edge, -1, required_nodes.back());
    }
    if (!jointed && curve.straight()) model_.spinning_.push_back(first_edge);
  }

  void add_interval(int strand, const RequiredNode& from, const RequiredNode& to, double offset, int min_segments) {
    model_.check_for_stop();
    const StrandCurve& curve = model_.curve(strand);
    const MaterialCoordinate begin = coordinate_of(from);
    const MaterialCoordinate end = coordinate_of(to, offset);
    const double turn = turn_between(curve, begin.start, end.start);
    const int count = std::max(
        {min_segments, model_.options_.segments, static_cast<int>(std::ceil(turn / model_.options_.max_segment_turn))});
    if (from.slider >= 0 || to.slider >= 0)
      model_.gaps_.push_back({strand, begin, end, from.end || to.end, from.half_width + to.half_width});
    int tail = from.node;
    Eigen::Vector2i tail_shift = from.shift;
    MaterialCoordinate at = begin;
    for (int k = 0; k < count; ++k) {
      const bool last = k + 1 == count;
      const MaterialCoordinate next = last ? end : between(begin, end, static_cast<double>(k + 1) / count);
      // Nodes between two required nodes belong to the strand's own copy.
      const int head = last ? to.node : new_node(curve.at(next.start).position);
      const Eigen::Vector2i head_shift = last ? to.shift : Eigen::Vector2i::Zero();
      model_.edges_.push_back({strand, tail, head, head_shift - tail_shift, at, next});
      const auto edge = static_cast<int>(model_.edges_.size()) - 1;
      if (k > 0) {
        model_.turns_.push_back({strand, edge - 1, edge, -1, at});
      } else if (edge > 0 && model_.edges_[static_cast<std::size_t>(edge - 1)].strand == strand) {
        add_turns_at(strand, edge - 1, edge, from);
      }
      tail = head;
      tail_shift = head_shift;
      at = next;
    }
  }

  void add_turns_at(int strand, int in, int out, const RequiredNode& required) {
    const MaterialCoordinate at = coordinate_of(required);
    if (required.joint < 0) {
      model_.turns_.push_back({strand, in, out, -1, at});
      return;
    }
    if (in >= 0) model_.turns_.push_back({strand, in, -1, required.joint, at});
    if (out >= 0) model_.turns_.push_back({strand, -1, out, required.joint, at});
  }

  Eigen::Vector2i cells_of_translation(const Eigen::Vector2d& translation) const {
    if (translation.isZero()) return Eigen::Vector2i::Zero();
    const Eigen::Matrix2d& lattice = *weave_.lattice;
    const double determinant = lattice(0, 0) * lattice(1, 1) - lattice(0, 1) * lattice(1, 0);
    return {
        static_cast<int>(std::lround((translation[0] * lattice(1, 1) - translation[1] * lattice(0, 1)) / determinant)),
        static_cast<int>(std::lround((translation[1] * lattice(0, 0) - translation[0] * lattice(1, 0)) / determinant))};
  }

  void number_unknowns() {
    int next = static_cast<int>(model_.nodes_.size()) * model_.dimension();
    model_.first_slider_ = next;
    next += static_cast<int>(model_.sliders_.size());
    model_.first_angle_ = next;
    if (model_.spatial()) next += static_cast<int>(model_.edges_.size());
    model_.first_joint_ = next;
    next += model_.joints_ * (model_.spatial() ? 3 : 1);
    model_.strain_ = next;
    if (weave_.lattice) next += 4;
    model_.size_ = next;
  }

  RodModel& model_;
  const Weave& weave_;
  const std::vector<Anchor>& anchors_;
  std::vector<std::vector<RequiredNode>> required_nodes_;
};

RodModel::RodModel(const Weave& weave, const std::vector<Anchor>& anchors, const ModelOptions& options)
    : weave_(&weave), options_(options) {
  stiffness_.reserve(weave.strands.size());
  for (const Strand& strand : weave.strands) stiffness_.push_back(circular(strand.radius, weave.material));
  const Eigen::Vector2d d(std::cos(options.direction), std::sin(options.direction));
  const Eigen::Vector2d n(-d[1], d[0]);
  dyads_ = {d * d.transpose(), d * n.transpose(), n * d.transpose(), n * n.transpose()};
  ModelBuilder(*this, anchors).build();
}

Eigen::VectorXd RodModel::rest_state() const {
  Eigen::VectorXd q = Eigen::VectorXd::Zero(size_);
  for (std::size_t i = 0; i < nodes_.size(); ++i) q.segment<2>(position(static_cast<int>(i))) = nodes_[i];
  if (weave_->lattice) q[strain_] = q[strain_ + 3] = 1;
  return q;
}

Eigen::Matrix2d RodModel::deformation_gradient(const Eigen::VectorXd& q) const {
  Eigen::Matrix2d f = Eigen::Matrix2d::Zero();
  for (int k = 0; k < 4; ++k) f += q[strain_ + k] * dyads_[static_cast<std::size_t>(k)];
  return f;
}

double RodModel::coordinate(const MaterialCoordinate& c, const Eigen::VectorXd& q) const {
  double s = c.start;
  for (std::size_t k = 0; k < 2; ++k)
    if (c.slider[k] >= 0) s += c.weight[k] * q[slider(c.slider[k])];
  return s;
}

Eigen::Vector3d RodModel::edge_vector(const Edge& edge, const Eigen::VectorXd& q) const {
  Eigen::Vector3d e = Eigen::Vector3d::Zero();
  e.head(dimension()) = q.segment(position(edge.head), dimension()) - q.segment(position(edge.tail), dimension());
  if (!edge.shift.isZero()) e.head<2>() += deformation_gradient(q) * (*weave_->lattice * edge.shift.cast<double>());
  return e;
}

}  // namespace supple::weave
