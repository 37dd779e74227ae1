#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "window_trail.h"

namespace supple::surface {

/// A bundle of candidates for shortest paths that cross one edge within an interval. They come straight from a source,
/// or from a pseudo-source: a vertex at which they have turned.
///
/// It belongs to the halfedge of the face that it is about to enter. In that halfedge's planar frame (tail at the
/// origin, head on the positive x axis, face above) the interval is [b0, b1], and the unfolded source is at
/// (source_x, -depth). A path through x in the interval has length sigma + |source - (x, 0)| [Mitchell1987].
struct Window {
  double b0, b1;
  double source_x, depth;
  double sigma;  ///< distance of the pseudo-source from the nearest source
  Trail trail;
  std::int32_t link;    ///< pool index of the next window of the same halfedge; in a logged window, that halfedge
  std::int32_t origin;  ///< the vertex that is the pseudo-source, or -1 - i for source point i
};

/// The (pseudo-)source of a window in the frame of its halfedge.
struct WindowSource {
  double x, depth;
};

/// The same source in the frame of the edge by which the window leaves the face. (ux, uy) is EdgeFrame::left_direction
/// or right_direction of the edge by which it has entered. The search and the backtrace of paths both call these
/// functions, so that their results have the same bits.
inline WindowSource source_across_left(const WindowSource& source, double ux, double uy) {
  return {source.x * ux - source.depth * uy, std::max(0.0, source.x * uy + source.depth * ux)};
}
inline WindowSource source_across_right(const WindowSource& source, double apex_x, double apex_y, double ux,
                                        double uy) {
  const double height = source.depth + apex_y;
  return {(source.x - apex_x) * ux + height * uy, std::max(0.0, (apex_x - source.x) * uy + height * ux)};
}

/// x clamped to [low, high], without branches.
inline double clamped(double x, double low, double high) { return std::max(low, std::min(x, high)); }

inline double hypotenuse(double x, double y) { return std::sqrt(x * x + y * y); }

inline double squared_radius(const Window& w, double x) {
  return (x - w.source_x) * (x - w.source_x) + w.depth * w.depth;
}
inline double length_at(const Window& w, double x) { return w.sigma + std::sqrt(squared_radius(w, x)); }

/// Length of the shortest path to (x, y), y >= 0, through the window's interval. `crossing` receives the coordinate at
/// which it crosses the edge.
inline double length_to(const Window& w, double x, double y, double& crossing) {
  const double total = w.depth + y;
  crossing = total > 0 ? w.source_x + (x - w.source_x) * (w.depth / total) : x;
  if (crossing >= w.b0 && crossing <= w.b1) return w.sigma + hypotenuse(x - w.source_x, total);
  crossing = crossing < w.b0 ? w.b0 : w.b1;
  return length_at(w, crossing) + hypotenuse(x - crossing, y);
}

/// A window, or a part of one, is dropped only where it is longer than what replaces it by this relative amount.
/// Overlaps cost a little time, while gaps would cost correctness.
inline constexpr double drop_tolerance = 1e-12;
/// The absolute part of that amount, as a fraction of the length of the edge that the window crosses.
inline constexpr double edge_rounding = 1e-14;
/// Minimum width of a window as a fraction of its edge, which is a few units in the last place of a coordinate.
/// Narrower windows are dropped.
inline constexpr double min_window_width = 2e-15;

/// Bounds from the distances of an edge's end vertices: no shortest path to x is longer than `tail` + x or
/// `head` + length - x, measured beyond a window's sigma. Where an error is allowed, they are smaller.
struct VertexBounds {
  double tail;
  double head;
};

/// Whether |S - x| > limit for the window's source S, without a square root.
inline bool farther(const Window& w, double x, double limit) {
  return limit < 0 || squared_radius(w, x) > limit * limit;
}

/// Result of cut(): which end vertices take over a part of the window, and whether nothing is left.
struct Cut {
  bool by_tail = false;
  bool by_head = false;
  bool empty = false;
};

/// Trims the window to the part where its paths are shorter than those by both vertices of its edge, which has the
/// given length. Each new end is the only root of a linear equation: along the edge, |S - x| - x decreases and
/// |S - x| + x increases.
[[gnu::always_inline]] inline Cut cut(Window& w, const VertexBounds& bounds, double length) {
  const double from_head = bounds.head + length;
  if (farther(w, w.b1, bounds.tail + w.b1)) return {.by_tail = true, .empty = true};
  if (farther(w, w.b0, from_head - w.b0)) return {.by_head = true, .empty = true};
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
  result.empty = !(w.b1 - w.b0 > min_window_width * length);
  return result;
}

/// Removes the overlap [a, b] from the window that is longer there. A window that this would cut in two stays as it is.
inline void remove_overlap(Window& loser, double a, double b) {
  if (loser.b0 >= a && loser.b1 <= b)
    loser.b1 = loser.b0;
  else if (loser.b0 >= a)
    loser.b0 = b;
  else if (loser.b1 <= b)
    loser.b1 = a;
}

/// Divides the overlap [a, b] between two windows at the crossing. Their parts beyond the overlap stay.
inline void divide_overlap(Window& left, Window& right, double crossing, double a, double b) {
  left.b1 = left.b1 <= b ? crossing : left.b1;
  right.b0 = right.b0 >= a ? crossing : right.b0;
}

/// Two windows are equally long at exactly one point of the edge's line if the offset of their sources along the edge
/// exceeds the difference of their sigmas. The squared offset has to exceed the squared difference by this fraction of
/// itself, which is safe from rounding.
inline constexpr double single_crossing_margin = 1e-6;

/// If two lengths differ by less than this relative amount, the one with the smaller sigma counts as the shorter one.
inline constexpr double tie_bias = 1e-13;

/// Relative rounding of the squared distance of a source that has been unfolded from edge to edge.
inline constexpr double squared_distance_rounding = 2e-15;

/// The points x at which windows p and w with the sources P and W are equally long: |P - x| - |W - x| = c. With
/// u = x - a, squaring once gives alpha u + beta = 2 c |W - x|, and squaring twice the quadratic equation
/// qa u^2 + 2 (alpha beta + 4 c^2 wx) u + ... = 0. Its discriminant factors into (2 c)^2 root_squared and does not
/// cancel.
struct Crossing {
  Crossing(const Window& p, const Window& w, double a) {
    // A straight path through a vertex is as long as the path that restarts there, and should win. Therefore the window
    // of larger sigma, which holds the restarted path, has to be shorter by more than rounding.
    const double bias = tie_bias * std::max(w.sigma, p.sigma);
    c = w.sigma - p.sigma;
    c += c > 0 ? bias : c < 0 ? -bias : 0;
    const double px = p.source_x - a;
    wx = w.source_x - a;
    alpha = 2 * (wx - px);
    const double p_squared = px * px + p.depth * p.depth;
    const double w_squared = wx * wx + w.depth * w.depth;
    beta = p_squared - w_squared - c * c;
    rounding = squared_distance_rounding * (p_squared + w_squared);
    qa = alpha * alpha - 4 * c * c;
    const double middle = beta + alpha * wx;
    root_squared = middle * middle + qa * w.depth * w.depth;
  }
  /// Either solution u. It solves the equation before squaring if c (alpha u + beta) >= 0.
  double solution(double sign) const {
    return (sign * 2 * c * std::sqrt(root_squared) - alpha * beta - 4 * c * c * wx) / qa;
  }

  double c, wx, alpha, beta, qa, root_squared;
  double rounding;  ///< rounding error of beta
};

/// Trims p and w in the less common case, according to their lengths at the ends a and b of the overlap.
void trim_by_ends(Window& p, Window& w, const Crossing& equal, double a, double b);

/// Trims p and w to their lower envelope where they overlap, by changing b0 and b1. If this would split one of them in
/// two, both keep the overlap. A window of which nothing is left gets b1 <= b0. A part is dropped only where the other
/// window is shorter.
inline void trim_to_envelope(Window& p, Window& w) {
  const double a = std::max(p.b0, w.b0);
  const double b = std::min(p.b1, w.b1);
  if (!(b > a)) return;
  const Crossing equal(p, w, a);
  if (!(equal.qa > single_crossing_margin * equal.alpha * equal.alpha)) return trim_by_ends(p, w, equal, a, b);
  // The windows are equally long at exactly one point of the line. Left of it, the one whose source is further left is
  // shorter.
  const double u = equal.c == 0 ? -equal.beta / equal.alpha : equal.solution(std::copysign(1.0, equal.alpha));
  const double crossing = a + u;
  Window& left = equal.alpha > 0 ? p : w;
  Window& right = equal.alpha > 0 ? w : p;
  // Windows of one source may have passed a nearly flat vertex on both sides. If they differ by rounding only, the
  // wider one stays. Otherwise each might lose to the other beside the vertex, on different edges, and none would
  // continue behind it.
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
    remove_overlap(left, a, b);
  else if (crossing >= b)
    remove_overlap(right, a, b);
  else
    divide_overlap(left, right, crossing, a, b);
}

}  // namespace supple::surface
