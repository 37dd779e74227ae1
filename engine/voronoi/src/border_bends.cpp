#include "border_bends.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "border_rounding.h"
#include "planar_cross.h"
#include "planar_face.h"
#include "quadrature.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;

/// Fraction of a border next to its ends in which bends are ignored, because the pseudo-sources are not certain there.
constexpr double bend_margin = 1e-7;
constexpr std::size_t max_bend_samples = 8;
constexpr std::size_t max_bends = 96;
constexpr int max_transition_steps = 10;
/// Maximum length of a part of a border per length of its chord. The paths to the ends of a longer part tell nothing
/// about other paths in between.
constexpr double max_arc_ratio = 1.25;
/// Maximum height over the chord next to an end, per distance from that end. A higher border has another part before
/// this one, or is nearly perpendicular to the chord.
constexpr double max_end_rise = 1e3;
/// Minimum fraction on each side, if a part is divided because paths come from a third pseudo-source.
constexpr double min_part_fraction = 0.1;
/// Fractions of a border at which the search for a bend ends, if its equations do not give it: `bend` where paths come
/// from another image, `turn` where paths only begin to turn and the border stays smooth. Areas allow more than
/// derivatives, because the approximate bend still lies on the border.
struct BendWidths {
  double bend, turn;
};
constexpr BendWidths widths_for_derivatives{1e-12, 1e-7};
/// The widths for an error of the area, which is a fraction of the squared face size. A bend that is missed by w
/// changes the area by the order of w, and a place where paths begin to turn by the order of w^3.
BendWidths widths_for_areas(double area) {
  return {std::clamp(1e2 * area, 1e-10, 1e-5), std::clamp(std::cbrt(area), 1e-4, 1e-2)};
}

}  // namespace

bool BendSearch::find_by_ends() {
  LabelledPoint first;
  LabelledPoint last;
  if (!find_labelled_end(false, first) || !find_labelled_end(true, last)) return false;
  const bool same_left = tracer_.same(first.sources[0], last.sources[0]);
  const bool same_right = tracer_.same(first.sources[1], last.sources[1]);
  if (same_left && same_right) {
    if (!is_shortest_between(first, last, first.sources, first.sources)) return false;
    found_.sources_of_parts.push_back(first.sources);
    return true;
  }
  if (!same_left && !same_right) return false;
  LabelledPoint transition;
  if (!find_transition(first, last, same_left ? 1 : 0, transition) ||
      !tracer_.is_on_border(transition, tie_gap * tracer_.size()))
    return false;
  const double margin = bend_margin * tracer_.length();
  if ((transition.place - first.place).norm() <= margin || (transition.place - last.place).norm() <= margin)
    return false;
  if (!is_shortest_between(first, transition, first.sources, last.sources) ||
      !is_shortest_between(transition, last, last.sources, first.sources))
    return false;
  add_bend(transition, first.sources);
  found_.sources_of_parts.push_back(last.sources);
  return true;
}

bool BendSearch::find_by_samples(bool all, std::span<const BorderPoint> probes, int extra_images) {
  const bool probed = !probes.empty();
  std::array<LabelledPoint, max_bend_samples + 1> samples;
  const std::size_t last =
      probed ? 1 + probes.size() : std::min(2 * static_cast<std::size_t>(extra_images), max_bend_samples);
  for (std::size_t i = 1; i < last; ++i) {
    double fraction = static_cast<double>(i) / static_cast<double>(last);
    BorderPoint point;
    if (probed) {
      fraction = three_nodes[i - 1];
      point = probes[i - 1];
    } else if (!tracer_.find_point(fraction, point)) {
      return false;
    }
    samples[i] = tracer_.labelled(fraction, point);
  }
  for (const std::size_t end : {std::size_t{0}, last}) {
    const double fraction = end == 0 ? bend_margin : 1 - bend_margin;
    BorderPoint point;
    if (!tracer_.find_point(fraction, point, &samples[end == 0 ? 1 : last - 1].sources)) return false;
    if (std::abs(point.height) > max_end_rise * bend_margin * tracer_.length()) return false;
    samples[end] = tracer_.labelled(fraction, point);
  }
  for (std::size_t i = 0; i < last; ++i)
    if (!find_bends_between(samples[i], samples[i + 1], all)) return false;
  found_.sources_of_parts.push_back(samples[last].sources);
  return true;
}

/// Sets `result` to an end of the border with its pseudo-sources. Returns false if no path reaches it.
bool BendSearch::find_labelled_end(bool at_end, LabelledPoint& result) const {
  BorderPoint point;
  point.place = at_end ? tracer_.end() : tracer_.begin();
  tracer_.measure(point);
  if (point.left.arrival < 0 || point.right.arrival < 0) return false;
  result = tracer_.labelled(at_end ? 1 : 0, point);
  return true;
}

/// Whether no other paths can be shorter between two points of the border that both have the pseudo-sources `sources`.
/// The pseudo-sources `others` do not count.
bool BendSearch::is_shortest_between(const LabelledPoint& first, const LabelledPoint& last,
                                     const PseudoSources& sources, const PseudoSources& others) const {
  const double length = max_arc_ratio * (last.place - first.place).norm();
  for (const std::size_t side : {0, 1}) {
    const PseudoSource& own = sources[side];
    const double own_at_first = own.length_to(first.place);
    const double own_at_last = own.length_to(last.place);
    for (const std::int32_t i : tracer_.arrivals_on(side)) {
      const surface::FaceArrival& arrival = tracer_.arrival(i);
      // No path of an arrival is shorter than the straight line from its image.
      const PseudoSource other{arrival.image, arrival.sigma};
      if (tracer_.same(other, own) || tracer_.same(other, others[side])) continue;
      const double at_first = other.length_to(first.place);
      const double at_last = other.length_to(last.place);
      // The gradients of |x - S| and |x - T|, S and T the pseudo-sources, differ by at most 2 |S - T| / (|x - S| + |x -
      // T|).
      const double sum =
          std::min(own_at_first + at_first, own_at_last + at_last) - own.distance - other.distance - length;
      const double gain = 0.5 * (own_at_first + own_at_last - at_first - at_last);
      if (!(sum > 0 && gain + length * (other.place - own.place).norm() / sum <= tie_gap * tracer_.size()))
        return false;
    }
  }
  return true;
}

void BendSearch::add_bend(const LabelledPoint& bend, const PseudoSources& before) {
  found_.bends.push_back({within_face(tracer_.corners(), bend.place), bend.sources[0].length_to(bend.place)});
  found_.sources_of_parts.push_back(before);
}

/// Finds the bends between two points of the border. Where one pseudo-source changes, equations give the place. If
/// paths from a third one are shorter there, the interval is divided. Returns false if the border is not found.
bool BendSearch::find_bends_between(LabelledPoint first, const LabelledPoint& last, bool all) {
  while (!tracer_.same(first.sources, last.sources)) {
    if (found_.bends.size() >= max_bends) return false;
    double division = 0.5;
    bool found = false;
    bool smooth = true;
    for (std::size_t side = 0; side < 2 && !found; ++side) {
      if (tracer_.same(first.sources[side], last.sources[side])) continue;
      smooth = smooth && is_smooth_transition(first.sources[side], last.sources[side]);
      LabelledPoint transition;
      if (!find_transition(first, last, side, transition) ||
          !(transition.fraction > first.fraction && transition.fraction < last.fraction))
        continue;
      found = tracer_.is_on_border(transition, tie_gap * tracer_.size()) && has_no_bend_between(first, transition);
      if (found) {
        add_bend(transition, first.sources);
        first = transition;
        first.sources[side] = last.sources[side];
      } else {
        division = (transition.fraction - first.fraction) / (last.fraction - first.fraction);
      }
    }
    if (found) continue;
    const BendWidths widths =
        all ? widths_for_derivatives : widths_for_areas(accuracy_.area / (tracer_.size() * tracer_.size()));
    if (!(last.fraction - first.fraction > (smooth ? widths.turn : widths.bend))) {
      add_bend(last, first.sources);
      return true;
    }
    division = std::clamp(division, min_part_fraction, 1 - min_part_fraction);
    // If the ends are close to each other, the border between them is nearly straight.
    BorderPoint point;
    point.height = first.height + division * (last.height - first.height);
    const double fraction = first.fraction + division * (last.fraction - first.fraction);
    if (!tracer_.find_point(fraction, point)) return false;
    const LabelledPoint between = tracer_.labelled(fraction, point);
    if (!find_bends_between(first, between, all)) return false;
    first = between;
  }
  return true;
}

/// Whether the border has no bend between two points. Next to a vertex at which paths turn, other places satisfy the
/// equations of a bend too.
bool BendSearch::has_no_bend_between(const LabelledPoint& first, const LabelledPoint& last) const {
  const double fraction = 0.5 * (first.fraction + last.fraction);
  const Vector2d base = tracer_.begin() + fraction * tracer_.chord();
  const auto [below, above] = tracer_.heights_within_face(base);
  const double height =
      tracer_.equidistant_height(first.sources, base, 0.5 * (first.height + last.height), below, above);
  return tracer_.is_on_border({fraction, height, base + height * tracer_.normal(), first.sources},
                              same_image * tracer_.size());
}

/// Whether the paths from one pseudo-source pass through the other one, so that the border stays smooth at the
/// transition.
bool BendSearch::is_smooth_transition(const PseudoSource& one, const PseudoSource& other) const {
  return std::abs(std::abs(one.distance - other.distance) - (one.place - other.place).norm()) <=
         same_image * tracer_.size();
}

/// Finds the transition by Newton's method: the place where the border with the pseudo-sources of `first` reaches the
/// places to which the pseudo-source of `last` is as near, for the site on `side` (0: left). A smooth transition lies
/// on the line through both pseudo-sources instead. Returns false if there is no such place in the face near the
/// border's ends.
bool BendSearch::find_transition(const LabelledPoint& first, const LabelledPoint& last, std::size_t side,
                                 LabelledPoint& transition) const {
  const PseudoSource& one = first.sources[side];
  const PseudoSource& other = last.sources[side];
  const PseudoSource& opposite = first.sources[1 - side];
  const bool smooth = is_smooth_transition(one, other);
  const Vector2d line_direction = (other.place - one.place).normalized();
  // The function whose sign changes at the transition.
  const auto residual = [&](const Vector2d& place) {
    return smooth ? cross(line_direction, place - one.place) : one.length_to(place) - other.length_to(place);
  };
  const double at_first = residual(first.place);
  const double at_last = residual(last.place);
  double fraction = at_first / (at_first - at_last);
  if (!(fraction > 0 && fraction < 1)) fraction = 0.5;
  Vector2d place = first.place + fraction * (last.place - first.place);
  for (int iteration = 0; iteration < max_transition_steps; ++iteration) {
    const Vector2d from_one = (place - one.place).normalized();
    const Vector2d gap_gradient = from_one - (place - opposite.place).normalized();
    const double gap = one.length_to(place) - opposite.length_to(place);
    const Vector2d residual_gradient = smooth ? Vector2d(-line_direction.y(), line_direction.x())
                                              : Vector2d(from_one - (place - other.place).normalized());
    const double residual_here = residual(place);
    const double determinant = cross(gap_gradient, residual_gradient);
    if (determinant == 0) return false;
    const Vector2d step = Vector2d(residual_gradient.y() * gap - gap_gradient.y() * residual_here,
                                   gap_gradient.x() * residual_here - residual_gradient.x() * gap) /
                          -determinant;
    place += step;
    if (!((place - tracer_.begin()).squaredNorm() < 4 * tracer_.length() * tracer_.length())) return false;
    if (step.squaredNorm() > curve_rounding * curve_rounding * tracer_.size() * tracer_.size()) continue;
    transition.fraction = (place - tracer_.begin()).dot(tracer_.chord()) / (tracer_.length() * tracer_.length());
    transition.height = (place - tracer_.begin()).dot(tracer_.normal());
    transition.place = place;
    transition.sources = first.sources;
    // Lengths are defined beyond the face too, where they may be equal at other places.
    const auto [below, above] = tracer_.heights_within_face(tracer_.begin() + transition.fraction * tracer_.chord());
    return transition.height > below && transition.height < above;
  }
  return false;
}

}  // namespace supple::voronoi
