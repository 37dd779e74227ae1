#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"

namespace supple::outlines {

enum class DrawingFormat { automatic, svg, dxf };
enum class LengthUnit { automatic, mm, cm, m, in, ft, pt, px };

const char* to_string(DrawingFormat format);

struct DrawingOptions {
  DrawingFormat format = DrawingFormat::automatic;
  LengthUnit unit = LengthUnit::automatic;  ///< of the drawing's coordinates; automatic: what the file says
  double tolerance = 0.05;                  ///< mm; a chord is nowhere farther from its curve
  std::optional<double> width;              ///< mm; the drawing is scaled until its closed curves are as wide together
};

/// A closed curve as a polygon.
struct Outline {
  std::vector<Eigen::Vector2d> corners;  ///< mm, y upwards
  /// What it can be chosen by: its id and label, then those of the groups around it from inside; in DXF its layer.
  std::vector<std::string> names;
};

/// What a drawing shows.
struct Drawing {
  DrawingFormat format = DrawingFormat::svg;
  std::vector<Outline> outlines;  ///< in the file's order
  Eigen::Vector2d lower, upper;   ///< their bounding box, mm
  double unit = 1;                ///< mm, of one unit of the drawing's coordinates, `width` included
  bool unit_is_known = true;      ///< whether the file or the options say it
  std::size_t curves = 0;         ///< that were read, closed or not
  std::size_t joined = 0;         ///< curves that were joined with others to close
  std::size_t open_curves = 0;    ///< curves that stay open, which are left out
  std::size_t rounded = 0;        ///< curves of which some part is no straight line
  double chord_error = 0;         ///< mm, the largest distance of a chord from its curve
  std::vector<std::string> warnings;
};

/// Reads the closed curves of a drawing.
///
/// SVG: paths, basic shapes and transforms; user units are 1/96 inch where width, height and viewBox say nothing else.
/// The lower left corner of the page is the origin. Entities, references and style sheets are not followed. DXF
/// (ASCII): LWPOLYLINE, POLYLINE, LINE, ARC, CIRCLE, ELLIPSE and SPLINE of the model space; blocks are not followed.
/// What is hidden is left out. Open curves of one layer or group whose ends lie within the tolerance of each other are
/// joined. Two equal polygons count once. An SVG drawing without a page, and one beyond 2000 mm, is moved until
/// the lower left corner of its bounding box is the origin.
///
/// Throws Error
/// - "outline.unreadable": no such format, or an element that cannot be read, with its name and line;
/// - "outline.nothing_closed": there is no closed curve, with the gaps of open ones;
/// - "outline.too_large": more than 20,000 curves, 100,000 corners or 100 groups within each other.
/// The detail is "text", or "accuracy/tolerance" where a coarser one would do. O(n log n) for n corners: a megabyte of
/// text takes about 20 ms.
Drawing read_drawing(std::string_view text, const DrawingOptions& options = {}, const Execution& execution = {});

}  // namespace supple::outlines
