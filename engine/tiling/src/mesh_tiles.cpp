#include <Eigen/LU>
#include <algorithm>
#include <utility>

#include "cell_meshes.h"
#include "polygon.h"
#include "triangulation.h"

namespace supple::tiling {
namespace {

/// The outline with further nodes, whose number on a side depends on the side's length only, so that neighbours match.
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
  std::vector<meshing::PlanarMesh> tile_meshes;
  std::vector<std::size_t> outline_points;
  for (std::size_t tile = 0; tile < structure.tiling.tiles.size(); ++tile) {
    const auto first = std::find_if(placements.begin(), placements.end(),
                                    [&](const Placement& p) { return p.tile == static_cast<int>(tile); });
    // The holes are moved from the first placement to the tile's own coordinates.
    const Eigen::Matrix2d inverse = first->linear.transpose();
    const Placement to_tile = {.tile = 0, .linear = inverse, .offset = -inverse * first->offset};
    std::vector<Polygon> holes;
    for (const Polygon& hole : structure.holes[static_cast<std::size_t>(first - placements.begin())])
      holes.push_back(placed(hole, to_tile));
    // Corners of the holes of other tiles are at least half a beam width from this one, and do not influence it.
    size.remove_corners();
    for (const Polygon& hole : holes) size.add_corners(hole);
    Face face = {divided_outline(structure.tiling.tiles[tile], size.max_size())};
    for (const Polygon& hole : holes) face.push_back(divided_hole(hole, size));
    outline_points.push_back(face[0].size());
    tile_meshes.push_back(triangulate({face}, size));
  }
  TriangleSoup soup;
  for (const Placement& placement : structure.tiling.placements) {
    const meshing::PlanarMesh& tile_mesh = tile_meshes[placement.tile];
    const int first = static_cast<int>(soup.points.size());
    for (std::size_t k = 0; k < tile_mesh.points.size(); ++k) {
      soup.points.emplace_back(placement.linear * tile_mesh.points[k] + placement.offset);
      soup.seam.push_back(k < outline_points[placement.tile]);
    }
    const bool reflected = placement.linear.determinant() < 0;
    for (auto [a, b, c] : tile_mesh.triangles) {
      if (reflected) std::swap(b, c);
      soup.triangles.push_back({first + a, first + b, first + c});
    }
  }
  return soup;
}

}  // namespace supple::tiling
