#include "supple/tiling/structure.h"

#include <Eigen/LU>
#include <cmath>
#include <sstream>

#include "offset.h"
#include "polygon.h"
#include "supple/base/error.h"

namespace supple::tiling {
namespace {

/// Holes narrower than this share of the beam width are closed, and sides of holes shorter than it become points: 1.5
/// micrometres, which no printer makes and which would ask for elements as small.
constexpr double smallest_hole = 0.005;

void scale_by(Tiling& tiling, double scale) {
  for (Polygon& tile : tiling.tiles) {
    for (Eigen::Vector2d& vertex : tile) vertex *= scale;
  }
  for (Placement& placement : tiling.placements) placement.offset *= scale;
  tiling.lattice *= scale;
}

}  // namespace

Structure make_structure(const Family& family, std::span<const double> parameters, double box_margin) {
  Structure structure;
  structure.family = family.id;
  structure.parameters.assign(parameters.begin(), parameters.end());
  structure.tiling = tiling_of(family, parameters, box_margin);
  structure.scale = structure.beam_width / family.beam_width;
  scale_by(structure.tiling, structure.scale);
  for (const Polygon& tile : structure.tiling.tiles) {
    structure.holes.push_back(inset(tile, structure.beam_width / 2, smallest_hole * structure.beam_width));
    if (structure.holes.back().empty() && !family.holes_may_close) {
      std::ostringstream message;
      message << "Beams of " << structure.beam_width << " mm leave no hole in a tile of " << area(tile) << " mm^2.";
      throw Error("tiling.hole_closed", "Family " + family.id + ": " + message.str(), {{"parameters", message.str()}});
    }
  }
  structure.cell_area = std::abs(structure.tiling.lattice.determinant());
  structure.solid_area = structure.cell_area;
  for (const Placement& placement : structure.tiling.placements) {
    for (const Polygon& hole : structure.holes[placement.tile]) structure.solid_area -= area(hole);
  }
  return structure;
}

}  // namespace supple::tiling
