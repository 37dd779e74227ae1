#pragma once

#include <memory>
#include <vector>

#include "curve.h"

namespace supple::outlines {

/// A region of the plane, bounded by polygons that neither cross nor touch each other or themselves; outer ones run
/// counterclockwise and holes clockwise.
using Area = std::vector<Points>;

/// Boolean operations on areas by Clipper, which rounds coordinates to integers.
class AreaArithmetic {
 public:
  /// `largest_coordinate` bounds the absolute values of all coordinates. These are rounded to a small fraction of
  /// `tolerance`.
  AreaArithmetic(double tolerance, double largest_coordinate);

  /// The area that a rule fills between polygons, which may cross each other and themselves.
  Area filled(const std::vector<Points>& polygons, FillRule rule) const;
  Area united(const std::vector<Points>& a, const std::vector<Points>& b) const;
  Area intersection(const std::vector<Points>& a, const std::vector<Points>& b) const;

  /// The size of the area without its holes.
  static double size(const Area& area);

 private:
  double steps_per_unit_;
};

}  // namespace supple::outlines
