#pragma once

#include <optional>
#include <string>

#include "supple/base/execution.h"
#include "supple/tiling/family_definition.h"

namespace supple::tiling {

/// A tile that somebody has drawn, and the isohedral type that it is a tile of.
struct TileDrawing {
  Polygon outline;         ///< in any unit and orientation; corners at the tile's vertices, fine polylines for curves
  int isohedral_type = 0;  ///< one of the 81 numbers
  std::string id;          ///< of the family
  std::string description;
  double reach = 0.05;  ///< dimensionless; the parameters' bounds lie at most so far from the drawn tile's
  std::optional<double> beam_width{};  ///< tiling units; without it 5 % of the square root of the tile's area
  bool has_shape_parameters = false;  ///< whether each curved shape gets a parameter that its height is proportional to
};

/// Limits of what counts as drawn alike.
inline constexpr double max_vertex_misfit = 0.02;  ///< rms distance, divided by the square root of the tile's area
inline constexpr double max_edge_misfit = 0.03;    ///< distance of edges that have the same shape, in chord lengths

/// The family whose tile at the default parameters is the drawn one, up to a similarity or a reflection.
///
/// The tile's vertices are chosen among the corners of the outline, which turn by more than 12 degrees, so that the
/// vertices of the type's tile, at some parameters, fit them best (linear least squares for each choice). The lines
/// between the vertices become the shapes of the edges: polylines of at most 32 points, or straight ones. The first
/// edge of each shape is taken; the others must be like it, and each must have the symmetry of its class.
///
/// The bounds lie `reach` from the defaults, or half of it, a quarter and so on, so that the tiles within them have at
/// least a tenth of the drawn tile's area.
///
/// Throws TilingError "tiling.drawing" where the outline has too few or too many corners, where no choice of vertices
/// fits, and where edges do not fit; it says which and how far off they are. The detail is "svg". At most 20,000
/// choices are tried, each of a microsecond and for those that fit O(number of points) more.
FamilyDefinition definition_of_drawing(const TileDrawing& drawing, const Execution& execution = {});

}  // namespace supple::tiling
