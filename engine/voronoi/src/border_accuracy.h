#pragma once

#include <limits>

namespace supple::voronoi {

/// Required accuracy of the parts of borders within a face.
struct BorderAccuracy {
  /// Maximum quadrature error of the area between a part of a border and its chord, in squared mesh units.
  double area = 0;
  /// Maximum distance between a border and the polyline by which it is drawn, in mesh units.
  double deviation = std::numeric_limits<double>::infinity();
  /// Parts of borders no farther than this from their chords may have bends that are not searched for, in mesh units.
  double bulge = 0;
};

}  // namespace supple::voronoi
