#include "border_curve.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "border_rounding.h"
#include "planar_cross.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

constexpr int most_curve_steps = 60;
constexpr int most_curve_halvings = 8;
constexpr int most_height_steps = 8;
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
  if (length_ > shortest_curve * size_ && !bisects_) {
    if (find_nodes(0, 0, 1, 0, most_curve_halvings) &&
        (known_ways_ == nullptr || is_on_border({0, 0, nodes_[1].point.place, *known_ways_})))
      return nodes_;
    // Other paths may be shorter in between.
    nodes_.clear();
    if (known_ways_ != nullptr) {
      known_ways_ = nullptr;
      if (find_nodes(0, 0, 1, 0, most_curve_halvings)) return nodes_;
      nodes_.clear();
    }
  }
  for (std::size_t i = 0; i < three_nodes.size(); ++i) {
    Point point;
    point.place = begin_ + three_nodes[i] * way_;
    nodes_.push_back({point, three_weights[i]});
  }
  return nodes_;
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
  if (halvings < 0 && left <= area_tolerance_ && turns_near_ends(points)) left += end_error * bulge * length * length;
  if (left > area_tolerance_) {
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
    if (!std::isfinite(gap) || !(across < 0)) return false;  // towards the left cell its site comes nearer
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
