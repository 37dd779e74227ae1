#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>

#include "supple/tiling/definition_check.h"

namespace supple::tiling {

/// Why the placed tiles do not cover the plane once.
struct CoverFault {
  DefinitionFlaw flaw;
  std::optional<std::size_t> edge;  ///< of the tile, if one is at fault
  std::string message;
  std::optional<Eigen::Vector2d> point;
};

/// Checks that every edge of a placed tile is that of exactly one other one in the opposite direction, and that the
/// areas add up to that of the cell. `edge_starts` is that of the definition (see defined_outline.h). The place of a
/// gap or an overlap is the point of a raster over the cell that is farthest from the outlines; there is none where
/// tiles overlap hundreds of times. Quadratic in the edges of a cell.
std::optional<CoverFault> cover_fault(const Tiling& tiling, std::span<const std::size_t> edge_starts,
                                      const Execution& execution);

}  // namespace supple::tiling
