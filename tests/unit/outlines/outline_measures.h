#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "supple/outlines/drawing.h"

namespace supple::outlines::testing {

inline constexpr double pi = std::numbers::pi;

/// The area of an outline, positive if it runs counterclockwise.
inline double area(const Outline& outline) {
  double twice = 0;
  const auto& c = outline.corners;
  for (std::size_t k = 0; k < c.size(); ++k) {
    const Eigen::Vector2d &p = c[k], &q = c[(k + 1) % c.size()];
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return twice / 2;
}

/// The area within an odd number of a drawing's outlines, none of which cross.
inline double even_odd_area(const Drawing& drawing) {
  const auto inside = [](const Outline& outline, const Eigen::Vector2d& p) {
    bool result = false;
    const auto& c = outline.corners;
    for (std::size_t k = 0; k < c.size(); ++k) {
      const Eigen::Vector2d &a = c[k], &b = c[(k + 1) % c.size()];
      if ((a.y() > p.y()) != (b.y() > p.y()) && p.x() < a.x() + (p.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x()))
        result = !result;
    }
    return result;
  };
  double sum = 0;
  for (const Outline& outline : drawing.outlines) {
    int around = 0;
    // A point inside, very near to a side, so that corners shared with other outlines do not matter.
    const Eigen::Vector2d a = outline.corners[0], b = outline.corners[1];
    const Eigen::Vector2d left(-(b - a).y(), (b - a).x());
    const Eigen::Vector2d p = (a + b) / 2 + (area(outline) > 0 ? 1e-6 : -1e-6) * left.normalized();
    for (const Outline& other : drawing.outlines) around += &other != &outline && inside(other, p) ? 1 : 0;
    sum += (around % 2 == 0 ? 1 : -1) * std::abs(area(outline));
  }
  return sum;
}

/// The largest distance of a corner from a circle.
inline double off_circle(const Outline& outline, const Eigen::Vector2d& centre, double radius) {
  double most = 0;
  for (const auto& p : outline.corners) most = std::max(most, std::abs((p - centre).norm() - radius));
  return most;
}

inline bool warns_of(const Drawing& drawing, const std::string& words) {
  return std::any_of(drawing.warnings.begin(), drawing.warnings.end(),
                     [&](const std::string& warning) { return warning.find(words) != std::string::npos; });
}

}  // namespace supple::outlines::testing
