#pragma once

#include <string>
#include <vector>

#include "curve.h"
#include "supple/base/execution.h"

namespace supple::outlines {

/// A curve that became a polyline.
struct Polyline {
  Points points;
  bool closed = false;
  std::vector<std::string> names;
  std::string group, what;
  std::size_t curves = 1;  ///< of which it was made
};

/// Joins open polylines of one group whose ends lie within `reach` of each other, the nearest ends first, and closes
/// those that come back to where they began. The polylines keep the order of their first curves. O(n log n) for n
/// polylines, unless very many ends lie in one place.
std::vector<Polyline> joined(std::vector<Polyline> polylines, double reach, const Execution& execution);

}  // namespace supple::outlines
