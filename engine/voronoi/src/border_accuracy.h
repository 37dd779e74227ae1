#pragma once

#include <limits>

namespace supple::voronoi {

/// How accurate the parts of borders within a face are to be.
struct BorderAccuracy {
  /// What quadrature may leave of the area between a part of a border and its straight line, in squared mesh units.
  double area = 0;
  /// The largest distance of a border from the straight lines by which it is drawn, in mesh units.
  double deviation = std::numeric_limits<double>::infinity();
  /// Parts of borders that are no farther from their straight lines may have bends that were not looked for.
  double bulge = 0;
};

}  // namespace supple::voronoi
