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
  std::optional<double> resolution;         ///< pixels per inch of an SVG drawing without a physical size; usually 96
  std::optional<double> width;              ///< mm; the drawing is scaled until its closed curves are as wide together
};

/// A closed curve as a polygon.
struct Outline {
  std::vector<Eigen::Vector2d> corners;  ///< mm, y upwards
  /// What it can be chosen by: its id and label, then those of the groups around it from inside; in DXF its layer.
  std::vector<std::string> names;
};

/// An element of which no outline was made.
struct LeftOut {
  std::string element;  ///< what and where it is: "<rect> "a" of line 3"
  std::string reason;
};

/// What a drawing shows.
struct Drawing {
  static constexpr std::size_t most_left_out = 1'000;

  DrawingFormat format = DrawingFormat::svg;
  std::vector<Outline> outlines;  ///< in the file's order
  Eigen::Vector2d lower, upper;   ///< their bounding box, mm
  double unit = 1;                ///< mm, of one unit of the drawing's coordinates, `width` included
  bool unit_is_known = true;      ///< whether the file or the options say it
  std::size_t curves = 0;         ///< that were read, closed or not
  std::size_t joined = 0;         ///< curves that were joined with others to close
  std::size_t open_curves = 0;    ///< curves that stay open, which are left out
  std::size_t rounded = 0;        ///< curves of which some part is no straight line
  std::size_t stroked = 0;        ///< curves that are lines only, whose middle became the outline
  std::size_t united = 0;         ///< shapes that cross others of their group and became one with them
  std::size_t clipped = 0;        ///< shapes of which a clip path cut something off
  std::size_t simplified = 0;     ///< corners that were left out since the outline stays within the tolerance
  double chord_error = 0;         ///< mm, the largest distance of a chord from its curve
  std::vector<std::string> warnings;
  std::vector<LeftOut> left_out;   ///< the first `most_left_out`
  std::size_t left_out_count = 0;  ///< of all of them
};

/// Reads the closed curves of a drawing.
///
/// SVG: paths, basic shapes, nested drawings and transforms; user units are 1/96 inch where width, height and viewBox
/// say no physical size. Style sheets within the file, attributes and styles tell what is shown: what is hidden, has
/// neither fill nor stroke, or is a white background of the whole page, is left out. The curves of a filled element are
/// filled by its rule, and open ones are closed by a straight line; of lines the middle is the outline. Clip paths cut.
/// The lower left corner of the page is the origin. Entities and references to other files are not followed. DXF
/// (ASCII): LWPOLYLINE, POLYLINE, LINE, ARC, CIRCLE, ELLIPSE and SPLINE of the model space, and of blocks.
///
/// Open curves of one layer or group whose ends lie within the tolerance of each other are joined; those of several
/// groups only where they close. The same curve twice counts once, whatever its points. Shapes of one group that cross
/// each other are united; a shape that lies within another is an outline of its own. Outlines of more than 1,000
/// corners are simplified within the tolerance. An SVG drawing without a page, and one beyond 2000 mm, is moved until
/// the lower left corner of its bounding box is the origin.
///
/// Throws Error
/// - "outline.unreadable": no such format, which is named, or an element that cannot be read, with its name and line;
/// - "outline.nothing_closed": there is no closed curve, with the gaps of open ones and what was left out;
/// - "outline.too_large": more than 20,000 curves, 100,000 corners, 2,000 rules of style, or 100 groups within each
///   other;
/// - "outline.resolution_missing": the sizes are pixels of a program whose pixels were no 1/96 inch (Adobe Illustrator:
///   72 for an inch, Inkscape before 0.92: 90), and neither resolution, unit nor width is given.
/// The detail is "text", "resolution", or "accuracy/tolerance" where a coarser one would do. O(n log n) for n corners:
/// a megabyte of text takes about 80 ms, half of it to find out which curves cross or lie over each other.
Drawing read_drawing(std::string_view text, const DrawingOptions& options = {}, const Execution& execution = {});

}  // namespace supple::outlines
