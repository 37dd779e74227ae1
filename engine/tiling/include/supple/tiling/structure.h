#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "supple/tiling/family.h"

namespace supple::tiling {

/// A tiling whose edges have become beams: the solid is the cell minus the holes. Lengths in millimetres.
struct Structure {
  std::string family;
  std::vector<double> parameters;
  double beam_width = printed_beam_width;  ///< mm
  double scale = 1;                        ///< mm per tiling unit
  Tiling tiling;                           ///< scaled to mm
  /// For each tile its holes (counterclockwise): the points inside the tile (winding number 1) that are farther than
  /// half a beam width from its outline, with mitred corners, and outside the folded parts of tiles that cross
  /// themselves, made larger by half a beam width. A tile may have several holes, or none where the family allows it.
  /// Holes narrower than 0.5 % of the beam width are left out and sides of holes shorter than that are points.
  std::vector<std::vector<Polygon>> holes;
  /// Whether a tile's outline crosses or touches itself.
  bool tiles_cross = false;
  double cell_area = 0;   ///< mm^2
  double solid_area = 0;  ///< mm^2 of the cell covered by material
};

/// Checks the parameters (see `tiling_of`) and makes the beams. Throws what `tiling_of` throws, "tiling.hole_closed"
/// where the beams swallow a hole of a family that has none closed, and "tiling.self_intersecting" (the sides that
/// cross named) where a tile crosses itself so far that a beam is left with less than half its width.
Structure make_structure(const Family& family, std::span<const double> parameters, double box_margin = 0);

}  // namespace supple::tiling
