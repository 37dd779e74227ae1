#pragma once

#include <vector>

#include "supple/tiling/family_definition.h"

namespace supple::tiling {

/// One of the 81 isohedral types: every tile is a copy of one prototile, and symmetries of the tiling carry each tile
/// to each other. [Grunbaum1987] numbers the types; [Kaplan2009] gives their vertices as affine functions of
/// parameters, with coefficients of twelve digits.
struct IsohedralType {
  int number = 0;                        ///< 1 to 93, with gaps
  std::vector<double> defaults;          ///< of the parameters, of which there are 0 to 6
  std::vector<EdgeSymmetry> symmetries;  ///< of each edge shape
  TileDefinition tile;                   ///< edges refer to `symmetries`
};

/// All types, by their numbers.
const std::vector<IsohedralType>& isohedral_types();

/// The type with this number, or null.
const IsohedralType* find_isohedral_type(int number);

/// A family of this type: its parameters within `reach` of their defaults, its edges straight.
FamilyDefinition definition_of(const IsohedralType& type, double reach, double beam_width);

}  // namespace supple::tiling
