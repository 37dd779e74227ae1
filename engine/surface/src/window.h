#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "window_trail.h"

namespace supple::surface {

/// A bundle of shortest-path candidates that cross one edge in an interval and come straight from one (pseudo-)source.
///
/// It belongs to the halfedge of the face that it is about to enter. In that halfedge's planar frame (tail at the
/// origin, head on the positive x axis, face above) the interval is [b0, b1] and the source, unfolded, is at
/// (source_x, -depth). A path through x in the interval has length sigma + |source - (x, 0)|: Mitchell, Mount and
/// Papadimitriou 1987.
struct Window {
  double b0, b1;
  double source_x, depth;
  double sigma;  ///< distance from the nearest true source to the pseudo-source
  Trail trail;
  std::int32_t link;    ///< pool index of the next window of the same halfedge; of a kept window, that halfedge
  std::int32_t origin;  ///< the vertex that is the pseudo-source, or -1 - i for the i-th source point
};

/// The (pseudo-)source of a window in the frame of its halfedge.
struct WindowSource {
  double x, depth;
};

/// The same source in the frame of the edge that the window goes on to, whose unit direction is (ux, uy) in the frame
/// of the edge that it has come by. Used by the search and by whoever follows a path back, so that both see the same
/// bits.
inline WindowSource seen_from_left(const WindowSource& source, double ux, double uy) {
  return {source.x * ux - source.depth * uy, std::max(0.0, source.x * uy + source.depth * ux)};
}
inline WindowSource seen_from_right(const WindowSource& source, double apex_x, double apex_y, double ux, double uy) {
  const double reach = source.depth + apex_y;
  return {(source.x - apex_x) * ux + reach * uy, std::max(0.0, (apex_x - source.x) * uy + reach * ux)};
}

/// x moved into [low, high], without branches.
inline double clamped(double x, double low, double high) { return std::max(low, std::min(x, high)); }

inline double hypotenuse(double x, double y) { return std::sqrt(x * x + y * y); }

inline double squared_radius(const Window& w, double x) {
  return (x - w.source_x) * (x - w.source_x) + w.depth * w.depth;
}
inline double length_at(const Window& w, double x) { return w.sigma + std::sqrt(squared_radius(w, x)); }

/// Length of the shortest path to (x, y), y >= 0, through the window's interval; `crossing` is where it crosses.
inline double length_to(const Window& w, double x, double y, double& crossing) {
  const double total = w.depth + y;
  crossing = total > 0 ? w.source_x + (x - w.source_x) * (w.depth / total) : x;
  if (crossing >= w.b0 && crossing <= w.b1) return w.sigma + hypotenuse(x - w.source_x, total);
  crossing = crossing < w.b0 ? w.b0 : w.b1;
  return length_at(w, crossing) + hypotenuse(x - crossing, y);
}

/// A window or part of one is dropped only where it is longer than what replaces it by this much, relative: overlaps
/// cost a little time, gaps would cost correctness.
inline constexpr double kDropTolerance = 1e-12;
/// And by this much of the edge that it crosses.
inline constexpr double kEdgeRounding = 1e-14;
/// Windows narrower than this fraction of their edge are dropped: a few units in the last place of a coordinate.
inline constexpr double kLeastWidth = 2e-15;

/// What the two end vertices of an edge say: at x no path needs to be longer than `tail` + x or `head` + length - x,
/// measured beyond a window's sigma (and shrunk where an error is allowed).
struct VertexBounds {
  double tail;
  double head;
};

/// |S - x| > limit, without a root.
inline bool farther(const Window& w, double x, double limit) {
  return limit < 0 || squared_radius(w, x) > limit * limit;
}

/// What cut() has done: which end vertices have taken over a part, and whether anything is left.
struct Cut {
  bool by_tail = false;
  bool by_head = false;
  bool dead = false;
};

/// Trims the window to where it beats both vertices of its edge of the given length. Each boundary has a linear root:
/// |S - x| - x decreases and |S - x| + x increases along the edge.
[[gnu::always_inline]] inline Cut cut(Window& w, const VertexBounds& bounds, double length) {
  const double from_head = bounds.head + length;
  if (farther(w, w.b1, bounds.tail + w.b1)) return {.by_tail = true, .dead = true};
  if (farther(w, w.b0, from_head - w.b0)) return {.by_head = true, .dead = true};
  Cut result{farther(w, w.b0, bounds.tail + w.b0), farther(w, w.b1, from_head - w.b1), false};
  if (!result.by_tail && !result.by_head) return result;
  const double square = w.source_x * w.source_x + w.depth * w.depth;
  if (result.by_tail) {
    // |S - x| = x + k
    const double k = bounds.tail;
    const double root = (square - k * k) / (2 * (k + w.source_x));
    if (root > w.b0) w.b0 = std::min(root, w.b1);
  }
  if (result.by_head) {
    // |S - x| = m - x
    const double root = (from_head * from_head - square) / (2 * (from_head - w.source_x));
    if (root < w.b1) w.b1 = std::max(root, w.b0);
  }
  result.dead = !(w.b1 - w.b0 > kLeastWidth * length);
  return result;
}

/// Takes [a, b], the overlap, from a window that loses all of it; leaves it where that would cut the window in two.
inline void give_up(Window& loser, double a, double b) {
  if (loser.b0 >= a && loser.b1 <= b)
    loser.b1 = loser.b0;
  else if (loser.b0 >= a)
    loser.b0 = b;
  else if (loser.b1 <= b)
    loser.b1 = a;
}

/// Gives each window its side of the crossing; parts beyond the overlap stay.
inline void share(Window& left, Window& right, double crossing, double a, double b) {
  left.b1 = left.b1 <= b ? crossing : left.b1;
  right.b0 = right.b0 >= a ? crossing : right.b0;
}

/// Where the sigmas differ by more than the sources' offsets along the edge (by less than this times more), the
/// crossings are two or none, or rounding decides which.
inline constexpr double kOneCrossing = 1e-6;

/// Of two lengths that differ by less, relative, the one of smaller sigma counts as the shorter.
inline constexpr double kTieBias = 1e-13;

/// What the squared distance of an unfolded source is known to, relative: it has been turned from edge to edge.
inline constexpr double kSquareRounding = 2e-15;

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
    const double to_p = px * px + p.depth * p.depth;
    const double to_w = wx * wx + w.depth * w.depth;
    beta = to_p - to_w - c * c;
    rounding = kSquareRounding * (to_p + to_w);
    qa = alpha * alpha - 4 * c * c;
    const double middle = beta + alpha * wx;
    square = middle * middle + qa * w.depth * w.depth;
  }
  /// Either solution of the quadratic. One that solves the equation before squaring has c (alpha u + beta) >= 0.
  double solution(double sign) const { return (sign * 2 * c * std::sqrt(square) - alpha * beta - 4 * c * c * wx) / qa; }

  double c, wx, alpha, beta, qa, square;
  double rounding;  ///< of beta
};

/// The less common case: tells by the lengths at the ends of the overlap.
void trim_by_ends(Window& p, Window& w, const Crossing& equal, double a, double b);

/// Trims p and w to their lower envelope (b0 and b1 only) where they overlap; where that would split one of them in
/// two, leaves the overlap. A trimmed-away window gets b1 <= b0. Never drops a part that the other does not cover with
/// a shorter length.
inline void trim_to_envelope(Window& p, Window& w) {
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
  // One source, seen past both sides of a vertex that is nearly flat: if nothing but rounding tells the two apart, the
  // wider one stays. Each might otherwise lose to the other beside the vertex, on an edge of its own, and nobody would
  // go on behind the vertex.
  if (p.origin == w.origin && equal.rounding > std::abs(equal.alpha) * (b - a) &&
      std::abs(equal.beta) < 2 * equal.rounding) {
    if (w.b0 >= p.b0 && w.b1 <= p.b1) {
      w.b1 = w.b0;
      return;
    }
    if (p.b0 >= w.b0 && p.b1 <= w.b1) {
      p.b1 = p.b0;
      return;
    }
  }
  if (crossing <= a)
    give_up(left, a, b);
  else if (crossing >= b)
    give_up(right, a, b);
  else
    share(left, right, crossing, a, b);
}

}  // namespace supple::surface
