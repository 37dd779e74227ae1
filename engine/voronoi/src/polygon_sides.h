#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace supple::voronoi {

/// A side of a convex polygon of a face: its cuts, by their number, and the sites between them.
struct Side {
  Eigen::Vector2d from, to;
  std::vector<std::int32_t> cuts;
  std::vector<double> shares;
  std::vector<std::int32_t> sites;
};

/// The sides of a convex polygon, counterclockwise.
using Sides = std::vector<Side>;

/// A place on a polygon's border.
struct BorderPlace {
  std::size_t side = 0;
  double share = 0;
};

/// A corner of a polygon, or a cut of one of its sides.
struct BoundaryVertex {
  Eigen::Vector2d place;
  std::int32_t cut = 0;    ///< number of the cut, `corner` for a corner
  std::int32_t site = -1;  ///< the site that the boundary after it belongs to
  static constexpr std::int32_t corner = std::numeric_limits<std::int32_t>::min();
};

Side reversed(const Side& side);
/// The parts of a side before and after a share of it.
std::pair<Side, Side> split(const Side& side, double at);

/// The straight line between two arcs of the border that are not neighbours: of the same site if there are such, so
/// that nothing but that site may lie on it. False where there are none.
bool choose_chord(const Sides& sides, BorderPlace& begin, BorderPlace& end);

/// The straight line from the middle of the longest side to the corner or middle that is farthest from it along the
/// border.
void choose_middle(const Sides& sides, double longest, BorderPlace& begin, BorderPlace& end);

}  // namespace supple::voronoi
