#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "chains.h"
#include "curve.h"
#include "polygon_measures.h"
#include "reading.h"

namespace supple::outlines {

/// Polygons that bound an area together, by the even-odd rule.
struct Shape {
  std::vector<Points> polygons;
  std::vector<std::string> names;
  const Curve* curve = nullptr;  ///< the first of its curves in the drawing
  std::size_t curves = 0;        ///< number of curves that were joined to it; 0 if none had to be joined
};

/// The shapes of a drawing at a tolerance, and counts of the curves that became no shapes or changed.
struct Shapes {
  std::vector<Shape> shapes;  ///< in the file's order
  std::vector<Polyline> open;
  std::size_t joined = 0;              ///< curves that were joined with others to close
  std::size_t duplicate_lines = 0;     ///< open lines that lie over others
  std::size_t duplicate_polygons = 0;  ///< polygons that lie over others
  std::size_t tiny = 0;                ///< closed curves of no area
  std::size_t inner_polygons = 0;      ///< polygons within others of their element, both of whose sides are filled
  std::size_t united = 0;              ///< shapes that were united with others, which they cross
  std::size_t clipped = 0;             ///< shapes that a clip path cuts
  std::size_t simplified = 0;          ///< corners that were left out to simplify outlines
  double chord_error = 0;
  std::vector<OmittedElement> left_out;  ///< the first curves that were left out
  std::size_t left_out_count = 0;        ///< number of all of them
  std::vector<std::string> warnings;

  Box box() const;
  /// Counts a curve that is left out, and records the reason for the first ones.
  void leave_out(const std::string& description, const char* reason);
  void leave_out_tiny(const std::string& description);
};

/// Flattens and joins the curves of a drawing, applies filling rules and clip paths, and unites the shapes of one group
/// that cross. Lengths are in the unit of the drawing. The shapes point to its curves. Throws "outline.too_large".
Shapes shapes_of(const RawDrawing& drawing, double tolerance, const Execution& execution);

}  // namespace supple::outlines
