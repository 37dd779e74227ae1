#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "supple/outlines/drawing.h"

namespace supple::outlines::testing {

inline constexpr double pi = std::numbers::pi;

/// Signed: positive for counterclockwise outlines.
inline double area(const Outline& outline) {
  double twice = 0;
  const auto& c = outline.corners;
  for (std::size_t k = 0; k < c.size(); ++k) {
    const Eigen::Vector2d &p = c[k], &q = c[(k + 1) % c.size()];
    twice += p.x() * q.y() - p.y() * q.x();
  }
  return twice / 2;
}

/// The greatest distance of a corner from a circle.
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
