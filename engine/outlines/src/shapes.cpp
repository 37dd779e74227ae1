#include "shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <utility>

#include "shape_areas.h"

namespace supple::outlines {
namespace {

/// Distance below which corners are merged, in tolerances.
constexpr double min_corner_distance = 1e-3;
/// Number of corners above which an outline is simplified.
constexpr std::size_t max_corners_not_simplified = 1'000;
/// Relative difference between the area of a joined outline and the sum of what its open curves fill one by one, above
/// which a warning is given.
constexpr double max_filling_difference = 0.01;

class ShapeMaker {
 public:
  ShapeMaker(const RawDrawing& drawing, double tolerance, const Execution& execution)
      : drawing_(drawing), tolerance_(tolerance), execution_(execution), areas_(drawing, tolerance, execution) {}

  Shapes make() {
    std::vector<Polyline> polylines = flattened();
    Chains chains = joined(polylines, tolerance_, execution_);
    result_.duplicate_lines = chains.duplicates.size();
    for (const std::size_t k : chains.duplicates)
      result_.leave_out(polylines[k].source->description, "it lies over another line");
    warn_of_branches(chains);
    close(polylines, chains);
    unite_crossing(result_, areas_);
    return std::move(result_);
  }

 private:
  std::vector<Polyline> flattened() {
    Flattener flattener(tolerance_);
    std::vector<Polyline> polylines;
    polylines.reserve(drawing_.curves.size());
    for (std::size_t i = 0; i < drawing_.curves.size(); ++i) {
      if (i % curves_between_checks == 0) execution_.cancellation.throw_if_requested();
      const Curve& curve = drawing_.curves[i];
      // Large curves are simplified later, for which half of the tolerance is left.
      flattener.set_tolerance(curve.pieces.size() > max_corners_not_simplified ? tolerance_ / 2 : tolerance_);
      Points points = flattener.flatten(curve);
      const double error = flattener.take_chord_error();
      if (points.size() < 2) {
        result_.leave_out(curve.description, "it has no length");
        continue;
      }
      polylines.push_back({std::move(points), curve.closed, &curve, 1, error});
    }
    return polylines;
  }

  void warn_of_branches(const Chains& chains) {
    if (chains.branches.empty()) return;
    std::string words;
    for (std::size_t k = 0; k < std::min(chains.branches.size(), max_named_places); ++k) {
      const Point& p = chains.branches[k];
      words += (k == 0 ? "" : ", ") + ("(" + four_digits(p.x()) + ", " + four_digits(p.y()) + ")");
    }
    result_.warnings.push_back("More than two curves meet at " + words +
                               (chains.branches.size() > max_named_places ? " and elsewhere" : "") +
                               ": each of the areas between them is an outline.");
  }

  /// Makes shapes of closed polylines, and of filled curves that stay open.
  void close(const std::vector<Polyline>& polylines, Chains& chains) {
    std::vector<std::vector<Polyline>> elements;
    elements.reserve(chains.polylines.size());
    constexpr std::size_t none = SIZE_MAX;
    std::vector<std::size_t> element_indices;  // for each filled element, its index in `elements`
    std::set<std::size_t> across_groups(chains.across_groups.begin(), chains.across_groups.end());
    const auto add = [&](Polyline polyline) {
      const Curve& curve = *polyline.source;
      const bool is_single = polyline.curves == 1 && curve.is_filled;
      if (is_single && curve.element >= element_indices.size()) element_indices.resize(curve.element + 1, none);
      const std::size_t index = is_single ? element_indices[curve.element] : none;
      if (index != none) return elements[index].push_back(std::move(polyline));
      if (is_single) element_indices[curve.element] = elements.size();
      elements.emplace_back().push_back(std::move(polyline));
    };
    for (std::size_t k = 0; k < chains.polylines.size(); ++k) {
      Polyline& polyline = chains.polylines[k];
      if (polyline.closed) {
        if (polyline.curves > 1) warn_of_joined(polylines, chains.members[k], polyline, across_groups.contains(k));
        add(std::move(polyline));
        continue;
      }
      // Each filled curve is closed by a straight line, as browsers do it.
      for (const std::size_t member : chains.members[k]) {
        const Polyline& own = polylines[member];
        const Curve& curve = *own.source;
        if (curve.is_filled && std::abs(area_of(own.points)) >= areas_.min_area()) {
          Polyline closed = own;
          closed.closed = true;
          add(std::move(closed));
        } else {
          result_.open.push_back(own);
        }
      }
    }
    for (std::size_t k = 0; k < elements.size(); ++k) {
      if (k % curves_between_checks == 0) execution_.cancellation.throw_if_requested();
      add_element(elements[k]);
    }
  }

  void warn_of_joined(const std::vector<Polyline>& polylines, const std::vector<std::size_t>& members,
                      const Polyline& polyline, bool is_across_groups) {
    if (is_across_groups)
      result_.warnings.push_back("Curves of several layers or groups close together, at " +
                                 polyline.source->description + ".");
    double filled = 0;
    for (const std::size_t member : members) {
      if (!polylines[member].source->is_filled) return;
      filled += std::abs(area_of(polylines[member].points));
    }
    const double whole = std::abs(area_of(polyline.points));
    if (filled > areas_.min_area() && std::abs(filled - whole) > max_filling_difference * whole)
      result_.warnings.push_back("Curves that are filled one by one were joined to one outline, at " +
                                 polyline.source->description + ".");
  }

  /// Merges corners that coincide, and simplifies a polygon that has very many corners.
  void reduce_corners(Polyline& polyline) {
    drop_repeated(polyline.points, min_corner_distance * tolerance_);
    if (polyline.points.size() <= max_corners_not_simplified) {
      result_.chord_error = std::max(result_.chord_error, polyline.error);
      return;
    }
    const double remaining_tolerance = tolerance_ - polyline.error;
    Points simple = remaining_tolerance > 0 ? simplified(polyline.points, remaining_tolerance) : polyline.points;
    if (areas_.is_tiny(simple) || simple.size() == polyline.points.size()) {
      result_.chord_error = std::max(result_.chord_error, polyline.error);
      return;
    }
    result_.simplified += polyline.points.size() - simple.size();
    result_.chord_error = std::max(result_.chord_error, polyline.error + remaining_tolerance);
    polyline.points = std::move(simple);
  }

  void add_element(std::vector<Polyline>& loops) {
    const Curve& first = *loops[0].source;
    Shape shape{{}, first.names, &first};
    shape.polygons.reserve(loops.size());
    for (Polyline& loop : loops) {
      reduce_corners(loop);
      if (loop.curves > 1) {
        shape.curves += loop.curves;
        result_.joined += loop.curves;
      }
      if (loop.points.size() < 3) {
        result_.leave_out_tiny(loop.source->description);
      } else {
        shape.polygons.push_back(std::move(loop.points));
      }
    }
    if (shape.polygons.empty()) return;
    fill(shape, first.rule);
    apply_clip(shape, first.clip.get());
    areas_.drop_tiny(shape, result_);
    if (!shape.polygons.empty()) result_.shapes.push_back(std::move(shape));
  }

  /// Replaces what `rule` fills by polygons that do not cross or touch, for which the even-odd rule gives the same
  /// area.
  void fill(Shape& shape, FillRule rule) {
    areas_.drop_tiny(shape, result_);
    if (areas_.has_contacts(shape)) {
      shape.polygons = areas_.arithmetic().filled(shape.polygons, rule);
    } else if (rule == FillRule::nonzero && shape.polygons.size() > 1) {
      drop_inner_polygons(shape);
    }
  }

  /// Drops the polygons both of whose sides are filled by the nonzero rule.
  void drop_inner_polygons(Shape& shape) {
    std::vector<Box> boxes;
    std::vector<int> windings;
    for (const Points& points : shape.polygons) {
      boxes.push_back(box_of(points));
      windings.push_back(area_of(points) > 0 ? 1 : -1);
    }
    std::vector<std::size_t> retained;
    for (std::size_t i = 0; i < shape.polygons.size(); ++i) {
      if (i % curves_between_checks == 0) execution_.cancellation.throw_if_requested();
      int outer_winding = 0;
      for (std::size_t j = 0; j < shape.polygons.size(); ++j) {
        if (j != i && boxes[j].contains(boxes[i]) && is_inside(shape.polygons[j], shape.polygons[i][0]))
          outer_winding += windings[j];
      }
      if ((outer_winding == 0) == (outer_winding + windings[i] == 0)) {
        ++result_.inner_polygons;
        result_.leave_out(shape.curve->description,
                          "a curve of it lies within another one of the same direction, and both are filled (nonzero)");
      } else {
        retained.push_back(i);
      }
    }
    if (retained.size() == shape.polygons.size()) return;
    std::vector<Points> remaining;
    remaining.reserve(retained.size());
    for (const std::size_t i : retained) remaining.push_back(std::move(shape.polygons[i]));
    shape.polygons = std::move(remaining);
  }

  const Area& area_of_clip(const Clip& clip) {
    const auto [found, is_new] = clips_.try_emplace(&clip);
    if (!is_new) return found->second;
    Flattener flattener(tolerance_);
    std::map<std::size_t, std::vector<const Curve*>> elements;
    for (const Curve& curve : clip.curves) elements[curve.element].push_back(&curve);
    Area whole;
    for (const auto& [element, curves] : elements) {
      std::vector<Points> polygons;
      for (const Curve* curve : curves) polygons.push_back(flattener.flatten(*curve));
      Area own = areas_.arithmetic().filled(polygons, curves[0]->rule);
      if (curves[0]->clip) own = areas_.arithmetic().intersection(own, area_of_clip(*curves[0]->clip));
      whole = whole.empty() ? own : areas_.arithmetic().united(whole, own);
    }
    result_.chord_error = std::max(result_.chord_error, flattener.take_chord_error());
    if (clip.outer) whole = areas_.arithmetic().intersection(whole, area_of_clip(*clip.outer));
    return clips_[&clip] = std::move(whole);
  }

  void apply_clip(Shape& shape, const Clip* clip) {
    if (clip == nullptr) return;
    const Area& area = area_of_clip(*clip);
    Box box;
    for (const Points& points : shape.polygons) box.include(points);
    // A rectangle around the shape cuts nothing. Many programs write a clip path around the whole page.
    if (area.size() == 1 && area[0].size() == 4) {
      const Box page = box_of(area[0]);
      const Eigen::Vector2d sides = page.upper - page.lower;
      if (page.contains(box) && std::abs(area_of(area[0]) - sides.prod()) <= area_difference * sides.prod()) return;
    }
    const double before = AreaArithmetic::size(areas_.arithmetic().filled(shape.polygons, FillRule::evenodd));
    Area remaining = areas_.arithmetic().intersection(shape.polygons, area);
    const double after = AreaArithmetic::size(remaining);
    if (after >= before * (1 - area_difference)) return;
    ++result_.clipped;
    if (after <= areas_.min_area()) {
      result_.leave_out(shape.curve->description, "a clip path hides all of it");
      remaining.clear();
    }
    shape.polygons = std::move(remaining);
  }

  const RawDrawing& drawing_;
  double tolerance_;
  const Execution& execution_;
  ShapeAreas areas_;
  std::map<const Clip*, Area> clips_;
  Shapes result_;
};

}  // namespace

void Shapes::leave_out(const std::string& description, const char* reason) {
  ++left_out_count;
  if (left_out.size() < Drawing::max_left_out) left_out.push_back({description, reason});
}

void Shapes::leave_out_tiny(const std::string& description) {
  ++tiny;
  leave_out(description, "it has no area");
}

Box Shapes::box() const {
  Box box;
  for (const Shape& shape : shapes) {
    for (const Points& points : shape.polygons) box.include(points);
  }
  return box;
}

Shapes shapes_of(const RawDrawing& drawing, double tolerance, const Execution& execution) {
  return ShapeMaker(drawing, tolerance, execution).make();
}

}  // namespace supple::outlines
