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
  LengthUnit unit = LengthUnit::automatic;  ///< unit of the drawing's coordinates; automatic: the file's
  double tolerance = 0.05;                  ///< mm; limit of the distance of a chord from its curve
  std::optional<double> resolution;         ///< pixels per inch of an SVG drawing without a physical size; usually 96
  std::optional<double> width;              ///< mm; the drawing is scaled so that its outlines together have this width
};

/// A closed curve as a polygon.
struct Outline {
  std::vector<Eigen::Vector2d> corners;  ///< mm, y upwards
  /// What it can be chosen by, from inside outwards: in SVG its id and label and those of the groups around it; in DXF
  /// its layer and the blocks around it.
  std::vector<std::string> names;
};

/// An element of which no outline was made.
struct OmittedElement {
  std::string element;  ///< its kind and place: "<rect> "a" of line 3"
  std::string reason;
};

/// What a drawing shows.
struct Drawing {
  static constexpr std::size_t max_left_out = 1'000;

  DrawingFormat format = DrawingFormat::svg;
  std::vector<Outline> outlines;  ///< in the file's order
  Eigen::Vector2d lower, upper;   ///< bounding box of the outlines, mm
  double unit = 1;                ///< length of one unit of the drawing's coordinates, mm, scaled to `width`
  bool unit_is_known = true;      ///< whether the file or the options give the unit
  std::size_t curves = 0;         ///< curves that were read, closed or not
  std::size_t joined = 0;         ///< curves that were joined with others to close
  std::size_t open_curves = 0;    ///< curves that stay open and are left out
  std::size_t rounded = 0;        ///< curves that are not straight everywhere
  std::size_t stroked = 0;        ///< curves without filling, whose stroke's centre line is the outline
  std::size_t united = 0;         ///< shapes that were united with others of their group, which they cross
  std::size_t clipped = 0;        ///< shapes that a clip path cuts
  std::size_t simplified = 0;     ///< corners that were left out to simplify outlines
  double chord_error = 0;         ///< mm, the largest distance of a chord from its curve
  std::vector<std::string> warnings;
  std::vector<OmittedElement> left_out;  ///< the first `max_left_out` elements that were left out
  std::size_t left_out_count = 0;        ///< number of all of them
};

/// Reads the closed curves of a drawing.
///
/// SVG: paths, basic shapes, nested drawings and transforms. User units are 1/96 inch if width, height and viewBox give
/// no physical size. Style sheets within the file, attributes and styles say what is shown. An element is left out if
/// it is hidden, has neither fill nor stroke, or is a white background of the whole page. The curves of a filled
/// element are filled by its rule, and open ones are closed by a straight line. The outline of an element with a stroke
/// alone is the centre line of its stroke. Clip paths cut. The lower left corner of the page is the origin. Entities
/// and references to other files are not followed. DXF (ASCII): LWPOLYLINE, POLYLINE, LINE, ARC, CIRCLE, ELLIPSE and
/// SPLINE of the model space, and of blocks.
///
/// Open curves of one layer or group whose ends lie within the tolerance of each other are joined; those of several
/// groups only if they close. A curve that is drawn twice counts once, even if its points differ. Shapes of one group
/// that cross each other are united; a shape that lies within another is an outline of its own. Outlines of more than
/// 1,000 corners are simplified within the tolerance. An SVG drawing without a page, and a drawing beyond 2000 mm, is
/// moved so that the lower left corner of its bounding box is the origin.
///
/// Throws Error
/// - "outline.unreadable": another format, with its name, or an element that cannot be read, with its name and line;
/// - "outline.nothing_closed": no curve is closed; the gaps of open ones and what was left out are named;
/// - "outline.too_large": more than 20,000 curves, 100,000 corners, 2,000 rules of style, or 100 groups within each
///   other;
/// - "outline.resolution_missing": sizes are in pixels of a program whose pixels were not 1/96 inch (Adobe Illustrator:
///   1/72 inch, Inkscape before 0.92: 1/90 inch), and neither resolution, unit nor width is given.
/// The detail is "text" or "resolution", or "accuracy/tolerance" if a coarser tolerance would help. O(n log n) for n
/// corners: a megabyte of text takes about 80 ms, half of it to find curves that cross or lie over each other.
Drawing read_drawing(std::string_view text, const DrawingOptions& options = {}, const Execution& execution = {});

}  // namespace supple::outlines
