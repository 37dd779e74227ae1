#pragma once

#include <string>
#include <vector>

#include "affine.h"
#include "supple/tiling/family.h"

namespace supple::tiling {

struct AffinePoint {
  Affine x, y;
};

/// The placement x -> linear * x + offset, with `linear` row by row.
struct AffinePlacement {
  std::array<double, 4> linear;
  AffinePoint offset;
};

/// One isohedral type with straight edges: every tile is a copy of one prototile.
struct IsohedralType {
  std::string id;
  std::string description;
  std::vector<Parameter> parameters;
  double beam_width = 0;                            ///< tiling units
  double sufficient_mesh_size = default_mesh_size;  ///< as in Family
  std::vector<AffinePoint> tile;                    ///< vertices, counterclockwise
  std::array<AffinePoint, 2> translations;
  std::vector<AffinePlacement> placements;  ///< the tiles of one cell
};

/// The table of isohedral types. [Grunbaum1987] numbers the 81 types, and [Kaplan2009] gives their tiling vertices as
/// affine functions.
const std::vector<IsohedralType>& isohedral_types();

/// The tiling of the cell [-1, 1]^2 by a centred square of half side |p| and by segments from its corners to those of
/// the cell.
Tiling square_in_square(double p);

}  // namespace supple::tiling
