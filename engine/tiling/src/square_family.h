#pragma once

#include "supple/tiling/family.h"

namespace supple::tiling {

/// The tiling of the cell [-1, 1]^2 by a centred square of half side |p| and by segments from its corners to those of
/// the cell.
Tiling square_in_square(double p);

}  // namespace supple::tiling
