#include "areas.h"

#include <algorithm>
#include <cmath>
#include <polyclipping/clipper.hpp>

#include "polygon_measures.h"

namespace supple::outlines {
namespace {

/// Number of rounding steps per tolerance.
constexpr double steps_per_tolerance = 1e5;
/// Limit of the coordinates in rounding steps; Clipper's own limit is 2^62.
constexpr double max_clipper_coordinate = 1e18;

ClipperLib::Paths paths_of(const std::vector<Points>& polygons, double steps_per_unit) {
  ClipperLib::Paths paths;
  for (const Points& polygon : polygons) {
    ClipperLib::Path& path = paths.emplace_back();
    for (const Point& p : polygon)
      path.emplace_back(std::llround(p.x() * steps_per_unit), std::llround(p.y() * steps_per_unit));
  }
  return paths;
}

Area area_of_paths(const ClipperLib::Paths& paths, double steps_per_unit) {
  Area area;
  for (const ClipperLib::Path& path : paths) {
    Points& polygon = area.emplace_back();
    for (const ClipperLib::IntPoint& p : path)
      polygon.emplace_back(static_cast<double>(p.X) / steps_per_unit, static_cast<double>(p.Y) / steps_per_unit);
  }
  return area;
}

ClipperLib::Paths combined(const ClipperLib::Paths& a, const ClipperLib::Paths& b, ClipperLib::ClipType type,
                           ClipperLib::PolyFillType rule) {
  ClipperLib::Clipper clipper;
  clipper.StrictlySimple(true);
  clipper.AddPaths(a, ClipperLib::ptSubject, true);
  clipper.AddPaths(b, ClipperLib::ptClip, true);
  ClipperLib::Paths result;
  clipper.Execute(type, result, rule, rule);
  return result;
}

}  // namespace

AreaArithmetic::AreaArithmetic(double tolerance, double largest_coordinate)
    : steps_per_unit_(
          std::min(steps_per_tolerance / tolerance, max_clipper_coordinate / std::max(largest_coordinate, 1e-300))) {}

Area AreaArithmetic::filled(const std::vector<Points>& polygons, FillRule rule) const {
  const auto type = rule == FillRule::evenodd ? ClipperLib::pftEvenOdd : ClipperLib::pftNonZero;
  return area_of_paths(combined(paths_of(polygons, steps_per_unit_), {}, ClipperLib::ctUnion, type), steps_per_unit_);
}

Area AreaArithmetic::united(const std::vector<Points>& a, const std::vector<Points>& b) const {
  return area_of_paths(
      combined(paths_of(a, steps_per_unit_), paths_of(b, steps_per_unit_), ClipperLib::ctUnion, ClipperLib::pftEvenOdd),
      steps_per_unit_);
}

Area AreaArithmetic::intersection(const std::vector<Points>& a, const std::vector<Points>& b) const {
  return area_of_paths(combined(paths_of(a, steps_per_unit_), paths_of(b, steps_per_unit_), ClipperLib::ctIntersection,
                                ClipperLib::pftEvenOdd),
                       steps_per_unit_);
}

double AreaArithmetic::size(const Area& area) {
  double sum = 0;
  for (const Points& polygon : area) sum += area_of(polygon);
  return sum;
}

}  // namespace supple::outlines
