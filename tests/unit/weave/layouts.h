#pragma once

#include <Eigen/Core>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "supple/weave/weave.h"

namespace supple::weave {

inline Strand line(Eigen::Vector2d from, Eigen::Vector2d to, double radius = 0.25) {
  return {StrandCurve({from, to}, Ends::open), radius};
}

/// A strand through `count` points of an arc about the origin, with the last point at the end of the angle `sweep`
/// (rad).
inline Strand arc(double radius, double sweep, int count = 24) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double angle = sweep * i / (count - 1);
    points.emplace_back(radius * std::cos(angle), radius * std::sin(angle));
  }
  return {StrandCurve(points, Ends::open)};
}

inline Strand circle(double radius, Eigen::Vector2d centre = {0, 0}, int count = 48) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    points.emplace_back(centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return {StrandCurve(points, Ends::closed)};
}

/// Two waves that cross three straight strands. The first crossing is fused, and at the others the wave slides.
inline Weave wavy() {
  Weave weave;
  weave.strands.push_back({StrandCurve({{-1, 0}, {3, 1}, {7, -1}, {11, 1}, {15, 0}}, Ends::open)});
  weave.strands.push_back({StrandCurve({{-1, 4}, {3, 5}, {7, 3}, {11, 4.5}, {15, 4}}, Ends::open)});
  for (const double x : {2.0, 7.0, 12.0}) weave.strands.push_back(line({x, -3}, {x + 0.5, 7}));
  weave.crossings = find_crossings(weave.strands);
  for (std::size_t c = 1; c < weave.crossings.size(); ++c) {
    weave.crossings[c].members[0].slides = true;
    weave.crossings[c].members[0].backward = 1.5;
    weave.crossings[c].members[0].forward = 1.2;
  }
  return weave;
}

}  // namespace supple::weave
