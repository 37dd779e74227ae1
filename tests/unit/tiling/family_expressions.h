#pragma once

#include <array>
#include <string>
#include <vector>

#include "affine.h"
#include "supple/tiling/family.h"

namespace supple::tiling::testing {

struct AffinePoint {
  Affine x, y;
};

/// The placement x -> linear * x + offset, with `linear` row by row.
struct AffinePlacement {
  std::array<double, 4> linear;
  AffinePoint offset;
};

/// One of the seven families of [Thesis], with straight edges: every tile is a copy of one prototile.
struct ExpressedFamily {
  std::string id;
  std::vector<Parameter> parameters;
  double beam_width = 0;                            ///< tiling units
  double sufficient_mesh_size = default_mesh_size;  ///< as in Family
  std::vector<AffinePoint> tile;                    ///< vertices, counterclockwise
  std::array<AffinePoint, 2> translations;
  std::vector<AffinePlacement> placements;  ///< the tiles of one cell
};

/// The seven families as expressions of their parameters, written as one reads them: what their files must agree with
/// to the last bit.
const std::vector<ExpressedFamily>& expressed_families();

/// The tiling at parameters, by these expressions.
Tiling evaluate(const ExpressedFamily& family, std::span<const double> parameters);

}  // namespace supple::tiling::testing
