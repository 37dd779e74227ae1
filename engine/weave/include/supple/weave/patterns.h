#pragma once

#include <array>

#include "supple/weave/weave.h"

namespace supple::weave {

/// Maximum number of columns times rows of a sheet.
inline constexpr int max_pattern_strands = 20'000;

/// How two strands of a pattern are connected where they cross.
enum class Connection {
  fused,
  slides_x,  ///< the strand that is more nearly parallel to the x axis slides
  slides_y,  ///< the other strand slides
};

/// A 2x2 block of crossings: [row][column]. Rows are counted from below.
using ConnectionBlock = std::array<std::array<Connection, 2>, 2>;
/// A block whose four crossings are alike.
ConnectionBlock uniform_block(Connection connection);

/// Straight strands at right angles, 2 by 2 of them in a cell of 2 pitch x 2 pitch. Only the neighbours of a crossing
/// limit how far it slides. Throws "weave.invalid_pattern" if a length is not positive. All lengths here are in mm.
Weave regular_weave(const ConnectionBlock& block, double pitch = 4);
/// A sheet of `columns` x `rows` strands, in which the block is repeated. The ends of the strands stand over the outer
/// crossings by half a pitch. Crossings in a border of `fused_border` strands are fused whatever the block says.
Weave regular_sheet(int columns, int rows, const ConnectionBlock& block, double pitch = 4, int fused_border = 0,
                    const Execution& execution = {});

/// How the eight crossings of interlacing squares are connected; each square's own corners are always fused.
enum class SquareType {
  all_fused = 1,
  all_slide_x = 2,      ///< the horizontal strand of each crossing slides
  slide_both_ways = 3,  ///< at each corner, one of its two crossings slides in x and the other one in y
  one_corner_fused = 4  ///< as slide_both_ways, but the crossings of the bottom-left corner are fused
};
/// Maximum displacement of a sliding crossing of loops, as a fraction of the distance to the next crossing or corner on
/// either side.
inline constexpr double sliding_fraction = 0.7;

/// Limits the displacement of every member that slides to `fraction` of the distance to the next crossing of its
/// strand, or to its end, on either side. O(members log members).
void limit_sliding(Weave& weave, double fraction = sliding_fraction, const Execution& execution = {});

/// Squares on a square lattice and others in the middles between them, whose corners overlap by `overlap` in x and y.
/// The cell has two squares, eight crossings and the side 2 (side - overlap).
Weave interlacing_squares(SquareType type, double side = 12, double overlap = 3);
/// A sheet of `columns` x `rows` squares, with (columns - 1) x (rows - 1) squares between them.
Weave interlacing_squares_sheet(SquareType type, int columns, int rows, double side = 12, double overlap = 3.6,
                                const Execution& execution = {});

enum class CircleType { all_fused, all_slide };
/// Circles on a square lattice that cut their four neighbours. A cell has four crossings. If they slide, each circle
/// slides through the circle to its right, and the circle above slides through it.
Weave interlacing_circles(CircleType type, double radius = 5.5, double distance = 10);
Weave interlacing_circles_sheet(CircleType type, int columns, int rows, double radius = 8, double distance = 14.4,
                                const Execution& execution = {});

/// Three rings of radius 12, 20 and 28 about the origin, three fused diameters, and a vertical strand from (0, 28),
/// where it is fused to the outer ring, to (0, -44). This strand slides through the rings and the centre. Pushing it in
/// at its end makes the sheet rise. It is the last strand.
Weave actuated_rings();

}  // namespace supple::weave
