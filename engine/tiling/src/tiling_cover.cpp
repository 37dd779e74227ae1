#include "tiling_cover.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "polygon.h"
#include "supple/base/number_text.h"

namespace supple::tiling {
namespace {

/// Distance up to which points are the same, in sides of a square of the cell's area. Tables have twelve digits.
constexpr double match_tolerance = 1e-7;
/// Translations are parallel if the cell's area is a smaller fraction of the product of their lengths.
constexpr double min_cell_area = 1e-6;
/// Points of the raster that is searched for gaps and overlaps, along each translation.
constexpr int raster = 40;
/// Sides of translates that are examined at each point of the raster, at most. Tiles that overlap so often need no
/// place.
constexpr double max_examined_sides = 3e5;

/// A placed edge: its points in the direction in which its tile lies to the left.
struct PlacedEdge {
  std::size_t edge, placement;
  Polygon points;
};

std::vector<PlacedEdge> placed_edges(const Tiling& tiling, std::span<const std::size_t> starts) {
  std::vector<PlacedEdge> result;
  const Polygon& tile = tiling.tiles[0];
  for (std::size_t j = 0; j < tiling.placements.size(); ++j) {
    const auto& [index, linear, offset] = tiling.placements[j];
    for (std::size_t k = 0; k + 1 < starts.size(); ++k) {
      PlacedEdge placed{k, j, {}};
      for (std::size_t i = starts[k]; i <= starts[k + 1]; ++i)
        placed.points.emplace_back(linear * tile[i % tile.size()] + offset);
      if (linear.determinant() < 0) std::reverse(placed.points.begin(), placed.points.end());
      result.push_back(std::move(placed));
    }
  }
  return result;
}

/// Compares placed edges up to translations of the lattice.
class EdgeMatcher {
 public:
  explicit EdgeMatcher(const Eigen::Matrix2d& lattice)
      : lattice_(lattice),
        inverse_(lattice.inverse()),
        tolerance_(match_tolerance * std::sqrt(std::abs(lattice.determinant()))) {}

  bool opposite(const PlacedEdge& a, const PlacedEdge& b) const {
    const std::size_t last = b.points.size() - 1;
    return same(a, b, [&](std::size_t i) { return b.points[last - i]; });
  }
  bool equal(const PlacedEdge& a, const PlacedEdge& b) const {
    return same(a, b, [&](std::size_t i) { return b.points[i]; });
  }

 private:
  template <class PointOf>
  bool same(const PlacedEdge& a, const PlacedEdge& b, const PointOf& point_of_b) const {
    if (a.points.size() != b.points.size()) return false;
    const Eigen::Vector2d steps = inverse_ * (a.points[0] - point_of_b(0));
    const Eigen::Vector2d translation = lattice_ * Eigen::Vector2d(std::round(steps[0]), std::round(steps[1]));
    for (std::size_t i = 0; i < a.points.size(); ++i)
      if ((a.points[i] - point_of_b(i) - translation).norm() > tolerance_) return false;
    return true;
  }

  Eigen::Matrix2d lattice_, inverse_;
  double tolerance_;
};

/// The first placed edge that is not the edge of exactly one other tile.
const PlacedEdge* unmatched_edge(const std::vector<PlacedEdge>& edges, const EdgeMatcher& matcher) {
  const auto found = std::find_if(edges.begin(), edges.end(), [&](const PlacedEdge& edge) {
    int neighbours = 0, copies = 0;
    for (const PlacedEdge& other : edges) {
      neighbours += matcher.opposite(edge, other);
      copies += matcher.equal(edge, other);
    }
    return neighbours != 1 || copies != 1;
  });
  return found == edges.end() ? nullptr : &*found;
}

/// How often the placed tiles wind around a point, and how far their outlines are.
struct Covering {
  int windings = 0;
  double distance = INFINITY;
};

/// The steps of the lattice from a point to the translates of a tile whose bounds contain it, and to those next to
/// them.
struct Steps {
  Eigen::Vector2d middle, reach;

  Steps(const Eigen::Vector2d& point, const Bounds& bounds, const Eigen::Matrix2d& inverse)
      : middle(inverse * (point - bounds.middle())),
        reach(inverse.cwiseAbs() * (bounds.upper - bounds.lower) / 2 + Eigen::Vector2d::Ones()) {}
};

double sides_to_examine(const std::vector<Polygon>& tiles, const Eigen::Matrix2d& lattice) {
  const Eigen::Matrix2d inverse = lattice.inverse();
  double sides = 0;
  for (const Polygon& tile : tiles) {
    const Steps steps(Eigen::Vector2d::Zero(), bounds_of(tile), inverse);
    sides += (2 * steps.reach[0] + 1) * (2 * steps.reach[1] + 1) * static_cast<double>(tile.size());
  }
  return sides;
}

Covering covering_at(const Eigen::Vector2d& point, const std::vector<Polygon>& tiles, const Eigen::Matrix2d& lattice) {
  Covering covering;
  const Eigen::Matrix2d inverse = lattice.inverse();
  for (const Polygon& tile : tiles) {
    const auto [middle, reach] = Steps(point, bounds_of(tile), inverse);
    for (int i = static_cast<int>(std::ceil(middle[0] - reach[0])); i <= middle[0] + reach[0]; ++i)
      for (int j = static_cast<int>(std::ceil(middle[1] - reach[1])); j <= middle[1] + reach[1]; ++j) {
        const Eigen::Vector2d from = point - lattice * Eigen::Vector2d(i, j);
        covering.windings += winding_number(tile, from);
        for (std::size_t k = 0; k < tile.size(); ++k)
          covering.distance =
              std::min(covering.distance, distance_to_segment(from, tile[k], tile[(k + 1) % tile.size()]));
      }
  }
  return covering;
}

std::string place_text(const Eigen::Vector2d& point) {
  return "(" + number_text(point.x()) + ", " + number_text(point.y()) + ")";
}

/// The deepest gap that the raster finds, or else the deepest overlap.
std::optional<CoverFault> gap_or_overlap(const Tiling& tiling, const Execution& execution) {
  std::vector<Polygon> tiles;
  for (const Placement& placement : tiling.placements) tiles.push_back(placed(tiling.tiles[0], placement));
  if (sides_to_examine(tiles, tiling.lattice) > max_examined_sides) return std::nullopt;
  std::optional<CoverFault> gap, overlap;
  double gap_depth = 0, overlap_depth = 0;
  for (int i = 0; i < raster; ++i)
    for (int j = 0; j < raster; ++j) {
      execution.cancellation.throw_if_requested();
      const Eigen::Vector2d point = tiling.lattice * Eigen::Vector2d(i + 0.5, j + 0.5) / raster;
      const auto [windings, distance] = covering_at(point, tiles, tiling.lattice);
      if (windings < 1 && distance > gap_depth) {
        gap_depth = distance;
        gap = {DefinitionFlaw::gap, {}, "leaves a gap at " + place_text(point) + ": no tile covers this place", point};
      } else if (windings > 1 && distance > overlap_depth) {
        overlap_depth = distance;
        overlap = {DefinitionFlaw::overlap,
                   {},
                   "overlaps at " + place_text(point) + ": " + std::to_string(windings) + " tiles cover this place",
                   point};
      }
    }
  return gap ? gap : overlap;
}

}  // namespace

std::optional<CoverFault> cover_fault(const Tiling& tiling, std::span<const std::size_t> edge_starts,
                                      const Execution& execution) {
  const double cell = std::abs(tiling.lattice.determinant());
  if (!(cell > min_cell_area * tiling.lattice.col(0).norm() * tiling.lattice.col(1).norm()))
    return CoverFault{DefinitionFlaw::field, {}, "has translations that are parallel", {}};
  const std::vector<PlacedEdge> edges = placed_edges(tiling, edge_starts);
  const PlacedEdge* unmatched = unmatched_edge(edges, EdgeMatcher(tiling.lattice));
  const double ratio = static_cast<double>(tiling.placements.size()) * area(tiling.tiles[0]) / cell;
  if (!unmatched && std::abs(ratio - 1) <= match_tolerance) return std::nullopt;
  std::optional<CoverFault> fault = gap_or_overlap(tiling, execution);
  if (!fault && unmatched && std::abs(ratio - 1) <= match_tolerance) {
    const Eigen::Vector2d middle = (unmatched->points.front() + unmatched->points.back()) / 2;
    fault = {DefinitionFlaw::unmatched, unmatched->edge,
             "has an edge near " + place_text(middle) + " that is no edge of exactly one other tile", middle};
  }
  if (!fault) {
    const std::string tiles = "has tiles of " + number_text(ratio) + " times the cell's area";
    fault = {ratio < 1 ? DefinitionFlaw::gap : DefinitionFlaw::overlap, {}, tiles, {}};
  }
  if (unmatched) fault->edge = unmatched->edge;
  return fault;
}

}  // namespace supple::tiling
