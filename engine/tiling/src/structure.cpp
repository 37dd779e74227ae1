#include "supple/tiling/structure.h"

#include <Eigen/LU>
#include <algorithm>
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

/// Where a tile crosses itself, the holes of neighbouring tiles may come this close (in beam widths) instead of 1.
/// Every fifth design of IH01's box crosses, in the published data as well.
constexpr double thinnest_beam = 0.5;

void scale_by(Tiling& tiling, double scale) {
  for (Polygon& tile : tiling.tiles) {
    for (Eigen::Vector2d& vertex : tile) vertex *= scale;
  }
  for (Placement& placement : tiling.placements) placement.offset *= scale;
  tiling.lattice *= scale;
}

/// The translations that may bring a copy of the cell's tiles near the cell: those within twice the tiles' extent.
std::vector<Eigen::Vector2d> nearby_translations(const Structure& structure) {
  Eigen::Vector2d lower = Eigen::Vector2d::Constant(INFINITY), upper = -lower;
  for (const Placement& placement : structure.tiling.placements) {
    for (const Eigen::Vector2d& p : placed(structure.tiling.tiles[placement.tile], placement)) {
      lower = lower.cwiseMin(p);
      upper = upper.cwiseMax(p);
    }
  }
  const Eigen::Matrix2d& lattice = structure.tiling.lattice;
  const Eigen::Vector2i reach =
      ((upper - lower).norm() * lattice.inverse().rowwise().norm()).array().ceil().cast<int>();
  std::vector<Eigen::Vector2d> result;
  for (int i = -reach[0]; i <= reach[0]; ++i) {
    for (int j = -reach[1]; j <= reach[1]; ++j) {
      const Eigen::Vector2d by = lattice * Eigen::Vector2d(i, j);
      if ((by.cwiseAbs() - (upper - lower)).maxCoeff() <= structure.beam_width) result.push_back(by);
    }
  }
  return result;
}

/// Least distance between holes of different tiles, in mm: the thickness of the thinnest beam.
double least_gap(const Structure& structure) {
  const auto& placements = structure.tiling.placements;
  const std::vector<Eigen::Vector2d> translations = nearby_translations(structure);
  double least = INFINITY;
  for (std::size_t i = 0; i < placements.size(); ++i) {
    for (const Polygon& hole : structure.holes[placements[i].tile]) {
      const Polygon placed_hole = placed(hole, placements[i]);
      for (std::size_t j = i; j < placements.size(); ++j) {
        for (const Eigen::Vector2d& by : translations) {
          if (i == j && by.isZero()) continue;
          Placement moved = placements[j];
          moved.offset += by;
          for (const Polygon& other : structure.holes[moved.tile]) {
            least = std::min(least, outline_distance(placed_hole, placed(other, moved)));
          }
        }
      }
    }
  }
  return least;
}

/// Where a tile crosses itself the beams around its folded parts run through the holes of other tiles: takes them out
/// of the holes.
void keep_folded_beams(Structure& structure) {
  std::vector<Polygon> solid;
  const std::vector<Eigen::Vector2d> translations = nearby_translations(structure);
  for (const Placement& placement : structure.tiling.placements) {
    for (const Polygon& fold : folds(structure.tiling.tiles[placement.tile], structure.beam_width / 2)) {
      for (const Eigen::Vector2d& by : translations) {
        Placement moved = placement;
        moved.offset += by;
        solid.push_back(placed(fold, moved));
      }
    }
  }
  if (solid.empty()) return;
  // Copies of a tile are cut alike: the holes of the tile itself, by the folds as seen from its first placement.
  for (std::size_t tile = 0; tile < structure.holes.size(); ++tile) {
    const auto& placements = structure.tiling.placements;
    const auto of_tile = std::find_if(placements.begin(), placements.end(),
                                      [tile](const Placement& p) { return p.tile == static_cast<int>(tile); });
    Placement back;
    back.linear = of_tile->linear.transpose();
    back.offset = -back.linear * of_tile->offset;
    std::vector<Polygon> seen;
    seen.reserve(solid.size());
    for (const Polygon& polygon : solid) seen.push_back(placed(polygon, back));
    std::vector<Polygon> rest;
    for (const Polygon& hole : structure.holes[tile]) {
      for (Polygon& part : hole_outside(hole, seen, smallest_hole * structure.beam_width))
        rest.push_back(std::move(part));
    }
    structure.holes[tile] = std::move(rest);
  }
}

void check_crossings(Structure& structure) {
  for (const Polygon& tile : structure.tiling.tiles) {
    const auto crossing = self_intersection(tile);
    if (!crossing) continue;
    structure.tiles_cross = true;
    keep_folded_beams(structure);
    if (least_gap(structure) >= thinnest_beam * structure.beam_width) continue;
    const std::string message = "The tile's sides " + std::to_string(crossing->first) + " and " +
                                std::to_string(crossing->second) + " cross farther than beams hide.";
    throw Error("tiling.self_intersecting", "Family " + structure.family + ": " + message, {{"parameters", message}});
  }
}

}  // namespace

Structure make_structure(const Family& family, std::span<const double> parameters, double box_margin) {
  Structure structure;
  structure.family = family.id;
  structure.parameters.assign(parameters.begin(), parameters.end());
  structure.tiling = tiling_of(family, parameters, box_margin);
  structure.scale = structure.beam_width / family.beam_width;
  scale_by(structure.tiling, structure.scale);
  for (const Polygon& tile : structure.tiling.tiles)
    structure.holes.push_back(inset(tile, structure.beam_width / 2, smallest_hole * structure.beam_width));
  check_crossings(structure);
  for (std::size_t k = 0; k < structure.holes.size() && !family.holes_may_close; ++k) {
    if (!structure.holes[k].empty()) continue;
    std::ostringstream message;
    message << "Beams of " << structure.beam_width << " mm leave no hole in a tile of "
            << area(structure.tiling.tiles[k]) << " mm^2.";
    throw Error("tiling.hole_closed", "Family " + family.id + ": " + message.str(), {{"parameters", message.str()}});
  }
  structure.cell_area = std::abs(structure.tiling.lattice.determinant());
  structure.solid_area = structure.cell_area;
  for (const Placement& placement : structure.tiling.placements) {
    for (const Polygon& hole : structure.holes[placement.tile]) structure.solid_area -= area(hole);
  }
  return structure;
}

}  // namespace supple::tiling
