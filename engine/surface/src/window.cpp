#include "window.h"

namespace supple::surface {
namespace {

/// Takes [a, b], the overlap, from a window that loses all of it; leaves it where that would cut the window in two.
void give_up(Window& loser, double a, double b) {
  if (loser.b0 >= a && loser.b1 <= b)
    loser.b1 = loser.b0;
  else if (loser.b0 >= a)
    loser.b0 = b;
  else if (loser.b1 <= b)
    loser.b1 = a;
}

/// Gives each window its side of the crossing; parts beyond the overlap stay.
void share(Window& left, Window& right, double crossing, double a, double b) {
  if (left.b1 <= b) left.b1 = crossing;
  if (right.b0 >= a) right.b0 = crossing;
}

/// Whether the loser at both ends a and b of the overlap also loses everywhere between.
///
/// Along a line, the difference of the distances to two points S and T has one extremum: where the line through S and T
/// meets it. The source of larger sigma can win only in the middle, and then at the extremum.
bool loses_between(const Window& loser, const Window& winner, double a, double b) {
  const double depth_gap = winner.depth - loser.depth;
  if (loser.sigma <= winner.sigma || depth_gap == 0) return true;
  const double extremum = loser.source_x + (loser.source_x - winner.source_x) * loser.depth / depth_gap;
  if (!(extremum > a && extremum < b)) return true;
  return length_at(loser, extremum) > length_at(winner, extremum);
}

/// Where lengths through p and w are equal between a and b, given that one is shorter at a and the other at b.
double bisect(const Window& p, const Window& w, double a, double b) {
  const bool p_shorter_at_a = length_at(p, a) < length_at(w, a);
  for (int i = 0; i < 60 && b - a > 1e-16 * (std::abs(a) + std::abs(b)); ++i) {
    const double middle = 0.5 * (a + b);
    ((length_at(p, middle) < length_at(w, middle)) == p_shorter_at_a ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

/// Where the sigmas differ by more than the sources' offsets along the edge (by less than this times more), the
/// crossings are two or none, or rounding decides which.
constexpr double kOneCrossing = 1e-6;

constexpr double kTieBias = 1e-13;

/// Where |P - x| - |W - x| = c: with u = x - a, squaring once gives alpha u + beta = 2 c |W - x|, and twice a quadratic
/// qa u^2 + 2 (alpha beta + 4 c^2 wx) u + ... = 0, whose discriminant factors into (2 c root)^2 and does not cancel.
struct Crossing {
  Crossing(const Window& p, const Window& w, double a) {
    // Where a path and its continuation by a vertex that it passes are equally long, the path keeps the vertex's ray:
    // the window of larger sigma must win by more than rounding.
    const double older = kTieBias * std::max(w.sigma, p.sigma);
    c = w.sigma - p.sigma;
    c += c > 0 ? older : c < 0 ? -older : 0;
    const double px = p.source_x - a;
    wx = w.source_x - a;
    alpha = 2 * (wx - px);
    beta = (px * px + p.depth * p.depth) - (wx * wx + w.depth * w.depth) - c * c;
    qa = alpha * alpha - 4 * c * c;
    const double middle = beta + alpha * wx;
    square = middle * middle + qa * w.depth * w.depth;
  }
  /// Either solution of the quadratic. One that solves the equation before squaring has c (alpha u + beta) >= 0.
  double solution(double sign) const { return (sign * 2 * c * std::sqrt(square) - alpha * beta - 4 * c * c * wx) / qa; }

  double c, wx, alpha, beta, qa, square;
};

/// The less common case: tells by the lengths at the ends of the overlap.
void trim_by_ends(Window& p, Window& w, const Crossing& equal, double a, double b) {
  const double at_a = length_at(p, a) - length_at(w, a);
  const double at_b = length_at(p, b) - length_at(w, b);
  if (at_a <= 0 && at_b <= 0) {
    if (loses_between(w, p, a, b)) give_up(w, a, b);
    return;
  }
  if (at_a >= 0 && at_b >= 0) {
    if (loses_between(p, w, a, b)) give_up(p, a, b);
    return;
  }
  double crossing = -1;
  if (equal.qa < 0 && equal.square >= 0) {
    for (const double sign : {1.0, -1.0}) {
      const double u = equal.solution(sign);
      if (u >= 0 && u <= b - a && equal.c * (equal.alpha * u + equal.beta) >= 0) crossing = a + u;
    }
  }
  if (!(crossing >= a) ||
      std::abs(length_at(p, crossing) - length_at(w, crossing)) > kDropTolerance * length_at(p, crossing)) {
    crossing = bisect(p, w, a, b);  // cancellation has spoiled the closed form
  }
  share(at_a < 0 ? p : w, at_a < 0 ? w : p, crossing, a, b);
}

}  // namespace

void trim_to_envelope(Window& p, Window& w) {
  const double a = std::max(p.b0, w.b0);
  const double b = std::min(p.b1, w.b1);
  if (!(b > a)) return;
  const Crossing equal(p, w, a);
  if (!(equal.qa > kOneCrossing * equal.alpha * equal.alpha)) return trim_by_ends(p, w, equal, a, b);
  // The offset of the sources outweighs their sigmas: p and w are equal exactly once on the whole line, and the source
  // further left wins left of it.
  const double u = equal.c == 0 ? -equal.beta / equal.alpha : equal.solution(std::copysign(1.0, equal.alpha));
  const double crossing = a + u;
  Window& left = equal.alpha > 0 ? p : w;
  Window& right = equal.alpha > 0 ? w : p;
  if (crossing <= a)
    give_up(left, a, b);
  else if (crossing >= b)
    give_up(right, a, b);
  else
    share(left, right, crossing, a, b);
}

}  // namespace supple::surface
