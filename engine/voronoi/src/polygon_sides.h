#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

namespace supple::voronoi {

/// A side of a convex polygon in a face: the numbers of its cuts, their positions as fractions of the side, and the
/// sites of the parts between them.
struct Side {
  Eigen::Vector2d from, to;
  std::vector<std::int32_t> cuts;
  std::vector<double> fractions;
  std::vector<std::int32_t> sites;
};

/// The sides of a convex polygon, counterclockwise.
using Sides = std::vector<Side>;

/// A place on the boundary of a polygon.
struct BoundaryPlace {
  std::size_t side = 0;
  double fraction = 0;
};

/// A corner of a polygon, or a cut of one of its sides.
struct BoundaryVertex {
  Eigen::Vector2d place;
  std::int32_t cut = 0;    ///< number of the cut, or `corner`
  std::int32_t site = -1;  ///< site of the boundary that follows it
  static constexpr std::int32_t corner = std::numeric_limits<std::int32_t>::min();
};

/// The same side in the opposite direction.
Side reversed(const Side& side);
/// The parts of a side before and after a fraction of it.
std::pair<Side, Side> split(const Side& side, double at);

/// Chooses a chord between two arcs of the boundary that are not neighbours, preferably of one site, because the chord
/// may then lie in its cell alone. Returns false if there is none.
bool choose_chord(const Sides& sides, BoundaryPlace& begin, BoundaryPlace& end);

/// Chooses the chord from the middle of the longest side to the middle of the side that is farthest from the longest
/// one.
void choose_middle_chord(const Sides& sides, double longest, BoundaryPlace& begin, BoundaryPlace& end);

}  // namespace supple::voronoi
