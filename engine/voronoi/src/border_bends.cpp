#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "border_curve.h"
#include "border_rounding.h"
#include "planar_cross.h"
#include "planar_face.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Bends this near to an end do not count: there it is not sure which way paths come.
constexpr double bend_margin = 1e-7;
constexpr std::size_t most_bend_samples = 8;
constexpr std::size_t most_bends = 96;
constexpr int most_change_steps = 10;
/// Relative to the distance: what rounding does to lengths of two ways.
constexpr double length_rounding = 1e-14;
/// As much longer than its straight line is a part of a border at most, or it is not taken for found by its ends.
constexpr double longest_arc = 1.25;
/// Next to an end a border that is higher over its straight line than this many times the way along it has another part
/// before, or runs all but across it.
constexpr double steepest_end = 1e3;
/// Of a part that is divided because paths come by a third way: the least fraction on each side.
constexpr double least_part = 0.1;
/// Fractions of a border between which a bend is no longer looked for where its equations do not give it: where paths
/// come from another image, and where they only begin to turn, so that the border is smooth but for its curvature.
/// Areas need less than derivatives do, because bends lie on the border all the same.
struct BendWidths {
  double bend, turn;
};
constexpr BendWidths widths_for_derivatives{1e-12, 1e-7};
/// The same by the area that a part may leave, as a fraction of the face's square: a bend that is missed by w takes an
/// area of the order of w from a piece, a place where paths begin to turn one of the order of w^3.
BendWidths widths_for_areas(double area) {
  return {std::clamp(1e2 * area, 1e-10, 1e-5), std::clamp(std::cbrt(area), 1e-4, 1e-2)};
}

}  // namespace

void BorderCurve::find_bends(bool all) {
  if (other_images_ == 0 || find_bend_by_ends()) return;
  bends_.clear();
  ways_of_parts_.clear();
  bool probed = false;
  if (!all) {
    // Three points of quadrature say whether there are bends that its area or its picture shows.
    nodes_.clear();
    probes_ = {};
    has_nodes_ = find_nodes(0, 0, 1, 0, -1);
    if (has_nodes_ && !is_visible(accuracy_.bulge)) return;
    for (std::size_t i = 0; i < probes_.size() && has_nodes_; ++i) probes_[i] = nodes_[i].point;
    probed = probes_.front().left.arrival >= 0;
  }
  lost_ = !find_bends_by_probes(all, probed);
}

/// Bends between places whose distances have been asked for: `probed` by points of quadrature already. False where the
/// border is lost.
bool BorderCurve::find_bends_by_probes(bool all, bool probed) {
  std::array<Stage, most_bend_samples + 1> stages;
  const std::size_t last =
      probed ? 1 + probes_.size() : std::min(2 * static_cast<std::size_t>(other_images_), most_bend_samples);
  for (std::size_t i = 1; i < last; ++i) {
    double fraction = static_cast<double>(i) / static_cast<double>(last);
    Point point;
    if (probed) {
      fraction = three_nodes[i - 1];
      point = probes_[i - 1];
    } else if (!find(fraction, point)) {
      return false;
    }
    stages[i] = stage_of(fraction, point);
  }
  for (const std::size_t end : {std::size_t{0}, last}) {
    const double fraction = end == 0 ? bend_margin : 1 - bend_margin;
    Point point;
    if (!find(fraction, point, &stages[end == 0 ? 1 : last - 1].ways)) return false;
    if (std::abs(point.height) > steepest_end * bend_margin * length_) return false;
    stages[end] = stage_of(fraction, point);
  }
  for (std::size_t i = 0; i < last; ++i)
    if (!find_bends_between(stages[i], stages[i + 1], all)) return false;
  ways_of_parts_.push_back(stages[last].ways);
  return true;
}

/// How paths come to an end of the border. False where none does.
bool BorderCurve::find_end_stage(bool at_end, Stage& stage) const {
  Point point;
  point.place = at_end ? Vector2d(begin_ + way_) : begin_;
  measure(point);
  if (point.left.arrival < 0 || point.right.arrival < 0) return false;
  stage = stage_of(at_end ? 1 : 0, point);
  return true;
}

/// Where paths come to both ends in the same ways, but for one of them at most: the bend that there may be is where its
/// equations say, which need not lie over the straight line. False where other paths may be shorter in between.
bool BorderCurve::find_bend_by_ends() {
  Stage first;
  Stage last;
  if (!find_end_stage(false, first) || !find_end_stage(true, last)) return false;
  const bool same_left = same(first.ways[0], last.ways[0]);
  const bool same_right = same(first.ways[1], last.ways[1]);
  if (same_left && same_right) {
    if (!is_shortest_between(first, last, first.ways, first.ways)) return false;
    ways_of_parts_.push_back(first.ways);
    lay_part(0, first.place, last.place);
    surely_shortest_ = true;
    return true;
  }
  if (!same_left && !same_right) return false;
  Stage change;
  if (!find_change(first, last, same_left ? 1 : 0, change) || !is_on_border(change, tie_gap * size_)) return false;
  const double margin = bend_margin * length_;
  if ((change.place - first.place).norm() <= margin || (change.place - last.place).norm() <= margin) return false;
  if (!is_shortest_between(first, change, first.ways, last.ways) ||
      !is_shortest_between(change, last, last.ways, first.ways))
    return false;
  add_bend(change.place, change.ways[0].length_to(change.place), first.ways);
  ways_of_parts_.push_back(last.ways);
  surely_shortest_ = true;
  return true;
}

/// Whether between two places of the border, of which `ways` lead to both, no paths but those of `others` can be
/// shorter.
bool BorderCurve::is_shortest_between(const Stage& first, const Stage& last, const Ways& ways,
                                      const Ways& others) const {
  const double length = longest_arc * (last.place - first.place).norm();
  for (const std::size_t side : {0, 1}) {
    const Way& own = ways[side];
    const double own_at_first = own.length_to(first.place);
    const double own_at_last = own.length_to(last.place);
    for (const std::int32_t i : side == 0 ? from_left_ : from_right_) {
      const surface::FaceArrival& arrival = distances_.arrivals()[static_cast<std::size_t>(i)];
      // No path of an arrival is shorter than the straight line from its image.
      const Way other{arrival.image, arrival.sigma};
      if (same(other, own) || same(other, others[side])) continue;
      const double at_first = other.length_to(first.place);
      const double at_last = other.length_to(last.place);
      // The directions in which two turns S, T see a place x differ by at most 2 |S - T| / (|x - S| + |x - T|).
      const double sum = std::min(own_at_first + at_first, own_at_last + at_last) - own.length - other.length - length;
      const double gain = 0.5 * (own_at_first + own_at_last - at_first - at_last);
      if (!(sum > 0 && gain + length * (other.turn - own.turn).norm() / sum <= tie_gap * size_)) return false;
    }
  }
  return true;
}

BorderCurve::Way BorderCurve::way_of(const Slope& slope, const Vector2d& place) const {
  const surface::FaceArrival& arrival = distances_.arrivals()[static_cast<std::size_t>(slope.arrival)];
  const Vector2d& turn = arrival.turns_at(place);
  return {turn, arrival.sigma + (turn - arrival.image).norm()};
}

BorderCurve::Ways BorderCurve::ways_at(const Point& point) const {
  return {way_of(point.left, point.place), way_of(point.right, point.place)};
}

BorderCurve::Stage BorderCurve::stage_of(double fraction, const Point& point) const {
  return {fraction, point.height, point.place, ways_at(point)};
}

bool BorderCurve::same(const Way& one, const Way& other) const {
  const double tolerance = same_image * size_;
  return (one.turn - other.turn).squaredNorm() <= tolerance * tolerance &&
         std::abs(one.length - other.length) <= tolerance;
}

bool BorderCurve::same(const Ways& one, const Ways& other) const {
  return same(one[0], other[0]) && same(one[1], other[1]);
}

void BorderCurve::add_bend(const Vector2d& place, double distance, const Ways& before) {
  bends_.push_back({within_face(corners_, place), distance});
  ways_of_parts_.push_back(before);
}

/// Bends between two places, where paths come from the sites in such ways. Of each change of a way its equations give
/// the place; where paths come by a third way in between, they say so there, and the part is divided. False where the
/// border is lost.
bool BorderCurve::find_bends_between(Stage first, const Stage& last, bool all) {
  while (!same(first.ways, last.ways)) {
    if (bends_.size() >= most_bends) return false;
    double divided = 0.5;
    bool found = false;
    bool smooth = true;
    for (std::size_t side = 0; side < 2 && !found; ++side) {
      if (same(first.ways[side], last.ways[side])) continue;
      smooth = smooth && is_tangent(first.ways[side], last.ways[side]);
      Stage change;
      if (!find_change(first, last, side, change) ||
          !(change.fraction > first.fraction && change.fraction < last.fraction))
        continue;
      found = is_on_border(change, tie_gap * size_) && leads_to(first, change);
      if (found) {
        add_bend(change.place, change.ways[0].length_to(change.place), first.ways);
        first = change;
        first.ways[side] = last.ways[side];
      } else {
        divided = (change.fraction - first.fraction) / (last.fraction - first.fraction);
      }
    }
    if (found) continue;
    const BendWidths widths = all ? widths_for_derivatives : widths_for_areas(accuracy_.area / (size_ * size_));
    if (!(last.fraction - first.fraction > (smooth ? widths.turn : widths.bend))) {
      add_bend(last.place, last.ways[0].length_to(last.place), first.ways);
      return true;
    }
    divided = std::clamp(divided, least_part, 1 - least_part);
    // Where the ends are near to each other the border between them is all but straight.
    Point point;
    point.height = first.height + divided * (last.height - first.height);
    const double fraction = first.fraction + divided * (last.fraction - first.fraction);
    if (!find(fraction, point)) return false;
    const Stage between = stage_of(fraction, point);
    if (!find_bends_between(first, between, all)) return false;
    first = between;
  }
  return true;
}

/// Whether the border runs from one place to another without another bend: next to a vertex at which paths turn there
/// are places that look like one.
bool BorderCurve::leads_to(const Stage& first, const Stage& last) const {
  const double fraction = 0.5 * (first.fraction + last.fraction);
  const Vector2d base = begin_ + fraction * way_;
  const auto [below, above] = heights_within_face(base);
  const double height = height_by(first.ways, base, 0.5 * (first.height + last.height), below, above);
  return is_on_border({fraction, height, base + height * normal_, first.ways}, same_image * size_);
}

/// Whether paths turn for one way where they run straight for the other.
bool BorderCurve::is_tangent(const Way& one, const Way& other) const {
  return std::abs(std::abs(one.length - other.length) - (one.turn - other.turn).norm()) <= same_image * size_;
}

/// Newton's method for the place where the border, as long as other paths come as at `first`, reaches the places to
/// which paths from the site on `side` (0: left) come as at `last`. These are as far by both ways, and where one way
/// only turns from the other they lie on the line on which it does. False where there is no such place in the face near
/// the border's ends.
bool BorderCurve::find_change(const Stage& first, const Stage& last, std::size_t side, Stage& change) const {
  const Way& one = first.ways[side];
  const Way& other = last.ways[side];
  const Way& facing = first.ways[1 - side];
  const bool tangent = is_tangent(one, other);
  const Vector2d between = (other.turn - one.turn).normalized();
  // How far a place is beyond the change.
  const auto beyond = [&](const Vector2d& place) {
    return tangent ? cross(between, place - one.turn) : one.length_to(place) - other.length_to(place);
  };
  const double at_first = beyond(first.place);
  const double at_last = beyond(last.place);
  double share = at_first / (at_first - at_last);
  if (!(share > 0 && share < 1)) share = 0.5;
  Vector2d place = first.place + share * (last.place - first.place);
  for (int step = 0; step < most_change_steps; ++step) {
    const Vector2d from_one = (place - one.turn).normalized();
    const Vector2d slope = from_one - (place - facing.turn).normalized();
    const double gap = one.length_to(place) - facing.length_to(place);
    const Vector2d slope_beyond =
        tangent ? Vector2d(-between.y(), between.x()) : Vector2d(from_one - (place - other.turn).normalized());
    const double gap_beyond = beyond(place);
    const double determinant = cross(slope, slope_beyond);
    if (determinant == 0) return false;
    const Vector2d move =
        Vector2d(slope_beyond.y() * gap - slope.y() * gap_beyond, slope.x() * gap_beyond - slope_beyond.x() * gap) /
        -determinant;
    place += move;
    if (!((place - begin_).squaredNorm() < 4 * length_ * length_)) return false;
    if (move.squaredNorm() > curve_rounding * curve_rounding * size_ * size_) continue;
    change.fraction = (place - begin_).dot(way_) / (length_ * length_);
    change.height = (place - begin_).dot(normal_);
    change.place = place;
    change.ways = first.ways;
    // Beyond the face lengths go on, and may be equal at other places.
    const auto [below, above] = heights_within_face(begin_ + change.fraction * way_);
    return change.height > below && change.height < above;
  }
  return false;
}

/// Whether the shortest paths from both sites come in these ways: no others are shorter, and these are possible, but
/// for `tolerance`.
bool BorderCurve::is_on_border(const Stage& stage, double tolerance) const {
  const double left = stage.ways[0].length_to(stage.place);
  const double right = stage.ways[1].length_to(stage.place);
  tolerance += length_rounding * left;
  return distances_.is_distance(from_left_, left_, stage.place, left, tolerance) &&
         distances_.is_distance(from_right_, right_, stage.place, right, tolerance);
}

}  // namespace supple::voronoi
