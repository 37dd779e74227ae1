#include "supple/tiling/structure.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "beams.h"
#include "polygon.h"
#include "supple/base/error.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {
namespace {

/// Ratio to the beam width below which holes are closed, and sides of holes become points: 1.5 micrometres, which no
/// printer makes and which would require elements as small.
constexpr double min_hole_width = 0.005;

void scale_by(Tiling& tiling, double scale) {
  for (Polygon& tile : tiling.tiles) {
    for (Eigen::Vector2d& vertex : tile) vertex *= scale;
  }
  for (Placement& placement : tiling.placements) placement.offset *= scale;
  tiling.lattice *= scale;
}

/// Calls visit(translate) for every translate of the polygon whose bounds come within `margin` of the given ones.
template <class Visit>
void for_translates_near(const Bounds& bounds, double margin, const Polygon& polygon, const Eigen::Matrix2d& lattice,
                         const Visit& visit) {
  const Bounds own = bounds_of(polygon);
  const Eigen::Vector2d lower = bounds.lower - own.upper - Eigen::Vector2d::Constant(margin);
  const Eigen::Vector2d upper = bounds.upper - own.lower + Eigen::Vector2d::Constant(margin);
  const Eigen::Matrix2d inverse = lattice.inverse();
  const Eigen::Vector2d middle = inverse * (lower + upper) / 2;
  const Eigen::Vector2d reach = inverse.cwiseAbs() * (upper - lower) / 2;
  for (int i = static_cast<int>(std::ceil(middle[0] - reach[0])); i <= middle[0] + reach[0]; ++i) {
    for (int j = static_cast<int>(std::ceil(middle[1] - reach[1])); j <= middle[1] + reach[1]; ++j) {
      const Eigen::Vector2d translation = lattice * Eigen::Vector2d(i, j);
      if ((translation - lower).minCoeff() < 0 || (upper - translation).minCoeff() < 0) continue;
      visit(moved(polygon, translation));
    }
  }
}

std::vector<Polygon> placed_tiles(const Tiling& tiling) {
  std::vector<Polygon> result;
  result.reserve(tiling.placements.size());
  for (const Placement& placement : tiling.placements)
    result.push_back(placed(tiling.tiles[placement.tile], placement));
  return result;
}

/// All holes that lie in the bounds. The result also has other polygons: holes beyond the bounds, and pieces of them.
std::vector<Polygon> holes_around(const Bounds& bounds, const std::vector<Polygon>& tiles, const Structure& structure) {
  std::vector<Polygon> beams;
  // These are the beams of every tile that meets the bounds, and of tiles whose beams reach into them.
  for (const Polygon& tile : tiles) {
    for_translates_near(bounds, structure.beam_width, tile, structure.tiling.lattice, [&](const Polygon& copy) {
      for (Polygon& beam : beams_along(copy, structure.beam_width / 2, Joints::left))
        if (bounds.meet(bounds_of(beam))) beams.push_back(std::move(beam));
    });
  }
  return holes_between(beams, min_hole_width * structure.beam_width);
}

/// Makes the holes of tiles that do not cross themselves, which contain their holes. Holes are computed for the first
/// copy of each tile, and placed in the others.
void make_holes_by_tiles(Structure& structure) {
  const std::vector<Placement>& placements = structure.tiling.placements;
  const std::vector<Polygon> tiles = placed_tiles(structure.tiling);
  structure.holes.resize(placements.size());
  for (std::size_t k = 0; k < placements.size(); ++k) {
    const auto first = std::find_if(placements.begin(), placements.end(),
                                    [&](const Placement& p) { return p.tile == placements[k].tile; });
    const std::size_t original = static_cast<std::size_t>(first - placements.begin());
    if (original == k) {
      for (Polygon& hole : holes_around(bounds_of(tiles[k]), tiles, structure)) {
        if (winding_number(tiles[k], hole[0]) != 0) structure.holes[k].push_back(std::move(hole));
      }
      continue;
    }
    const Placement relative = {
        .tile = 0,
        .linear = placements[k].linear * first->linear.transpose(),
        .offset = placements[k].offset - placements[k].linear * first->linear.transpose() * first->offset};
    for (const Polygon& hole : structure.holes[original]) structure.holes[k].push_back(placed(hole, relative));
  }
}

/// A number within [0, 1) that is as far as possible from all given numbers, modulo 1.
double farthest_from(std::vector<double> numbers) {
  for (double& x : numbers) x -= std::floor(x);
  std::sort(numbers.begin(), numbers.end());
  double gap = numbers.front() + 1 - numbers.back(), middle = numbers.back() + gap / 2;
  for (std::size_t k = 0; k + 1 < numbers.size(); ++k) {
    if (numbers[k + 1] - numbers[k] > gap) {
      gap = numbers[k + 1] - numbers[k];
      middle = numbers[k] + gap / 2;
    }
  }
  return middle - std::floor(middle);
}

/// Makes the holes of tiles that cross themselves, where a hole may lie in several tiles. It chooses one hole of each
/// class of translates, and moves it into a placed tile that winds around it.
void make_holes_by_cell(Structure& structure) {
  const Eigen::Matrix2d& lattice = structure.tiling.lattice;
  const Eigen::Matrix2d inverse = lattice.inverse();
  const std::vector<Polygon> tiles = placed_tiles(structure.tiling);
  structure.holes.resize(tiles.size());
  // The holes that are chosen have their centroids in a cell whose origin lies in [0, 1)^2, in lattice coordinates, and
  // which therefore lies in [0, 2]^2. A hole lies in a tile, so that it extends beyond by at most a tile's extent.
  Bounds bounds;
  double extent = 0;
  for (const Polygon& tile : tiles) {
    const Bounds own = bounds_of(tile);
    extent = std::max(extent, (own.upper - own.lower).maxCoeff());
  }
  for (const double i : {0.0, 2.0}) {
    for (const double j : {0.0, 2.0}) bounds.include({lattice * Eigen::Vector2d(i, j)});
  }
  bounds.lower.array() -= extent;
  bounds.upper.array() += extent;
  const std::vector<Polygon> holes = holes_around(bounds, tiles, structure);
  if (holes.empty()) return;
  std::vector<Eigen::Vector2d> centroids;
  std::vector<double> along_first, along_second;
  for (const Polygon& hole : holes) {
    centroids.emplace_back(inverse * centroid(hole));
    along_first.push_back(centroids.back()[0]);
    along_second.push_back(centroids.back()[1]);
  }
  const Eigen::Vector2d origin(farthest_from(along_first), farthest_from(along_second));
  for (std::size_t k = 0; k < holes.size(); ++k) {
    const Eigen::Vector2d at = centroids[k] - origin;
    if (at.minCoeff() < 0 || at.maxCoeff() >= 1) continue;
    bool found = false;
    for (std::size_t tile = 0; tile < tiles.size() && !found; ++tile) {
      for_translates_near(bounds_of(holes[k]), 0, tiles[tile], lattice, [&](const Polygon& copy) {
        if (found || winding_number(copy, holes[k][0]) <= 0) return;
        found = true;
        structure.holes[tile].push_back(moved(holes[k], tiles[tile][0] - copy[0]));
      });
    }
  }
}

void check_holes_are_open(const Structure& structure) {
  const auto refuse = [&](std::size_t k) {
    std::ostringstream message;
    message << "Beams of " << structure.beam_width << " mm leave no hole in a tile of "
            << area(structure.tiling.tiles[structure.tiling.placements[k].tile]) << " mm^2.";
    throw TilingError("tiling.hole_closed", "Family " + structure.family + ": " + message.str(),
                      {{"parameters", message.str()}});
  };
  // Tiles that overlap share holes, each of which is listed with only one of them.
  const auto closed = [](const std::vector<Polygon>& holes) { return holes.empty(); };
  if (structure.tiles_cross) {
    if (std::all_of(structure.holes.begin(), structure.holes.end(), closed)) refuse(0);
    return;
  }
  const auto found = std::find_if(structure.holes.begin(), structure.holes.end(), closed);
  if (found != structure.holes.end()) refuse(static_cast<std::size_t>(found - structure.holes.begin()));
}

/// One side of an outline.
struct Segment {
  Eigen::Vector2d begin, end;
};

double distance(const Eigen::Vector2d& point, const Segment& segment) {
  const Eigen::Vector2d along = segment.end - segment.begin, from = point - segment.begin;
  const double length = along.squaredNorm();
  const double fraction = length > 0 ? std::clamp(from.dot(along) / length, 0.0, 1.0) : 0;
  return (from - fraction * along).norm();
}

struct FarPoint {
  Eigen::Vector2d point;
  double distance = 0;
};

/// Searches for a point of the tile that is farther than `wanted` from all segments: over a grid, then by a pattern
/// search from the best point. Returns the first such point, or else the farthest one.
FarPoint point_far_from(const std::vector<Segment>& segments, const Polygon& tile, double wanted) {
  constexpr int rows = 9;
  constexpr int halvings = 6;  // number of times that the grid's step is halved
  const auto clearance = [&](const Eigen::Vector2d& point, double lower_bound) {
    double smallest = INFINITY;
    for (const Segment& segment : segments) {
      smallest = std::min(smallest, distance(point, segment));
      if (smallest <= lower_bound) break;
    }
    return smallest;
  };
  const Bounds bounds = bounds_of(tile);
  Eigen::Vector2d step = (bounds.upper - bounds.lower) / rows;
  FarPoint best{bounds.lower};
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < rows; ++j) {
      const Eigen::Vector2d point = bounds.lower + step.cwiseProduct(Eigen::Vector2d(i + 0.5, j + 0.5));
      const double here = clearance(point, best.distance);
      if (here <= best.distance || winding_number(tile, point) == 0) continue;
      best = {point, here};
      if (here > wanted) return best;
    }
  }
  if (best.distance == 0) return best;
  for (int halving = 0; halving < halvings; ++halving) {
    step /= 2;
    for (const Eigen::Vector2d& side :
         {Eigen::Vector2d(1, 0), Eigen::Vector2d(0, 1), Eigen::Vector2d(-1, 0), Eigen::Vector2d(0, -1)}) {
      const Eigen::Vector2d point = best.point + step.cwiseProduct(side);
      const double here = clearance(point, best.distance);
      if (here <= best.distance || winding_number(tile, point) == 0) continue;
      best = {point, here};
      if (here > wanted) return best;
    }
  }
  return best;
}

/// Whether a hole remains around the point that lies within a square of half side `reach` around it.
bool has_hole_around(const Eigen::Vector2d& point, const std::vector<Polygon>& outlines, double beam_width,
                     double reach) {
  Bounds window;
  window.include({point - Eigen::Vector2d::Constant(reach), point + Eigen::Vector2d::Constant(reach)});
  std::vector<Polygon> beams;
  for (const Polygon& outline : outlines) {
    if (!window.meet(bounds_of(outline), beam_width)) continue;
    for (Polygon& beam : beams_along(outline, beam_width / 2, Joints::left))
      if (window.meet(bounds_of(beam))) beams.push_back(std::move(beam));
  }
  for (const Polygon& hole : holes_between(beams, min_hole_width * beam_width)) {
    if (window.contain(bounds_of(hole)) && winding_number(hole, point) != 0) return true;
  }
  return false;
}

/// Whether a hole is certain to remain in the tile. Square joints extend to sqrt(2) half widths at most, where a side
/// folds back. A point that is farther from all sides lies in a hole, and so does a disc around it. The hole remains
/// (see `remains` in clipper_paths.h) if the area of the disc is large enough for the longest possible boundary of the
/// hole: twice the sides that come within `reach` of the tile. The given outlines must contain all these sides.
bool has_certain_hole(const Polygon& tile, const std::vector<Polygon>& outlines, double beam_width, double reach) {
  const Bounds bounds = bounds_of(tile);
  const double diagonal = (bounds.upper - bounds.lower).norm();
  std::vector<Segment> segments;
  double boundary = 0;
  for (const Polygon& outline : outlines) {
    for (std::size_t k = 0; k < outline.size(); ++k) {
      const Segment segment{outline[k], outline[(k + 1) % outline.size()]};
      if (!bounds.meet(bounds_of({segment.begin, segment.end}), reach)) continue;
      segments.push_back(segment);
      boundary += std::min((segment.end - segment.begin).norm(), diagonal + 2 * reach);
    }
  }
  const double radius = std::sqrt(min_hole_width * beam_width * 2 * boundary / (2 * std::numbers::pi));
  const double wanted = std::numbers::sqrt2 * beam_width / 2 + radius;
  const FarPoint far = point_far_from(segments, tile, wanted);
  if (wanted <= reach && far.distance > wanted) return true;
  // With a single tile, the beams of other tiles are not known, and making all holes is quick.
  if (outlines.size() == 1 || far.distance < beam_width / 2) return false;
  return has_hole_around(far.point, outlines, beam_width, reach / 2) ||
         has_hole_around(far.point, outlines, beam_width, reach);
}

/// Whether holes are certain to remain wherever `check_holes_are_open` requires one.
bool has_certain_holes(const Tiling& tiling, bool tiles_cross, double beam_width) {
  const double reach = 4 * beam_width;
  if (!tiles_cross)
    return std::all_of(tiling.tiles.begin(), tiling.tiles.end(),
                       [&](const Polygon& tile) { return has_certain_hole(tile, {tile}, beam_width, reach); });
  // Sides of other tiles run through the tile.
  const std::vector<Polygon> tiles = placed_tiles(tiling);
  return std::any_of(tiles.begin(), tiles.end(), [&](const Polygon& tile) {
    std::vector<Polygon> outlines;
    for (const Polygon& other : tiles)
      for_translates_near(bounds_of(tile), reach, other, tiling.lattice,
                          [&](const Polygon& copy) { outlines.push_back(copy); });
    return has_certain_hole(tile, outlines, beam_width, reach);
  });
}

/// Whether a hole lies within a few beam widths of one cell. Tiles that cross themselves have small holes where their
/// beams are dense. To make all holes around the cell there (`make_holes_by_cell`) costs a hundred times as much.
bool has_hole_near_cell(const Tiling& tiling, double beam_width) {
  Structure structure;
  structure.beam_width = beam_width;
  structure.tiling = tiling;
  Bounds bounds;
  for (const double i : {0.0, 1.0})
    for (const double j : {0.0, 1.0}) bounds.include({tiling.lattice * Eigen::Vector2d(i, j)});
  bounds.lower.array() -= 4 * beam_width;
  bounds.upper.array() += 4 * beam_width;
  const std::vector<Polygon> holes = holes_around(bounds, placed_tiles(tiling), structure);
  return std::any_of(holes.begin(), holes.end(), [&](const Polygon& hole) { return bounds.contain(bounds_of(hole)); });
}

bool cross_themselves(const std::vector<Polygon>& tiles) {
  return std::any_of(tiles.begin(), tiles.end(),
                     [](const Polygon& tile) { return self_intersection(tile).has_value(); });
}

}  // namespace

bool can_be_built(const Family& family, std::span<const double> parameters) {
  try {
    Tiling tiling = tiling_of(family, parameters);
    if (family.holes_may_close) return true;
    scale_by(tiling, printed_beam_width / beam_width_at(family, parameters));
    const bool tiles_cross = cross_themselves(tiling.tiles);
    if (has_certain_holes(tiling, tiles_cross, printed_beam_width)) return true;
    if (tiles_cross && has_hole_near_cell(tiling, printed_beam_width)) return true;
    make_structure(family, parameters);
    return true;
  } catch (const TilingError&) {
    return false;
  }
}

Structure make_structure(const Family& family, std::span<const double> parameters, double box_margin) {
  Structure structure;
  structure.family = family.id;
  structure.parameters.assign(parameters.begin(), parameters.end());
  structure.tiling = tiling_of(family, parameters, box_margin);
  structure.scale = structure.beam_width / beam_width_at(family, parameters);
  scale_by(structure.tiling, structure.scale);
  structure.tiles_cross = cross_themselves(structure.tiling.tiles);
  if (structure.tiles_cross) {
    make_holes_by_cell(structure);
  } else {
    make_holes_by_tiles(structure);
  }
  if (!family.holes_may_close) check_holes_are_open(structure);
  structure.cell_area = std::abs(structure.tiling.lattice.determinant());
  structure.solid_area = structure.cell_area;
  for (const std::vector<Polygon>& holes : structure.holes) {
    for (const Polygon& hole : holes) structure.solid_area -= area(hole);
  }
  return structure;
}

Structure make_structure(std::string_view family_id, std::span<const double> parameters) {
  const Family& found = family(family_id);
  return parameters.empty() ? make_structure(found, presets(found)) : make_structure(found, parameters);
}

Structure scaled(Structure structure, double beam_width) {
  const double factor = beam_width / structure.beam_width;
  const auto scale = [factor](Polygon& polygon) {
    for (Eigen::Vector2d& corner : polygon) corner *= factor;
  };
  for (Polygon& tile : structure.tiling.tiles) scale(tile);
  for (Placement& placement : structure.tiling.placements) placement.offset *= factor;
  structure.tiling.lattice *= factor;
  for (auto& holes : structure.holes)
    for (Polygon& hole : holes) scale(hole);
  structure.beam_width = beam_width;
  structure.scale *= factor;
  structure.cell_area *= factor * factor;
  structure.solid_area *= factor * factor;
  return structure;
}

}  // namespace supple::tiling
