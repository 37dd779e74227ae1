#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/tiling/family_definition.h"

namespace supple::tiling {

/// What a finding of `check_definition` is about.
enum class DefinitionFlaw {
  field,      ///< a field of the definition is out of range, or does not go with the others
  unused,     ///< a parameter or a shape that nothing depends on
  too_large,  ///< an expression that leaves its range within the box of parameters
  gap,        ///< a place that no tile covers
  overlap,    ///< a place that several tiles cover
  unmatched,  ///< an edge that is the edge of no other tile, although the plane is covered
  crossing,   ///< a tile's outline that crosses or touches itself
  sliver      ///< a corner, a side or a strait so narrow that beams close it
};

/// One finding, and where it is.
struct DefinitionFinding {
  DefinitionFlaw flaw;
  std::string where;                     ///< path of the field, such as "tile/edges/2"
  std::string message;                   ///< a sentence without its subject
  std::vector<double> parameters;        ///< at which it was found; empty if it does not depend on them
  std::optional<Eigen::Vector2d> point;  ///< in the plane of the tiling at these parameters, in tiling units
};

struct DefinitionReport {
  std::vector<DefinitionFinding> faults;  ///< with which a definition is none of a family; at most 20
  std::vector<DefinitionFinding>
      warnings;  ///< parts of the box that networks and printers have trouble with; at most 20

  bool good() const { return faults.empty(); }
};

/// Checks that a definition is one of a family. Faults are fields out of range, parameters and shapes that nothing
/// depends on, expressions that leave their range within the box, a tile whose copies leave gaps or overlap, and one
/// that crosses itself at the default parameters. Where a tile begins to cross itself within the box, and where
/// corners, sides or straits are slivers, is a warning, since a family may be used beside these places: IH01 is.
///
/// Gaps and overlaps are looked for at the default, at the corners of the box and at 64 points of a Sobol sequence:
/// each edge of a tile must be that of one other tile in the opposite direction, and the areas must add up to that of
/// the cell. Vertices are affine functions, so that straight edges that match there match all over the box. Crossings
/// are looked for at 256 such points, and the place nearest to the default where one begins is found by bisection to
/// 1e-6 of the box. Findings depend on the definition alone. It takes 1 to 300 ms, and bills the effect "survey" and
/// the stages "drawing" and "survey".
DefinitionReport check_definition(const FamilyDefinition& definition, const Execution& execution = {});

/// Whether the tile crosses itself or is turned inside out at these parameters (DefinitionFlaw::crossing), or if not,
/// has a sliver (DefinitionFlaw::sliver): a corner below 25 degrees, or a side or strait below 1.5 beam widths. The
/// definition must have no faults near its default. Takes some microseconds, with long polylines some tens.
std::optional<DefinitionFlaw> flaw_at(const FamilyDefinition& definition, const std::vector<double>& parameters);

}  // namespace supple::tiling
