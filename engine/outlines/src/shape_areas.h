#pragma once

#include "areas.h"
#include "shapes.h"

namespace supple::outlines {

/// Relative difference below which areas are equal.
inline constexpr double area_difference = 1e-6;
/// Number of places that a warning names.
inline constexpr std::size_t max_named_places = 3;

/// Areas of shapes at a tolerance.
class ShapeAreas {
 public:
  ShapeAreas(const RawDrawing& drawing, double tolerance, const Execution& execution);

  double tolerance() const { return tolerance_; }
  const Execution& execution() const { return execution_; }
  const AreaArithmetic& arithmetic() const { return arithmetic_; }

  /// The smallest area of an outline.
  double min_area() const;
  bool is_tiny(const Points& points) const;
  /// Drops polygons that are tiny, and counts them in the result.
  void drop_tiny(Shape& shape, Shapes& result) const;
  /// The pairs i < j of polygons that have different owners and cross or touch each other.
  std::vector<std::pair<std::size_t, std::size_t>> contacts(const std::vector<const Points*>& polygons,
                                                            const std::vector<std::size_t>& owners) const;
  /// Whether a polygon of the shape crosses or touches itself or another one.
  bool has_contacts(const Shape& shape) const;
  /// Whether two shapes have an area in common, and neither contains the other.
  bool overlap(const Shape& a, const Shape& b) const;

 private:
  double tolerance_;
  const Execution& execution_;
  AreaArithmetic arithmetic_;
};

/// Drops polygons that lie over others, and unites the shapes of one group that cross.
void unite_crossing(Shapes& result, const ShapeAreas& areas);

}  // namespace supple::outlines
