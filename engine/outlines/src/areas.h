#pragma once

#include <memory>
#include <vector>

#include "curve.h"

namespace supple::outlines {

/// The area between polygons, which neither cross nor touch each other or themselves; outer ones run counterclockwise
/// and holes clockwise.
using Area = std::vector<Points>;

/// Computes with areas, whose coordinates are rounded to `step`, by Clipper's integers.
class AreaArithmetic {
 public:
  /// For coordinates up to `largest` in absolute value, at an accuracy of a small fraction of `tolerance`.
  AreaArithmetic(double tolerance, double largest);

  /// What a rule fills between polygons of any kind.
  Area filled(const std::vector<Points>& polygons, FillRule rule) const;
  Area united(const std::vector<Points>& a, const std::vector<Points>& b) const;
  Area common(const std::vector<Points>& a, const std::vector<Points>& b) const;

  static double size(const Area& area);

 private:
  double per_unit_;
};

}  // namespace supple::outlines
