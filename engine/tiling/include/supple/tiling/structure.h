#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <string_view>
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
  /// For each placed tile of the cell, the holes within it (counterclockwise) at their positions. Together they are the
  /// pieces of the plane outside all beams, one for each class of translates. A beam consists of the points within half
  /// a beam width of a side of a tile. Where sides meet at a re-entrant corner of a tile, a square joint closes the
  /// gap. A tile may have several holes. Holes narrower than 0.5 % of the beam width are left out, and sides of holes
  /// shorter than that become points.
  std::vector<std::vector<Polygon>> holes;
  /// Whether a tile's outline crosses or touches itself. Then tiles overlap, and each hole is listed with one of the
  /// tiles around it.
  bool tiles_cross = false;
  double cell_area = 0;   ///< mm^2
  double solid_area = 0;  ///< area of the cell covered by material, mm^2
};

/// Checks the parameters (see `tiling_of`) and makes the beams. The solid depends continuously on the parameters: its
/// area, holes and stiffness jump only where a hole closes. Throws what `tiling_of` throws, and "tiling.hole_closed" if
/// the beams close all holes of a tile in a family that does not allow it. O(n log n) for n sides of the tiles around a
/// cell, which is some milliseconds.
Structure make_structure(const Family& family, std::span<const double> parameters, double box_margin = 0);

/// The structure of the family with this id, such as "IH21", at parameters or, without them, at the family's default.
/// Throws what `family` and the function above throw.
Structure make_structure(std::string_view family_id, std::span<const double> parameters = {});

/// The same structure with beams of another width in millimetres: everything else scales with it.
Structure scaled(Structure structure, double beam_width);

/// Whether the parameters lie within the family's box and `make_structure` makes a structure of them. Searches call it
/// for every design that they consider. It takes some microseconds if each tile has a point far from every beam, as
/// nearly all tiles have. Otherwise it takes as long as `make_structure`.
bool can_be_built(const Family& family, std::span<const double> parameters);

}  // namespace supple::tiling
