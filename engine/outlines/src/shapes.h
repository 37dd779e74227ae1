#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "chains.h"
#include "curve.h"
#include "polygon_measures.h"
#include "reading.h"

namespace supple::outlines {

/// Polygons that bound an area together: within an odd number of them is inside.
struct Shape {
  std::vector<Points> polygons;
  std::vector<std::string> names;
  const Curve* curve = nullptr;  ///< the first of its curves in the drawing
  std::size_t curves = 0;        ///< of which it was joined; 0 if it was closed as it stood
};

/// What became of the curves of a drawing at a tolerance.
struct Shapes {
  std::vector<Shape> shapes;  ///< in the file's order
  std::vector<Polyline> open;
  std::size_t joined = 0;      ///< curves that were joined with others to close
  std::size_t doubled = 0;     ///< lines that lie over others
  std::size_t equal = 0;       ///< polygons that lie over others
  std::size_t tiny = 0;        ///< closed curves of no area
  std::size_t inner = 0;       ///< polygons within others of their element, which the rule of filling fills as well
  std::size_t united = 0;      ///< shapes that became one with others which they cross
  std::size_t clipped = 0;     ///< shapes of which something was cut off
  std::size_t simplified = 0;  ///< corners
  double chord_error = 0;
  std::vector<LeftOut> left_out;  ///< the first of what was left out, as many as a drawing tells
  std::size_t left_out_count = 0;
  std::vector<std::string> warnings;

  Box box() const;
};

/// Flattens and joins the curves of a drawing, fills what is filled, cuts with clip paths, and unites the shapes of one
/// group that cross. All lengths are those of the drawing, to whose curves the shapes refer. Throws
/// "outline.too_large".
Shapes shapes_of(const RawDrawing& drawing, double tolerance, const Execution& execution);

}  // namespace supple::outlines
