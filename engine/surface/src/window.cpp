#include "window.h"

namespace supple::surface {
namespace {

/// Whether the loser, which is longer at both ends a and b of the overlap, is also longer everywhere between.
///
/// Along a line, the difference of the distances to two points S and T has one extremum: where the line meets the line
/// through S and T. The window of larger sigma can be shorter only in the middle, and then it is so at the extremum.
bool loses_between(const Window& loser, const Window& winner, double a, double b) {
  const double depth_gap = winner.depth - loser.depth;
  if (loser.sigma <= winner.sigma || depth_gap == 0) return true;
  const double extremum = loser.source_x + (loser.source_x - winner.source_x) * loser.depth / depth_gap;
  if (!(extremum > a && extremum < b)) return true;
  return length_at(loser, extremum) > length_at(winner, extremum);
}

/// A point between a and b where the lengths through p and w are equal, if one is shorter at a and the other one at b.
double bisect(const Window& p, const Window& w, double a, double b) {
  const bool p_shorter_at_a = length_at(p, a) < length_at(w, a);
  for (int i = 0; i < 60 && b - a > 1e-16 * (std::abs(a) + std::abs(b)); ++i) {
    const double middle = 0.5 * (a + b);
    ((length_at(p, middle) < length_at(w, middle)) == p_shorter_at_a ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

}  // namespace

void trim_by_ends(Window& p, Window& w, const Crossing& equal, double a, double b) {
  const double at_a = length_at(p, a) - length_at(w, a);
  const double at_b = length_at(p, b) - length_at(w, b);
  if (at_a <= 0 && at_b <= 0) {
    if (loses_between(w, p, a, b)) remove_overlap(w, a, b);
    return;
  }
  if (at_a >= 0 && at_b >= 0) {
    if (loses_between(p, w, a, b)) remove_overlap(p, a, b);
    return;
  }
  double crossing = -1;
  if (equal.qa < 0 && equal.root_squared >= 0) {
    for (const double sign : {1.0, -1.0}) {
      const double u = equal.solution(sign);
      if (u >= 0 && u <= b - a && equal.c * (equal.alpha * u + equal.beta) >= 0) crossing = a + u;
    }
  }
  if (!(crossing >= a) ||
      std::abs(length_at(p, crossing) - length_at(w, crossing)) > drop_tolerance * length_at(p, crossing)) {
    crossing = bisect(p, w, a, b);  // cancellation has spoiled the closed form
  }
  Window& left = at_a < 0 ? p : w;
  Window& right = at_a < 0 ? w : p;
  // The rays of both windows through the crossing have to cross each other beyond the edge. Otherwise a gap would open
  // between the windows, and both keep the overlap.
  if ((crossing - left.source_x) * hypotenuse(crossing - right.source_x, right.depth) <
      (crossing - right.source_x) * hypotenuse(crossing - left.source_x, left.depth)) {
    return;
  }
  divide_overlap(left, right, crossing, a, b);
}

}  // namespace supple::surface
