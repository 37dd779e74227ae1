#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

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
  double sigma;           ///< distance from the nearest true source to the pseudo-source
  std::int32_t parent;    ///< pool index of the window that this one continues, -1 if it left the source itself
  std::int32_t next;      ///< pool index of the next window of the same halfedge
  std::int32_t origin;    ///< the vertex that is the pseudo-source, or -1 - i for the i-th source point
  std::int32_t halfedge;  ///< -1 while free
};

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

/// Trims p and w to their lower envelope (b0 and b1 only) where they overlap; where that would split one of them in
/// two, leaves the overlap. A trimmed-away window gets b1 <= b0. Never drops a part that the other does not cover with
/// a shorter length.
void trim_to_envelope(Window& p, Window& w);

}  // namespace supple::surface
