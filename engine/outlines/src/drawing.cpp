#include "supple/outlines/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>

#include "polygon_measures.h"
#include "reading.h"
#include "shapes.h"

namespace supple::outlines {
namespace {

/// Limit of the coordinates of parts, mm.
constexpr double max_part_coordinate = 2000;
/// Number of open curves, and of elements that were left out, that a message names one by one.
constexpr std::size_t max_named = 3;

std::string counted(std::size_t count, const char* one, const char* many) {
  return std::to_string(count) + " " + (count == 1 ? one : many);
}

DrawingFormat format_of(std::string_view text) {
  return without_leading_spaces(text).starts_with('<') ? DrawingFormat::svg : DrawingFormat::dxf;
}

/// A message about the gaps of the first open curves.
std::string describe_gaps(const std::vector<Polyline>& open) {
  std::string message;
  for (std::size_t k = 0; k < std::min(open.size(), max_named); ++k) {
    const Polyline& curve = open[k];
    const Point &a = curve.points.front(), &b = curve.points.back();
    message += (k == 0 ? "" : "; ") + curve.source->description;
    message += " ends " + four_digits((a - b).norm()) + " mm from where it begins, at (" + four_digits(b.x()) + ", " +
               four_digits(b.y()) + ")";
  }
  if (open.size() > max_named) message += "; and " + std::to_string(open.size() - max_named) + " more";
  return message;
}

[[noreturn]] void refuse_unclosed(const Shapes& shapes, const RawDrawing& raw) {
  std::string why = shapes.open.empty() ? "it holds no curve of any area" : describe_gaps(shapes.open);
  for (const auto& [kind, count] : raw.left_out_kinds)
    why += "; " + counted(static_cast<std::size_t>(count), kind.c_str(), kind.c_str()) + " left out";
  for (std::size_t k = 0; k < std::min(raw.left_out.size(), max_named); ++k)
    why += "; " + raw.left_out[k].element + " was left out: " + raw.left_out[k].reason;
  throw Error("outline.nothing_closed", "The drawing has no closed curve: " + why + ".",
              {{"text", "has no closed curve: " + why}});
}

/// The shapes of a drawing that is to be scaled to `options.width`, and its `scale`. The tolerance applies after
/// scaling, but the scale depends on the flattened curves. Therefore these are flattened again until their error is
/// small enough.
Shapes shapes_of_width(const RawDrawing& raw, const DrawingOptions& options, const Execution& execution,
                       double& scale) {
  constexpr double initial_fraction = 1e-3;
  constexpr double safety_factor = 0.9;
  constexpr int max_passes = 5;
  Points points;
  for (const Curve& curve : raw.curves) {
    points.push_back(curve.begin);
    for (const Piece& piece : curve.pieces)
      for_each_control_point(piece, [&points](const Point& p) { points.push_back(p); });
  }
  const Box extent = box_of(points);
  double tolerance = initial_fraction * std::max((extent.upper - extent.lower).norm(), 1e-9);
  Shapes shapes;
  for (int pass = 0; pass < max_passes; ++pass) {
    shapes = shapes_of(raw, tolerance, execution);
    const Box box = shapes.box();
    const double width = box.upper.x() - box.lower.x();
    if (!(width > 0)) refuse_unclosed(shapes, raw);
    scale = *options.width / width;
    if (pass > 0 && tolerance * scale <= options.tolerance) break;
    tolerance = safety_factor * options.tolerance / scale;
  }
  return shapes;
}

/// Moves the scaled outlines into the drawing, and fills in the counts of shapes and of what was left out.
void move_outlines(Shapes& shapes, const RawDrawing& raw, double scale, Drawing& drawing) {
  for (Shape& shape : shapes.shapes) {
    for (Points& points : shape.polygons) {
      for (Point& p : points) p *= scale;
      const bool is_last = &points == &shape.polygons.back();
      drawing.outlines.push_back({std::move(points), is_last ? std::move(shape.names) : shape.names});
    }
  }
  for (Polyline& open : shapes.open) {
    for (Point& p : open.points) p *= scale;
  }
  drawing.open_curves = shapes.open.size();
  drawing.joined = shapes.joined;
  drawing.stroked = raw.stroked;
  drawing.united = shapes.united;
  drawing.clipped = shapes.clipped;
  drawing.simplified = shapes.simplified;
  drawing.chord_error = shapes.chord_error * scale;
  drawing.left_out = raw.left_out;
  drawing.left_out_count = raw.left_out_count + shapes.left_out_count + shapes.open.size();
  const auto add_left_out = [&drawing](const std::string& element, const std::string& reason) {
    if (drawing.left_out.size() < Drawing::max_left_out) drawing.left_out.push_back({element, reason});
  };
  for (const OmittedElement& one : shapes.left_out) add_left_out(one.element, one.reason);
  for (const Polyline& open : shapes.open)
    add_left_out(
        open.source->description,
        "it stays open: its ends are " + four_digits((open.points.front() - open.points.back()).norm()) + " mm apart");
}

/// Finds the bounding box, and moves it to the origin if the drawing has no page or lies far from the origin. Returns
/// whether it lay far from the origin.
bool place(Drawing& drawing, const RawDrawing& raw) {
  Box box;
  for (const Outline& outline : drawing.outlines) box.include(outline.corners);
  const bool is_far = std::max(box.lower.cwiseAbs().maxCoeff(), box.upper.cwiseAbs().maxCoeff()) > max_part_coordinate;
  if (is_far || !raw.has_page) {
    for (Outline& outline : drawing.outlines) {
      for (Point& p : outline.corners) p -= box.lower;
    }
    box.upper -= box.lower;
    box.lower.setZero();
  }
  drawing.lower = box.lower;
  drawing.upper = box.upper;
  return is_far;
}

void warn(Drawing& drawing, const RawDrawing& raw, const Shapes& shapes) {
  auto& warnings = drawing.warnings;
  warnings = raw.warnings;
  warnings.insert(warnings.end(), shapes.warnings.begin(), shapes.warnings.end());
  if (!drawing.unit_is_known) {
    warnings.push_back(drawing.format == DrawingFormat::svg ? "The file says no size: its unit is taken as 1/96 inch."
                                                            : "The file says no unit: its unit is taken as 1 mm.");
  }
  if (!shapes.open.empty()) warnings.push_back("Open curves were left out: " + describe_gaps(shapes.open) + ".");
  if (shapes.duplicate_lines > 0)
    warnings.push_back(counted(shapes.duplicate_lines, "line lies", "lines lie") +
                       " over another one, which counts once.");
  if (shapes.duplicate_polygons > 0)
    warnings.push_back(counted(shapes.duplicate_polygons, "polygon lies", "polygons lie") +
                       " over another one, which counts once.");
  if (shapes.inner_polygons > 0)
    warnings.push_back(counted(shapes.inner_polygons, "curve lies", "curves lie") +
                       " within another one of its element and makes no hole: the rule of filling is nonzero.");
  if (shapes.united > 0)
    warnings.push_back(std::to_string(shapes.united) + " shapes that cross each other were united.");
  if (shapes.tiny > 0)
    warnings.push_back(counted(shapes.tiny, "closed curve", "closed curves") + " without area left out.");
  if (raw.hidden > 0) warnings.push_back(counted(raw.hidden, "hidden element", "hidden elements") + " left out.");
  for (const auto& [kind, count] : raw.left_out_kinds) {
    warnings.push_back(std::to_string(count) + " " + kind + " left out: no outline is made of " +
                       (count == 1 ? "it." : "them."));
  }
}

}  // namespace

const char* to_string(DrawingFormat format) {
  return format == DrawingFormat::svg ? "svg" : format == DrawingFormat::dxf ? "dxf" : "automatic";
}

Drawing read_drawing(std::string_view text, const DrawingOptions& options, const Execution& execution) {
  execution.checkpoint(0, "reading");
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  refuse_other_formats(text);
  Drawing drawing;
  drawing.format = options.format == DrawingFormat::automatic ? format_of(text) : options.format;
  RawDrawing raw;
  {
    const StageTimer timer(execution.cost, "reading");
    raw =
        drawing.format == DrawingFormat::svg ? read_svg(text, options, execution) : read_dxf(text, options, execution);
  }
  execution.checkpoint(0.5, "flattening");
  const StageTimer timer(execution.cost, "flattening");
  drawing.curves = raw.curves.size();
  drawing.unit_is_known = raw.unit_is_known || options.width;
  double scale = 1;
  Shapes shapes =
      options.width ? shapes_of_width(raw, options, execution, scale) : shapes_of(raw, options.tolerance, execution);
  drawing.unit = raw.unit * scale;
  move_outlines(shapes, raw, scale, drawing);
  if (drawing.outlines.empty()) refuse_unclosed(shapes, raw);
  const bool is_far = place(drawing, raw);
  for (const Curve& curve : raw.curves) {
    drawing.rounded += std::any_of(curve.pieces.begin(), curve.pieces.end(),
                                   [](const Piece& piece) { return !std::holds_alternative<Line>(piece); });
  }
  warn(drawing, raw, shapes);
  if (is_far) drawing.warnings.push_back("The drawing lay farther than 2000 mm from its origin and was moved there.");
  if (auto* cost = execution.cost) {
    cost->add_quantity("curves", static_cast<double>(drawing.curves));
    std::size_t corners = 0;
    for (const Outline& outline : drawing.outlines) corners += outline.corners.size();
    cost->add_quantity("corners", static_cast<double>(corners));
  }
  execution.checkpoint(1, "flattening");
  return drawing;
}

}  // namespace supple::outlines
