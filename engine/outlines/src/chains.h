#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "curve.h"
#include "supple/base/execution.h"

namespace supple::outlines {

/// A curve that became a polyline.
struct Polyline {
  Points points;
  bool closed = false;
  const Curve* source = nullptr;  ///< its curve, or the first one of several
  std::size_t curves = 1;         ///< number of curves in it
  double error = 0;               ///< the largest distance of a chord from its curve
};

/// The result of joining polylines.
struct Chains {
  std::vector<Polyline> polylines;  ///< closed ones, and the open ones that remain; in the order of their first curves
  std::vector<std::size_t> duplicates;            ///< indices of open input polylines that lie over others
  std::vector<std::size_t> across_groups;         ///< indices in `polylines` of those that close only with other groups
  std::vector<Point> branches;                    ///< points where more than two chains around closed areas meet
  std::vector<std::vector<std::size_t>> members;  ///< for each of `polylines`, the indices of its input polylines
};

/// Closes polylines whose ends meet, and joins open ones until they close. Ends meet if they lie within `max_gap` of
/// each other; those that lie much closer are joined first, so that short lines do not close by themselves. A chain
/// with a free end is not joined to a closed one, and a line that lies over another one is dropped. Where chains
/// branch, each of the areas between them is a closed polyline. Lines of one group are joined first, then those of
/// several. Polylines that are closed already are moved into the result; the others stay in `polylines`. O(n log n) for
/// n polylines, unless very many ends lie in one place.
Chains joined(std::vector<Polyline>& polylines, double max_gap, const Execution& execution);

}  // namespace supple::outlines
