#pragma once

#include <string>
#include <vector>

#include "affine.h"
#include "supple/tiling/family.h"

namespace supple::tiling {

struct AffinePoint {
  Affine x, y;
};

/// x -> linear * x + offset; `linear` row by row.
struct AffinePlacement {
  std::array<double, 4> linear;
  AffinePoint offset;
};

/// One isohedral type with straight edges: every tile is a copy of one prototile.
struct IsohedralType {
  std::string id;
  std::string description;
  std::vector<Parameter> parameters;
  double beam_width = 0;          ///< tiling units
  std::vector<AffinePoint> tile;  ///< vertices, counterclockwise
  std::array<AffinePoint, 2> translations;
  std::vector<AffinePlacement> placements;  ///< the tiles of one cell
};

/// The table; see Grünbaum and Shephard, "Tilings and Patterns" (1987), for the numbering of the 81 types, and Kaplan,
/// "Introductory Tiling Theory for Computer Graphics" (2009), for their tiling vertices as affine functions.
const std::vector<IsohedralType>& isohedral_types();

/// [-1, 1]^2 with a centred square of half side |p| and diagonals from its corners to the cell's.
Tiling square_in_square(double p);

}  // namespace supple::tiling
