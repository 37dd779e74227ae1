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
  const Curve* source = nullptr;  ///< the curve of which it was made, or the first of them
  std::size_t curves = 1;         ///< of which it was made
  double error = 0;               ///< the largest distance of a chord from its curve
};

/// What came of joining.
struct Chains {
  std::vector<Polyline> polylines;   ///< closed ones, and open ones of several curves or one; by their first curve
  std::vector<std::size_t> doubled;  ///< indices of open polylines that lie over others
  std::vector<std::size_t> across;   ///< indices of polylines that closed with those of other groups
  std::vector<Point> branches;       ///< where more than two ends of closed areas meet
  std::vector<std::vector<std::size_t>> members;  ///< for each of `polylines`, the indices of what it was made of
};

/// Closes polylines whose ends meet, and joins open ones until they close. Ends meet if they lie within `reach` of each
/// other; those that lie much closer are joined first, so that short lines do not close by themselves. What hangs on a
/// closed chain with a free end, and lines over other lines, are not joined. Where chains branch, each of the areas
/// between them is a closed polyline. Lines of one group are joined first, then those of several. Polylines that are
/// closed already are moved into the result; the others remain. O(n log n) for n polylines, unless very many ends lie
/// in one place.
Chains joined(std::vector<Polyline>& polylines, double reach, const Execution& execution);

}  // namespace supple::outlines
