#include "border_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "border_rounding.h"
#include "planar_cross.h"
#include "planar_face.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

constexpr int most_curve_steps = 60;
constexpr int most_curve_halvings = 8;
constexpr int most_height_steps = 8;
/// Relative to its length: a part that bulges more is divided, and so is one that begins or ends with a greater slope,
/// because it turns sharply there. It is divided where its slope is no more than `flat_top`.
constexpr double wide_bulge = 0.05;
constexpr double steep_end = 0.3;
constexpr double flat_top = 0.1;
constexpr int most_top_halvings = 24;
/// Relative to its length: a part that bulges no more has its ends in front of each other.
constexpr double level_bulge = 1e-2;
/// Halvings of an arc that is drawn: a thousand straight lines draw one to a millionth of its bulge.
constexpr int most_arc_halvings = 10;
/// How far, at the outer ones of three points, cubic and quartic terms take a curve from its parabola, as fractions of
/// the bulge for a series whose terms are all equal; and what fraction of the sixth term three points miss.
constexpr double cubic_part = 0.156;
constexpr double quartic_part = 0.06;
constexpr double quadrature_error = 1.4e-3;
/// What a curvature that is gone before the first or after the last of three points changes in the area, as a fraction
/// of the bulge.
constexpr double end_error = 2e-3;

}  // namespace

/// One of the arrivals, which have one image, that reaches both ends of a border straight, and so all of it.
const surface::FaceArrival* BorderCurve::comes_straight(const Active& active) const {
  const Vector2d end = begin_ + way_;
  for (const std::int32_t i : active) {
    const surface::FaceArrival& arrival = distances_.arrivals()[static_cast<std::size_t>(i)];
    if (&arrival.turns_at(begin_) == &arrival.image && &arrival.turns_at(end) == &arrival.image) return &arrival;
  }
  return nullptr;
}

void BorderCurve::lay_line(const Vector2d& begin, const Vector2d& end) {
  begin_ = begin;
  way_ = end - begin;
  length_ = way_.norm();
  if (length_ > shortest_curve * size_) normal_ = Vector2d(-way_.y(), way_.x()) / length_;
  bisects_ = false;
  known_ways_ = nullptr;
  has_nodes_ = false;
}

void BorderCurve::lay(const Vector2d& begin, const Vector2d& end, std::int32_t left, std::int32_t right,
                      const Active& active) {
  lay_line(begin, end);
  left_ = left;
  right_ = right;
  other_images_ = 0;
  lost_ = false;
  surely_shortest_ = false;
  bends_.clear();
  ways_of_parts_.clear();
  if (!(length_ > shortest_curve * size_)) return;
  // Borders bulge by less than a quarter of their length, or they are cut first.
  const Vector2d middle = begin_ + 0.5 * way_;
  const double radius = 0.6 * length_;
  const double tolerance = same_image * size_;
  other_images_ = distances_.prune_site(active, left, middle, radius, tolerance, from_left_) +
                  distances_.prune_site(active, right, middle, radius, tolerance, from_right_);
  if (other_images_ > 0) return;
  const surface::FaceArrival* from_left = comes_straight(from_left_);
  const surface::FaceArrival* from_right = comes_straight(from_right_);
  if (from_left == nullptr || from_right == nullptr) return;
  ways_of_parts_.push_back({Way{from_left->image, from_left->sigma}, Way{from_right->image, from_right->sigma}});
  lay_part(0, begin, end);
}

void BorderCurve::lay_part(std::size_t number, const Vector2d& begin, const Vector2d& end) {
  lay_line(begin, end);
  if (number >= ways_of_parts_.size()) return;
  known_ways_ = &ways_of_parts_[number];
  bisects_ = std::abs((*known_ways_)[0].length - (*known_ways_)[1].length) <= tie_gap * size_;
}

const std::vector<BorderCurve::Node>& BorderCurve::nodes() {
  if (has_nodes_) return nodes_;
  has_nodes_ = true;
  nodes_.clear();
  if (!(length_ > shortest_curve * size_)) return take_straight_nodes();
  const bool found = bisects_ || find_nodes(0, 0, 1, 0, most_curve_halvings);
  if (bisects_) take_straight_nodes();
  if (found && (known_ways_ == nullptr || (is_function() && has_known_ways()))) return nodes_;
  // Other paths are shorter in between: the border has bends that were not found.
  lost_ = true;
  known_ways_ = nullptr;
  bisects_ = false;
  nodes_.clear();
  return find_nodes(0, 0, 1, 0, most_curve_halvings) ? nodes_ : take_straight_nodes();
}

const std::vector<BorderCurve::Node>& BorderCurve::take_straight_nodes() {
  nodes_.clear();
  for (std::size_t i = 0; i < three_nodes.size(); ++i) {
    Point point;
    point.place = begin_ + three_nodes[i] * way_;
    nodes_.push_back({point, three_weights[i]});
  }
  return nodes_;
}

/// Whether the part, whose two ways are known, runs over its straight line at both ends: an arc that bulges that much
/// next to a focus may begin or end behind them.
bool BorderCurve::is_function() const {
  if (std::all_of(nodes_.begin(), nodes_.end(),
                  [&](const Node& node) { return std::abs(node.point.height) <= level_bulge * length_; }))
    return true;
  const Ways& ways = *known_ways_;
  for (const Vector2d& end : {begin_, Vector2d(begin_ + way_)}) {
    const Vector2d gradient = (end - ways[0].turn).normalized() - (end - ways[1].turn).normalized();
    if (!(gradient.dot(normal_) < 0)) return false;
  }
  return true;
}

/// Whether the shortest paths come to the part in the two known ways: to all points of quadrature, or to the middle one
/// of each where no other paths can be shorter, as long as these are possible.
bool BorderCurve::has_known_ways() const {
  if (other_images_ == 0) return true;
  const bool all = !surely_shortest_ || is_visible(accuracy_.bulge);
  for (std::size_t i = all ? 0 : 1; i < nodes_.size(); i += all ? 1 : three_nodes.size())
    if (!is_on_border({0, 0, nodes_[i].point.place, *known_ways_}, same_image * size_)) return false;
  return true;
}

/// Whether the straight line is farther from the border than it may be drawn. An arc of a hyperbola bulges to one side:
/// it is nowhere higher than twice as high as in its middle.
bool BorderCurve::is_visible(double deviation) const {
  return std::any_of(nodes_.begin(), nodes_.end(),
                     [&](const Node& node) { return 2 * std::abs(node.point.height) > deviation; });
}

bool BorderCurve::bulges() {
  const std::vector<Node>& all = nodes();
  if (known_ways_ == nullptr || bisects_) return false;
  return std::any_of(all.begin(), all.end(),
                     [&](const Node& node) { return std::abs(node.point.height) > wide_bulge * length_; }) ||
         std::abs(slope_at(begin_)) > steep_end || std::abs(slope_at(begin_ + way_)) > steep_end;
}

/// How the height of the part, whose two ways are known, changes along its straight line at one of its places.
double BorderCurve::slope_at(const Vector2d& place) const {
  const Vector2d gradient =
      (place - (*known_ways_)[0].turn).normalized() - (place - (*known_ways_)[1].turn).normalized();
  const double across = gradient.dot(normal_);
  return across == 0 ? 0 : -gradient.dot(way_) / (across * length_);
}

bool BorderCurve::find_top(Bend& top) const {
  double before = 0;
  double after = 1;
  double height = 0;
  const double rises = slope_at(begin_);
  for (int halving = 0; halving < most_top_halvings; ++halving) {
    const double fraction = 0.5 * (before + after);
    Point point;
    point.height = height;
    if (!find(fraction, point)) return false;
    top = {within_face(corners_, point.place), point.left.distance};
    height = point.height;
    const double slope = slope_at(point.place);
    if (std::abs(slope) <= flat_top) return true;
    (slope * rises > 0 ? before : after) = fraction;
  }
  return true;
}

const std::vector<BorderCurve::Bend>& BorderCurve::arc() {
  arc_.clear();
  if (is_visible(accuracy_.deviation)) add_arc(0, 0, 1, 0, most_arc_halvings);
  return arc_;
}

void BorderCurve::add_arc(double begin, double height_at_begin, double end, double height_at_end, int halvings) {
  const double middle = 0.5 * (begin + end);
  const double chord = 0.5 * (height_at_begin + height_at_end);
  Point point;
  point.height = chord;
  if (!find(middle, point)) {
    lost_ = true;
    return;
  }
  if (halvings == 0 || 2 * std::abs(point.height - chord) <= accuracy_.deviation) return;
  add_arc(begin, height_at_begin, middle, point.height, halvings - 1);
  arc_.push_back({within_face(corners_, point.place), point.left.distance});
  add_arc(middle, point.height, end, height_at_end, halvings - 1);
}

/// Points of quadrature along a border between two fractions of its straight line, over which it has these heights.
/// Three suffice where the border is all but a parabola; it is halved where it is not, as next to the focus of its
/// hyperbola. False where the border is not found.
bool BorderCurve::find_nodes(double begin, double height_at_begin, double end, double height_at_end, int halvings) {
  Points points;
  std::array<double, three_nodes.size()> bulges{};  // over the chord of this part, in units of its length
  const double length = (end - begin) * length_;
  for (const std::size_t i : {1, 0, 2}) {
    const double along = three_nodes[i];
    const double chord = (1 - along) * height_at_begin + along * height_at_end;
    // Through the ends and the middle goes a parabola, where the search begins.
    points[i].height = chord + (i == 1 ? 0 : 4 * along * (1 - along) * bulges[1] * length);
    const Ways guess = i == 1 || known_ways_ != nullptr ? Ways{} : ways_at(points[1]);
    if (!find(begin + along * (end - begin), points[i], i == 1 ? nullptr : &guess)) return false;
    if (!(std::abs(points[i].height) < length_)) return false;
    bulges[i] = (points[i].height - chord) / length;
  }
  const double parabola = 4 * three_nodes[0] * (1 - three_nodes[0]) * bulges[1];
  const double cubic = 0.5 * std::abs(bulges[0] - bulges[2]);
  const double quartic = 0.5 * std::abs(bulges[0] + bulges[2] - 2 * parabola);
  const double bulge = std::max({std::abs(bulges[1]), cubic, quartic});
  // In a series in the distance along the chord: the square of the ratio of successive terms. The sixth power is what
  // three points miss.
  const double square =
      bulge > 0 ? std::max(cubic * cubic / (cubic_part * cubic_part * bulge * bulge), quartic / (quartic_part * bulge))
                : 0;
  double left = quadrature_error * bulge * square * square * length * length;
  if (halvings < 0 && left <= accuracy_.area && turns_near_ends(points)) left += end_error * bulge * length * length;
  if (left > accuracy_.area) {
    if (halvings < 0) probes_ = points;
    if (halvings < 0) return false;
    if (halvings == 0) return take_nodes(points, begin, end);
    const double middle = 0.5 * (begin + end);
    const double height = points[1].height;
    return find_nodes(begin, height_at_begin, middle, height, halvings - 1) &&
           find_nodes(middle, height, end, height_at_end, halvings - 1);
  }
  return take_nodes(points, begin, end);
}

/// Whether paths come other ways to an end of a border than to the point of quadrature next to it.
bool BorderCurve::turns_near_ends(const Points& points) const {
  for (const bool at_end : {false, true}) {
    Point end;
    end.place = at_end ? Vector2d(begin_ + way_) : begin_;
    measure(end);
    if (!same(ways_at(at_end ? points.back() : points.front()), ways_at(end))) return true;
  }
  return false;
}

bool BorderCurve::take_nodes(const Points& points, double begin, double end) {
  for (std::size_t i = 0; i < three_nodes.size(); ++i) nodes_.push_back({points[i], three_weights[i] * (end - begin)});
  return true;
}

/// How far a line along the normal from a place of the face runs in it, backwards and forwards, and a little beyond.
std::pair<double, double> BorderCurve::heights_within_face(const Vector2d& base) const {
  double backwards = -std::numeric_limits<double>::infinity();
  double forwards = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector2d side = corners_[(i + 1) % 3] - corners_[i];
    const double inwards = cross(side, normal_);
    if (inwards == 0) continue;
    const double height = -std::max(cross(side, base - corners_[i]), 0.0) / inwards;
    if (inwards > 0)
      backwards = std::max(backwards, height);
    else
      forwards = std::min(forwards, height);
  }
  return {backwards - shortest_curve * size_, forwards + shortest_curve * size_};
}

/// The distances of a place from both sites.
void BorderCurve::measure(Point& point) const {
  if (known_ways_ == nullptr) {
    point.left = distances_.from_site(from_left_, left_, point.place);
    point.right = distances_.from_site(from_right_, right_, point.place);
    return;
  }
  const auto along = [&](const Way& way) {
    const Vector2d from = point.place - way.turn;
    const double length = from.norm();
    return Slope{way.length + length, length > 0 ? Vector2d(from / length) : Vector2d::Zero()};
  };
  point.left = along((*known_ways_)[0]);
  point.right = along((*known_ways_)[1]);
}

/// The height over a place of the straight line, between two others, at which two ways are as long, by Newton's method
/// from another height; that one where the method gets lost.
double BorderCurve::height_by(const Ways& ways, const Vector2d& base, double height, double below, double above) const {
  double found = height;
  for (int step = 0; step < most_height_steps; ++step) {
    const Vector2d place = base + found * normal_;
    const Vector2d from_left = place - ways[0].turn;
    const Vector2d from_right = place - ways[1].turn;
    const double left = from_left.norm();
    const double right = from_right.norm();
    const double across = from_left.dot(normal_) / left - from_right.dot(normal_) / right;
    const double change = (ways[1].length + right - ways[0].length - left) / across;
    found += change;
    if (!(across < 0) || !(found > below && found < above) || !(std::abs(found) < length_)) return height;
    if (std::abs(change) <= curve_rounding * size_) break;
  }
  return found;
}

/// The border over a point of its straight line: from the height that `point` has, or the one that ways from both sites
/// say that are guessed, to the one that the shortest ways there say, until these stay the same; within a bracket once
/// there is one, because that may go back and forth about a bend.
bool BorderCurve::find(double fraction, Point& point, const Ways* guess) const {
  const Vector2d base = begin_ + fraction * way_;
  // Beyond the face lengths of arrivals go on, and may be equal at other places.
  auto [below, above] = heights_within_face(base);
  if (guess != nullptr && known_ways_ == nullptr) point.height = height_by(*guess, base, point.height, below, above);
  for (int step = 0; step < most_curve_steps; ++step) {
    point.place = base + point.height * normal_;
    measure(point);
    const double gap = point.left.distance - point.right.distance;
    const Vector2d gradient = point.left.gradient - point.right.gradient;
    const double across = gradient.dot(normal_);
    if (!std::isfinite(gap)) return false;
    // Towards the left cell its site comes nearer, but where both are as near all over.
    if (!(across < 0)) return std::abs(gap) <= tie_gap * size_;
    point.stretch = gradient.norm() / -across;
    const double change = -gap / across;
    if (std::abs(change) <= curve_rounding * size_) return true;
    (gap > 0 ? below : above) = point.height;
    double next = point.height + change;
    if (known_ways_ == nullptr) next = height_by(ways_at(point), base, next, below, above);
    if (!(next > below && next < above)) next = 0.5 * (below + above);
    if (!(std::abs(next) < length_)) return false;
    if (next == point.height) return true;
    point.height = next;
  }
  return true;
}

}  // namespace supple::voronoi
