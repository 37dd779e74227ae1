#include "border_curve.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "border_rounding.h"
#include "planar_face.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

constexpr int max_curve_halvings = 8;
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

void BorderCurve::set_chord(const Vector2d& begin, const Vector2d& end) {
  tracer_.set_chord(begin, end);
  is_bisector_ = false;
  has_nodes_ = false;
}

void BorderCurve::set_border(const Vector2d& begin, const Vector2d& end, std::int32_t left, std::int32_t right,
                             const Active& active) {
  set_chord(begin, end);
  failed_ = false;
  excludes_other_paths_ = false;
  bends_.clear();
  extra_images_ = tracer_.set_sites(left, right, active);
  if (extra_images_ > 0 || !(length() > min_curve_length * tracer_.size())) return;
  const auto sources = tracer_.straight_sources();
  if (!sources) return;
  bends_.sources_of_parts.push_back(*sources);
  set_part(0, begin, end);
}

void BorderCurve::set_part(std::size_t number, const Vector2d& begin, const Vector2d& end) {
  set_chord(begin, end);
  if (number >= bends_.sources_of_parts.size()) return;
  const PseudoSources& sources = bends_.sources_of_parts[number];
  tracer_.set_sources(&sources);
  is_bisector_ = std::abs(sources[0].distance - sources[1].distance) <= tie_gap * tracer_.size();
}

void BorderCurve::find_bends(bool all) {
  if (extra_images_ == 0) return;
  BendSearch search(tracer_, accuracy_, bends_);
  if (search.find_by_ends()) {
    excludes_other_paths_ = true;
    if (bends_.bends.empty()) set_part(0, tracer_.begin(), tracer_.end());
    return;
  }
  bool probed = false;
  if (!all) {
    // Three quadrature points tell whether there are bends that affect the area or the drawing.
    nodes_.clear();
    probes_ = {};
    has_nodes_ = find_nodes(0, 0, 1, 0, -1);
    if (has_nodes_ && !is_visible(accuracy_.bulge)) return;
    for (std::size_t i = 0; i < probes_.size() && has_nodes_; ++i) probes_[i] = nodes_[i].point;
    probed = probes_.front().left.arrival >= 0;
  }
  failed_ = !search.find_by_samples(
      all, probed ? std::span<const BorderPoint>(probes_) : std::span<const BorderPoint>(), extra_images_);
}

const std::vector<BorderCurve::Node>& BorderCurve::nodes() {
  if (has_nodes_) return nodes_;
  has_nodes_ = true;
  nodes_.clear();
  if (!(tracer_.length() > min_curve_length * tracer_.size())) return use_straight_nodes();
  const bool found = is_bisector_ || find_nodes(0, 0, 1, 0, max_curve_halvings);
  if (is_bisector_) use_straight_nodes();
  if (found && (tracer_.sources() == nullptr || (lies_over_chord() && is_reached_from_part_sources()))) return nodes_;
  // Paths from other pseudo-sources are shorter in between: the border has bends that were not found.
  failed_ = true;
  tracer_.set_sources(nullptr);
  is_bisector_ = false;
  nodes_.clear();
  return find_nodes(0, 0, 1, 0, max_curve_halvings) ? nodes_ : use_straight_nodes();
}

const std::vector<BorderCurve::Node>& BorderCurve::use_straight_nodes() {
  nodes_.clear();
  for (std::size_t i = 0; i < three_nodes.size(); ++i) {
    BorderPoint point;
    point.place = tracer_.begin() + three_nodes[i] * tracer_.chord();
    nodes_.push_back({point, three_weights[i]});
  }
  return nodes_;
}

/// Whether the part, whose pseudo-sources are known, lies over its chord at both ends. A strongly curved arc near a
/// focus may not.
bool BorderCurve::lies_over_chord() const {
  if (std::all_of(nodes_.begin(), nodes_.end(),
                  [&](const Node& node) { return std::abs(node.point.height) <= level_bulge * tracer_.length(); }))
    return true;
  const PseudoSources& sources = *tracer_.sources();
  for (const Vector2d& end : {tracer_.begin(), tracer_.end()}) {
    const Vector2d gradient = (end - sources[0].place).normalized() - (end - sources[1].place).normalized();
    if (!(gradient.dot(tracer_.normal()) < 0)) return false;
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
    if (!tracer_.is_on_border({0, 0, nodes_[i].point.place, *tracer_.sources()}, same_image * tracer_.size()))
      return false;
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
  if (tracer_.sources() == nullptr || is_bisector_) return false;
  return std::any_of(
             all.begin(), all.end(),
             [&](const Node& node) { return std::abs(node.point.height) > division_bulge * tracer_.length(); }) ||
         std::abs(slope_at(tracer_.begin())) > division_slope || std::abs(slope_at(tracer_.end())) > division_slope;
}

/// Slope of the part, whose pseudo-sources are known, over its chord at one of its places.
double BorderCurve::slope_at(const Vector2d& place) const {
  const Vector2d gradient =
      (place - (*tracer_.sources())[0].place).normalized() - (place - (*tracer_.sources())[1].place).normalized();
  const double across = gradient.dot(tracer_.normal());
  return across == 0 ? 0 : -gradient.dot(tracer_.chord()) / (across * tracer_.length());
}

bool BorderCurve::find_top(BorderBend& top) const {
  double before = 0;
  double after = 1;
  double height = 0;
  const double slope_at_begin = slope_at(tracer_.begin());
  for (int halving = 0; halving < max_top_halvings; ++halving) {
    const double fraction = 0.5 * (before + after);
    BorderPoint point;
    point.height = height;
    if (!tracer_.find_point(fraction, point)) return false;
    top = {within_face(tracer_.corners(), point.place), point.left.distance};
    height = point.height;
    const double slope = slope_at(point.place);
    if (std::abs(slope) <= top_slope) return true;
    (slope * slope_at_begin > 0 ? before : after) = fraction;
  }
  return true;
}

const std::vector<BorderBend>& BorderCurve::arc() {
  arc_.clear();
  if (is_visible(accuracy_.deviation)) add_arc(0, 0, 1, 0, max_arc_halvings);
  return arc_;
}

void BorderCurve::add_arc(double begin, double height_at_begin, double end, double height_at_end, int halvings) {
  const double middle = 0.5 * (begin + end);
  const double chord = 0.5 * (height_at_begin + height_at_end);
  BorderPoint point;
  point.height = chord;
  if (!tracer_.find_point(middle, point)) {
    failed_ = true;
    return;
  }
  if (halvings == 0 || 2 * std::abs(point.height - chord) <= accuracy_.deviation) return;
  add_arc(begin, height_at_begin, middle, point.height, halvings - 1);
  arc_.push_back({within_face(tracer_.corners(), point.place), point.left.distance});
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
  const double length = (end - begin) * tracer_.length();
  for (const std::size_t i : {1, 0, 2}) {
    const double along = three_nodes[i];
    const double chord = (1 - along) * height_at_begin + along * height_at_end;
    // The search begins on the parabola through both ends and the middle.
    points[i].height = chord + (i == 1 ? 0 : 4 * along * (1 - along) * relative_heights[1] * length);
    const PseudoSources guess =
        i == 1 || tracer_.sources() != nullptr ? PseudoSources{} : tracer_.pseudo_sources_at(points[1]);
    if (!tracer_.find_point(begin + along * (end - begin), points[i], i == 1 ? nullptr : &guess)) return false;
    if (!(std::abs(points[i].height) < tracer_.length())) return false;
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
    BorderPoint end;
    end.place = at_end ? tracer_.end() : tracer_.begin();
    tracer_.measure(end);
    if (!tracer_.same(tracer_.pseudo_sources_at(at_end ? points.back() : points.front()),
                      tracer_.pseudo_sources_at(end)))
      return true;
  }
  return false;
}

bool BorderCurve::append_nodes(const Points& points, double begin, double end) {
  for (std::size_t i = 0; i < three_nodes.size(); ++i) nodes_.push_back({points[i], three_weights[i] * (end - begin)});
  return true;
}

}  // namespace supple::voronoi
