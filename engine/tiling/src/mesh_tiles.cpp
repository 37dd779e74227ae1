#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "cell_meshes.h"
#include "polygon.h"
#include "supple/meshing/planar_mesh.h"

namespace supple::tiling {
namespace {

/// The outline with a multiple of nodes that depends only on each side's length, so that neighbours match.
Polygon divided_outline(const Polygon& tile, double size) {
  Polygon result;
  for (std::size_t k = 0; k < tile.size(); ++k) {
    result.push_back(tile[k]);
    for (const Eigen::Vector2d& p : divide_equally(tile[k], tile[(k + 1) % tile.size()], size)) result.push_back(p);
  }
  return result;
}

Polygon divided_hole(const Polygon& hole, const SizeField& size) {
  Polygon result;
  for (std::size_t k = 0; k < hole.size(); ++k) {
    result.push_back(hole[k]);
    for (const Eigen::Vector2d& p : size.divide(hole[k], hole[(k + 1) % hole.size()])) result.push_back(p);
  }
  return result;
}

}  // namespace

TriangleSoup mesh_by_tiles(const Structure& structure, SizeField size) {
  const std::vector<Placement>& placements = structure.tiling.placements;
  std::vector<meshing::PlanarMesh> rings;
  std::vector<std::size_t> outline_points;
  for (std::size_t tile = 0; tile < structure.tiling.tiles.size(); ++tile) {
    const auto first = std::find_if(placements.begin(), placements.end(),
                                    [&](const Placement& p) { return p.tile == static_cast<int>(tile); });
    // Back to where the tile lies by itself.
    const Eigen::Matrix2d turn = first->linear.transpose();
    const Placement back = {.tile = 0, .linear = turn, .offset = -turn * first->offset};
    std::vector<Polygon> holes;
    for (const Polygon& hole : structure.holes[static_cast<std::size_t>(first - placements.begin())])
      holes.push_back(placed(hole, back));
    // Corners of the holes of other tiles are at least half a beam width from this one: they do not reach it.
    size.remove_corners();
    for (const Polygon& hole : holes) size.add_corners(hole);
    Face ring = {divided_outline(structure.tiling.tiles[tile], size.largest())};
    for (const Polygon& hole : holes) ring.push_back(divided_hole(hole, size));
    outline_points.push_back(ring[0].size());
    rings.push_back(meshing::triangulate({ring}, size));
  }
  TriangleSoup soup;
  for (const Placement& placement : structure.tiling.placements) {
    const meshing::PlanarMesh& ring = rings[placement.tile];
    const int first = static_cast<int>(soup.points.size());
    for (std::size_t k = 0; k < ring.points.size(); ++k) {
      soup.points.emplace_back(placement.linear * ring.points[k] + placement.offset);
      soup.seam.push_back(k < outline_points[placement.tile]);
    }
    const bool reflected = placement.linear.determinant() < 0;
    for (auto [a, b, c] : ring.triangles) {
      if (reflected) std::swap(b, c);
      soup.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return soup;
}

}  // namespace supple::tiling
