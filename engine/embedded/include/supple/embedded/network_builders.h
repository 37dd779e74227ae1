#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "supple/base/execution.h"
#include "supple/embedded/network.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::embedded {

/// One point in each face, at the given barycentric coordinates (nonnegative, of sum 1, else "point.outside_face"), in
/// the order of the faces.
std::vector<surface::SurfacePoint> points_in_faces(const surface::TriangleMesh& mesh,
                                                   const Eigen::Vector3d& barycentric);

/// Random points of which no two are nearer than `radius` (geodesic distance, mesh units), until no free place was
/// found in 30 tries round each point (Bridson 2007, on the surface) or in tries spread over the area. The same seed
/// gives the same points. Throws "network.radius" (not positive, or so small that more than `most_points` may fit).
std::vector<surface::SurfacePoint> poisson_disk_points(const surface::GeodesicSolver& solver, double radius,
                                                       std::uint64_t seed = 1, std::size_t most_points = 100'000,
                                                       const Execution& execution = {});

using Pair = std::pair<std::int32_t, std::int32_t>;

/// Pairs of points whose faces share an edge, each once: the dual graph of the mesh where each face has one point. Of
/// several points in a face each is paired with those of the neighbours.
std::vector<Pair> pairs_of_adjacent_faces(const surface::TriangleMesh& mesh,
                                          const std::vector<surface::SurfacePoint>& points);

struct Triangulation {
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< indices of points, counterclockwise
  std::vector<Pair> edges;                             ///< each once, first < second, ascending
};

/// Connects points whose geodesic Voronoi cells meet: edges where two cells share a border, triangles where three meet.
/// The cells are looked for at some 64 places for each point, spread evenly over each face: cells and borders much
/// smaller than the average may be missed. One distance field over the mesh, then a microsecond for each place.
Triangulation triangulate(const surface::GeodesicSolver& solver, const std::vector<surface::SurfacePoint>& points,
                          const Execution& execution = {});

/// Triangles that are at rest where the points are now, but for a factor on all rest lengths: below 1 they are
/// stretched from the start. `corners` are indices of `points`. A search for each side, in parallel. Throws
/// "network.triangle" for unknown points.
std::vector<MembraneTriangle> membrane_at_rest(const surface::GeodesicSolver& solver,
                                               const std::vector<surface::SurfacePoint>& points,
                                               const std::vector<std::array<std::int32_t, 3>>& corners,
                                               double scale = 1, const Execution& execution = {});

}  // namespace supple::embedded
