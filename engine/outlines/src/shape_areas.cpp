#include "shape_areas.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace supple::outlines {
namespace {

/// Smallest area of an outline, in squares of the tolerance.
constexpr double min_area_in_tolerances = 1;
/// Distance below which sides touch, in tolerances.
constexpr double contact_distance = 1e-4;

double largest_coordinate(const RawDrawing& drawing) {
  double largest = 1e-9;
  for (const Curve& curve : drawing.curves) {
    largest = std::max(largest, curve.begin.cwiseAbs().maxCoeff());
    for (const Piece& piece : curve.pieces)
      for_each_control_point(piece,
                             [&largest](const Point& p) { largest = std::max(largest, p.cwiseAbs().maxCoeff()); });
  }
  return largest;
}

}  // namespace

ShapeAreas::ShapeAreas(const RawDrawing& drawing, double tolerance, const Execution& execution)
    : tolerance_(tolerance), execution_(execution), arithmetic_(tolerance, largest_coordinate(drawing)) {}

double ShapeAreas::min_area() const { return min_area_in_tolerances * tolerance_ * tolerance_; }

bool ShapeAreas::is_tiny(const Points& points) const {
  return points.size() < 3 || std::abs(area_of(points)) < min_area();
}

void ShapeAreas::drop_tiny(Shape& shape, Shapes& result) const {
  const auto dropped = std::erase_if(shape.polygons, [this](const Points& points) { return is_tiny(points); });
  for (std::size_t k = 0; k < dropped; ++k) result.leave_out_tiny(shape.curve->description);
}

std::vector<std::pair<std::size_t, std::size_t>> ShapeAreas::contacts(const std::vector<const Points*>& polygons,
                                                                      const std::vector<std::size_t>& owners) const {
  return outlines::contacts(polygons, owners, contact_distance * tolerance_, execution_);
}

bool ShapeAreas::has_contacts(const Shape& shape) const {
  const double distance = contact_distance * tolerance_;
  const auto itself = [&](const Points& points) { return touches_itself(points, distance, execution_); };
  if (std::any_of(shape.polygons.begin(), shape.polygons.end(), itself)) return true;
  if (shape.polygons.size() < 2) return false;
  std::vector<const Points*> polygons;
  for (const Points& points : shape.polygons) polygons.push_back(&points);
  std::vector<std::size_t> owners(polygons.size());
  std::iota(owners.begin(), owners.end(), 0U);
  return !contacts(polygons, owners).empty();
}

bool ShapeAreas::overlap(const Shape& a, const Shape& b) const {
  const double both = AreaArithmetic::size(arithmetic_.intersection(a.polygons, b.polygons));
  if (both <= min_area()) return false;
  const double first = AreaArithmetic::size(arithmetic_.filled(a.polygons, FillRule::evenodd));
  const double second = AreaArithmetic::size(arithmetic_.filled(b.polygons, FillRule::evenodd));
  return both < std::min(first, second) * (1 - area_difference);
}

}  // namespace supple::outlines
