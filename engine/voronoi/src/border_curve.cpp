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

constexpr int max_curve_steps = 60;
constexpr int max_curve_halvings = 8;
constexpr int max_height_steps = 8;
/// Relative to the chord: a part that is higher than division_bulge, or steeper at an end than division_slope, is
/// divided where its slope is at most top_slope.
constexpr double division_bulge = 0.05;
constexpr double division_slope = 0.3;
constexpr double top_slope = 0.1;
constexpr int max_top_halvings = 24;
/// Relative to the chord: a part no higher than this needs no check of the slopes at its ends.
constexpr double level_bulge = 1e-2;
/// Maximum halvings of an arc that is drawn. 2^10 segments draw it to a millionth of its height.
constexpr int max_arc_halvings = 10;
/// Deviations of a curve from its parabola at the outer two of three quadrature points, by the cubic and the quartic
/// term, and the fraction of the sixth term that three points do not integrate. They are fractions of the bulge, for a
/// power series with equal terms.
constexpr double cubic_part = 0.156;
constexpr double quartic_part = 0.06;
constexpr double quadrature_error = 1.4e-3;
/// Change of the area, as a fraction of the bulge, if the curvature vanishes before the first or after the last
/// quadrature point.
constexpr double end_error = 2e-3;

}  // namespace

/// The arrival, of several from one image, that reaches both ends of the border straight, and so all of it; null if
/// there is none.
const surface::FaceArrival* BorderCurve::straight_arrival(const Active& active) const {
  const Vector2d end = begin_ + chord_;
  for (const std::int32_t i : active) {
    const surface::FaceArrival& arrival = distances_.arrivals()[static_cast<std::size_t>(i)];
    if (&arrival.turns_at(begin_) == &arrival.image && &arrival.turns_at(end) == &arrival.image) return &arrival;
  }
  return nullptr;
}

void BorderCurve::set_chord(const Vector2d& begin, const Vector2d& end) {
  begin_ = begin;
  chord_ = end - begin;
  length_ = chord_.norm();
  if (length_ > min_curve_length * size_) normal_ = Vector2d(-chord_.y(), chord_.x()) / length_;
  is_bisector_ = false;
  part_sources_ = nullptr;
  has_nodes_ = false;
}

void BorderCurve::set_border(const Vector2d& begin, const Vector2d& end, std::int32_t left, std::int32_t right,
                             const Active& active) {
  set_chord(begin, end);
  left_ = left;
  right_ = right;
  extra_images_ = 0;
  failed_ = false;
  excludes_other_paths_ = false;
  bends_.clear();
  sources_of_parts_.clear();
  if (!(length_ > min_curve_length * size_)) return;
  // Borders must have bulges below a quarter of their length; others are divided first.
  const Vector2d middle = begin_ + 0.5 * chord_;
  const double radius = 0.6 * length_;
  const double tolerance = same_image * size_;
  extra_images_ = distances_.prune_site(active, left, middle, radius, tolerance, from_left_) +
                  distances_.prune_site(active, right, middle, radius, tolerance, from_right_);
  if (extra_images_ > 0) return;
  const surface::FaceArrival* from_left = straight_arrival(from_left_);
  const surface::FaceArrival* from_right = straight_arrival(from_right_);
  if (from_left == nullptr || from_right == nullptr) return;
  sources_of_parts_.push_back(
      {PseudoSource{from_left->image, from_left->sigma}, PseudoSource{from_right->image, from_right->sigma}});
  set_part(0, begin, end);
}

void BorderCurve::set_part(std::size_t number, const Vector2d& begin, const Vector2d& end) {
  set_chord(begin, end);
  if (number >= sources_of_parts_.size()) return;
  part_sources_ = &sources_of_parts_[number];
  is_bisector_ = std::abs((*part_sources_)[0].distance - (*part_sources_)[1].distance) <= tie_gap * size_;
}

const std::vector<BorderCurve::Node>& BorderCurve::nodes() {
  if (has_nodes_) return nodes_;
  has_nodes_ = true;
  nodes_.clear();
  if (!(length_ > min_curve_length * size_)) return use_straight_nodes();
  const bool found = is_bisector_ || find_nodes(0, 0, 1, 0, max_curve_halvings);
  if (is_bisector_) use_straight_nodes();
  if (found && (part_sources_ == nullptr || (lies_over_chord() && is_reached_from_part_sources()))) return nodes_;
  // Paths from other pseudo-sources are shorter in between: the border has bends that were not found.
  failed_ = true;
  part_sources_ = nullptr;
  is_bisector_ = false;
  nodes_.clear();
  return find_nodes(0, 0, 1, 0, max_curve_halvings) ? nodes_ : use_straight_nodes();
}

const std::vector<BorderCurve::Node>& BorderCurve::use_straight_nodes() {
  nodes_.clear();
  for (std::size_t i = 0; i < three_nodes.size(); ++i) {
    Point point;
    point.place = begin_ + three_nodes[i] * chord_;
    nodes_.push_back({point, three_weights[i]});
  }
  return nodes_;
}

/// Whether the part, whose pseudo-sources are known, lies over its chord at both ends. A strongly curved arc near a
/// focus may not.
bool BorderCurve::lies_over_chord() const {
  if (std::all_of(nodes_.begin(), nodes_.end(),
                  [&](const Node& node) { return std::abs(node.point.height) <= level_bulge * length_; }))
    return true;
  const PseudoSources& sources = *part_sources_;
  for (const Vector2d& end : {begin_, Vector2d(begin_ + chord_)}) {
    const Vector2d gradient = (end - sources[0].place).normalized() - (end - sources[1].place).normalized();
    if (!(gradient.dot(normal_) < 0)) return false;
  }
  return true;
}

/// Whether the shortest paths to the part come from its pseudo-sources, at all quadrature points. If other paths are
/// proven to be no shorter and the part is nearly straight, one of three points suffices, to see that these paths
/// exist.
bool BorderCurve::is_reached_from_part_sources() const {
  if (extra_images_ == 0) return true;
  const bool all = !excludes_other_paths_ || is_visible(accuracy_.bulge);
  for (std::size_t i = all ? 0 : 1; i < nodes_.size(); i += all ? 1 : three_nodes.size())
    if (!is_on_border({0, 0, nodes_[i].point.place, *part_sources_}, same_image * size_)) return false;
  return true;
}

/// Whether the chord is farther from the border than `deviation`. An arc of a hyperbola is on one side of its chord and
/// nowhere higher than twice its height in the middle.
bool BorderCurve::is_visible(double deviation) const {
  return std::any_of(nodes_.begin(), nodes_.end(),
                     [&](const Node& node) { return 2 * std::abs(node.point.height) > deviation; });
}

bool BorderCurve::needs_division() {
  const std::vector<Node>& all = nodes();
  if (part_sources_ == nullptr || is_bisector_) return false;
  return std::any_of(all.begin(), all.end(),
                     [&](const Node& node) { return std::abs(node.point.height) > division_bulge * length_; }) ||
         std::abs(slope_at(begin_)) > division_slope || std::abs(slope_at(begin_ + chord_)) > division_slope;
}

/// Slope of the part, whose pseudo-sources are known, over its chord at one of its places.
double BorderCurve::slope_at(const Vector2d& place) const {
  const Vector2d gradient =
      (place - (*part_sources_)[0].place).normalized() - (place - (*part_sources_)[1].place).normalized();
  const double across = gradient.dot(normal_);
  return across == 0 ? 0 : -gradient.dot(chord_) / (across * length_);
}

bool BorderCurve::find_top(Bend& top) const {
  double before = 0;
  double after = 1;
  double height = 0;
  const double slope_at_begin = slope_at(begin_);
  for (int halving = 0; halving < max_top_halvings; ++halving) {
    const double fraction = 0.5 * (before + after);
    Point point;
    point.height = height;
    if (!find_point(fraction, point)) return false;
    top = {within_face(corners_, point.place), point.left.distance};
    height = point.height;
    const double slope = slope_at(point.place);
    if (std::abs(slope) <= top_slope) return true;
    (slope * slope_at_begin > 0 ? before : after) = fraction;
  }
  return true;
}

const std::vector<BorderCurve::Bend>& BorderCurve::arc() {
  arc_.clear();
  if (is_visible(accuracy_.deviation)) add_arc(0, 0, 1, 0, max_arc_halvings);
  return arc_;
}

void BorderCurve::add_arc(double begin, double height_at_begin, double end, double height_at_end, int halvings) {
  const double middle = 0.5 * (begin + end);
  const double chord = 0.5 * (height_at_begin + height_at_end);
  Point point;
  point.height = chord;
  if (!find_point(middle, point)) {
    failed_ = true;
    return;
  }
  if (halvings == 0 || 2 * std::abs(point.height - chord) <= accuracy_.deviation) return;
  add_arc(begin, height_at_begin, middle, point.height, halvings - 1);
  arc_.push_back({within_face(corners_, point.place), point.left.distance});
  add_arc(middle, point.height, end, height_at_end, halvings - 1);
}

/// Finds quadrature points along the border between two fractions of the chord, with these heights there. Three points
/// suffice where the border is nearly a parabola. Elsewhere, as next to the focus of the hyperbola, the interval is
/// halved. Returns false if the border is not found. If `halvings` < 0 and three points do not suffice, they are
/// written to probes_ and the result is false.
bool BorderCurve::find_nodes(double begin, double height_at_begin, double end, double height_at_end, int halvings) {
  Points points;
  // Heights over the chord of this interval, in units of its length.
  std::array<double, three_nodes.size()> relative_heights{};
  const double length = (end - begin) * length_;
  for (const std::size_t i : {1, 0, 2}) {
    const double along = three_nodes[i];
    const double chord = (1 - along) * height_at_begin + along * height_at_end;
    // The search begins on the parabola through both ends and the middle.
    points[i].height = chord + (i == 1 ? 0 : 4 * along * (1 - along) * relative_heights[1] * length);
    const PseudoSources guess = i == 1 || part_sources_ != nullptr ? PseudoSources{} : pseudo_sources_at(points[1]);
    if (!find_point(begin + along * (end - begin), points[i], i == 1 ? nullptr : &guess)) return false;
    if (!(std::abs(points[i].height) < length_)) return false;
    relative_heights[i] = (points[i].height - chord) / length;
  }
  const double parabola = 4 * three_nodes[0] * (1 - three_nodes[0]) * relative_heights[1];
  const double cubic = 0.5 * std::abs(relative_heights[0] - relative_heights[2]);
  const double quartic = 0.5 * std::abs(relative_heights[0] + relative_heights[2] - 2 * parabola);
  const double bulge = std::max({std::abs(relative_heights[1]), cubic, quartic});
  // Estimate of the squared ratio of successive terms, for a power series in the distance along the chord. Three points
  // miss the sixth power.
  const double squared_ratio =
      bulge > 0 ? std::max(cubic * cubic / (cubic_part * cubic_part * bulge * bulge), quartic / (quartic_part * bulge))
                : 0;
  double error = quadrature_error * bulge * squared_ratio * squared_ratio * length * length;
  if (halvings < 0 && error <= accuracy_.area && has_bends_near_ends(points))
    error += end_error * bulge * length * length;
  if (error > accuracy_.area) {
    if (halvings < 0) probes_ = points;
    if (halvings < 0) return false;
    if (halvings == 0) return append_nodes(points, begin, end);
    const double middle = 0.5 * (begin + end);
    const double height = points[1].height;
    return find_nodes(begin, height_at_begin, middle, height, halvings - 1) &&
           find_nodes(middle, height, end, height_at_end, halvings - 1);
  }
  return append_nodes(points, begin, end);
}

/// Whether the pseudo-sources at an end of the border differ from those at the nearest quadrature point.
bool BorderCurve::has_bends_near_ends(const Points& points) const {
  for (const bool at_end : {false, true}) {
    Point end;
    end.place = at_end ? Vector2d(begin_ + chord_) : begin_;
    measure(end);
    if (!same(pseudo_sources_at(at_end ? points.back() : points.front()), pseudo_sources_at(end))) return true;
  }
  return false;
}

bool BorderCurve::append_nodes(const Points& points, double begin, double end) {
  for (std::size_t i = 0; i < three_nodes.size(); ++i) nodes_.push_back({points[i], three_weights[i] * (end - begin)});
  return true;
}

/// Heights between which the normal through a place of the chord lies in the face, with a small margin.
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
  return {backwards - min_curve_length * size_, forwards + min_curve_length * size_};
}

/// Computes the distances of the point from both sites.
void BorderCurve::measure(Point& point) const {
  if (part_sources_ == nullptr) {
    point.left = distances_.from_site(from_left_, left_, point.place);
    point.right = distances_.from_site(from_right_, right_, point.place);
    return;
  }
  const auto distance_from = [&](const PseudoSource& source) {
    const Vector2d from = point.place - source.place;
    const double length = from.norm();
    return SiteDistance{source.distance + length, length > 0 ? Vector2d(from / length) : Vector2d::Zero()};
  };
  point.left = distance_from((*part_sources_)[0]);
  point.right = distance_from((*part_sources_)[1]);
}

/// The height in (below, above), over a place of the chord, at which the paths from both pseudo-sources are equally
/// long. Newton's method starts at `height`, which is also the result if it fails.
double BorderCurve::equidistant_height(const PseudoSources& sources, const Vector2d& base, double height, double below,
                                       double above) const {
  double found = height;
  for (int step = 0; step < max_height_steps; ++step) {
    const Vector2d place = base + found * normal_;
    const Vector2d from_left = place - sources[0].place;
    const Vector2d from_right = place - sources[1].place;
    const double left = from_left.norm();
    const double right = from_right.norm();
    const double across = from_left.dot(normal_) / left - from_right.dot(normal_) / right;
    const double change = (sources[1].distance + right - sources[0].distance - left) / across;
    found += change;
    if (!(across < 0) || !(found > below && found < above) || !(std::abs(found) < length_)) return height;
    if (std::abs(change) <= curve_rounding * size_) break;
  }
  return found;
}

/// Finds the border over a point of the chord. The search starts at the height in `point`, or at that of the guessed
/// pseudo-sources. Each step goes to the height that is equally far from the present pseudo-sources, until these stay
/// the same. The steps are bracketed, because they may alternate about a bend.
bool BorderCurve::find_point(double fraction, Point& point, const PseudoSources* guess) const {
  const Vector2d base = begin_ + fraction * chord_;
  // Lengths are defined beyond the face too, where they may be equal at other places.
  auto [below, above] = heights_within_face(base);
  if (guess != nullptr && part_sources_ == nullptr)
    point.height = equidistant_height(*guess, base, point.height, below, above);
  for (int step = 0; step < max_curve_steps; ++step) {
    point.place = base + point.height * normal_;
    measure(point);
    const double gap = point.left.distance - point.right.distance;
    const Vector2d gradient = point.left.gradient - point.right.gradient;
    const double across = gradient.dot(normal_);
    if (!std::isfinite(gap)) return false;
    // Towards the left cell the left site gets nearer, unless both are equally near everywhere.
    if (!(across < 0)) return std::abs(gap) <= tie_gap * size_;
    point.stretch = gradient.norm() / -across;
    const double change = -gap / across;
    if (std::abs(change) <= curve_rounding * size_) return true;
    (gap > 0 ? below : above) = point.height;
    double next = point.height + change;
    if (part_sources_ == nullptr) next = equidistant_height(pseudo_sources_at(point), base, next, below, above);
    if (!(next > below && next < above)) next = 0.5 * (below + above);
    if (!(std::abs(next) < length_)) return false;
    if (next == point.height) return true;
    point.height = next;
  }
  return true;
}

}  // namespace supple::voronoi
