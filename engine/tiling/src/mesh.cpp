#include "supple/tiling/mesh.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>

#include "cell_meshes.h"
#include "file_makers.h"
#include "polygon.h"
#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {
namespace {

/// Smallest corner size. Finer grading would only resolve rounding errors.
constexpr double min_corner_size = 1e-3;

/// Largest difference between the areas of the triangles and of the solid, as a ratio to that of the cell.
constexpr double filled_area_tolerance = 1e-7;

/// If a mesh by tiles has a smaller angle (rad) than this, about 20 degrees, a mesh by cells is tried.
constexpr double min_acceptable_angle = 0.35;

double twice_area(const PeriodicMesh& mesh, int t) {
  const Eigen::Vector2d a = mesh.corner(t, 0);
  return cross(mesh.corner(t, 1) - a, mesh.corner(t, 2) - a);
}

void check_area(const PeriodicMesh& mesh, const Structure& structure) {
  const double solid_area = mesh.solid_area();
  if (std::abs(solid_area - structure.solid_area) <= filled_area_tolerance * structure.cell_area) return;
  std::ostringstream message;
  message << "The triangles cover " << solid_area << " mm^2 of a solid of " << structure.solid_area << " mm^2.";
  throw TilingError("tiling.mesh_not_periodic", message.str(), {{"parameters", message.str()}});
}

}  // namespace

void check_mesh_options(const MeshOptions& options) {
  std::vector<Error::Detail> details;
  const auto require = [&](bool holds, const char* where, const std::string& message) {
    if (!holds) details.push_back({where, message});
  };
  require(options.mesh_size > 0 && std::isfinite(options.mesh_size), "mesh_size",
          "must be a positive number, but is " + number_text(options.mesh_size));
  require(options.corner_size >= min_corner_size && options.corner_size <= 1, "corner_size",
          "must lie between 0.001 and 1, but is " + number_text(options.corner_size));
  require(options.max_nodes > 0, "max_nodes", "must be positive, but is " + std::to_string(options.max_nodes));
  if (details.empty()) return;
  throw MeshOptionError("tiling.mesh_option", "Mesh option " + details[0].where + " " + details[0].message + ".",
                        details);
}

void check_number_of_nodes(double nodes, const MeshOptions& options, const char* kind) {
  if (nodes <= options.max_nodes) return;
  std::ostringstream message;
  message.precision(3);
  message << "The mesh " << kind << " " << nodes << " nodes; the limit is " << options.max_nodes << ".";
  throw MeshTooLarge("tiling.mesh_too_large", message.str(), {{"mesh_size", message.str()}});
}

PeriodicMesh make_mesh(const Structure& structure, const MeshOptions& options) {
  check_mesh_options(options);
  double outline_length = 0;
  double corners = 0;
  for (const std::vector<Polygon>& holes : structure.holes) {
    for (const Polygon& hole : holes) {
      outline_length += perimeter(hole);
      corners += static_cast<double>(hole.size());
    }
  }
  const SizeField size(options, structure.beam_width);
  check_number_of_nodes(size.expected_nodes(structure.solid_area, corners), options, "would have about");

  const auto finish = [&](const TriangleSoup& soup) {
    PeriodicMesh mesh = wrap(soup, structure.tiling.lattice, outline_length);
    mesh.mesh_size = size.max_size();
    mesh.beam_width = structure.beam_width;
    check_number_of_nodes(static_cast<double>(mesh.nodes.cols()), options, "has");
    check_area(mesh, structure);
    return mesh;
  };
  if (options.region == Region::cell || structure.tiles_cross) return finish(mesh_by_parallelogram(structure, size));
  PeriodicMesh by_tiles = finish(mesh_by_tiles(structure, size));
  if (options.region == Region::tile) return by_tiles;
  const double smallest_angle = statistics(by_tiles).smallest_angle;
  if (smallest_angle >= min_acceptable_angle) return by_tiles;
  PeriodicMesh by_cell = finish(mesh_by_parallelogram(structure, size));
  return statistics(by_cell).smallest_angle > smallest_angle ? by_cell : by_tiles;
}

PeriodicMesh repeat(const PeriodicMesh& mesh, int first, int second) {
  // Shifts have 8 bits, which limits the number of cells.
  constexpr int max_cells = 100;
  if (first < 1 || second < 1 || first > max_cells || second > max_cells) {
    throw MeshOptionError(
        "tiling.mesh_option", "A patch has 1 to 100 cells along each translation.",
        {{"cells", "must be from 1 to 100, but are " + std::to_string(first) + " x " + std::to_string(second)}});
  }
  PeriodicMesh result = mesh;
  result.lattice.col(0) *= first;
  result.lattice.col(1) *= second;
  result.cells_first *= first;
  result.cells_second *= second;
  const Eigen::Index n = mesh.nodes.cols();
  const int triangles = static_cast<int>(mesh.triangles.size());
  result.nodes.resize(2, n * first * second);
  result.triangles.clear();
  result.shifts.clear();
  result.outline.clear();
  const auto floor_divide = [](int a, int b) { return a >= 0 ? a / b : -((-a + b - 1) / b); };
  for (int b = 0; b < second; ++b) {
    for (int a = 0; a < first; ++a) {
      const int copy = a + first * b;
      result.nodes.middleCols(n * copy, n) = mesh.nodes.colwise() + mesh.lattice * Eigen::Vector2d(a, b);
      for (int t = 0; t < triangles; ++t) {
        auto nodes = mesh.triangles[t];
        auto shifts = mesh.shifts[t];
        for (int k = 0; k < 6; ++k) {
          const int i = a + shifts[k].first, j = b + shifts[k].second;
          const int over_i = floor_divide(i, first), over_j = floor_divide(j, second);
          nodes[k] += static_cast<int>(n) * (i - first * over_i + first * (j - second * over_j));
          shifts[k] = {static_cast<std::int8_t>(over_i), static_cast<std::int8_t>(over_j)};
        }
        result.triangles.push_back(nodes);
        result.shifts.push_back(shifts);
      }
      for (const auto& [triangle, side] : mesh.outline) result.outline.push_back({triangle + triangles * copy, side});
    }
  }
  return result;
}

Eigen::Vector2d PeriodicMesh::corner(int t, int k) const {
  const LatticeShift& shift = shifts[t][k];
  return nodes.col(triangles[t][k]) + lattice * Eigen::Vector2d(shift.first, shift.second);
}

double PeriodicMesh::cell_area() const { return std::abs(lattice.determinant()); }

double PeriodicMesh::solid_area() const {
  double twice = 0;
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) twice += twice_area(*this, t);
  return twice / 2;
}

MeshStatistics statistics(const PeriodicMesh& mesh) {
  MeshStatistics result;
  result.nodes = static_cast<int>(mesh.nodes.cols());
  result.triangles = static_cast<int>(mesh.triangles.size());
  result.smallest_angle = std::numeric_limits<double>::infinity();
  result.shortest_side = std::numeric_limits<double>::infinity();
  for (int t = 0; t < result.triangles; ++t) {
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d at = mesh.corner(t, k);
      const Eigen::Vector2d to = mesh.corner(t, (k + 1) % 3) - at, from = mesh.corner(t, (k + 2) % 3) - at;
      result.smallest_angle = std::min(result.smallest_angle, std::atan2(cross(to, from), to.dot(from)));
      result.shortest_side = std::min(result.shortest_side, to.norm());
      result.longest_side = std::max(result.longest_side, to.norm());
    }
  }
  result.relative_density = mesh.solid_area() / mesh.cell_area();
  return result;
}

}  // namespace supple::tiling
