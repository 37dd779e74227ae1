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

/// One point in each face, in the order of the faces, at the given barycentric coordinates. Throws "point.outside_face"
/// unless they are nonnegative and their sum is 1.
std::vector<surface::SurfacePoint> points_in_faces(const surface::TriangleMesh& mesh,
                                                   const Eigen::Vector3d& barycentric);

/// Random points of which no two are nearer than `radius` (geodesic distance, mesh units): Poisson disk sampling
/// [Bridson2007] on the surface, with 30 tries around each point. The same seed gives the same points. Throws
/// "network.radius" if the radius is not positive, or so small that more than `max_points` may fit.
std::vector<surface::SurfacePoint> poisson_disk_points(const surface::GeodesicSolver& solver, double radius,
                                                       std::uint64_t seed = 1, std::size_t max_points = 100'000,
                                                       const Execution& execution = {});

using Pair = std::pair<std::int32_t, std::int32_t>;

/// Pairs of points whose faces share an edge, each once. They are the dual graph of the mesh if each face has one
/// point. If a face has several, each is paired with all those of the neighbouring faces.
std::vector<Pair> pairs_of_adjacent_faces(const surface::TriangleMesh& mesh,
                                          const std::vector<surface::SurfacePoint>& points);

struct Triangulation {
  std::vector<std::array<std::int32_t, 3>> triangles;  ///< indices of points, counterclockwise
  std::vector<Pair> edges;                             ///< each once, first < second, ascending
};

/// Connects points whose geodesic Voronoi cells meet: an edge where two cells share a border, a triangle where three
/// cells meet. The cells are sampled at about 64 places per point, on a regular grid in each face, so that cells and
/// borders much smaller than the average may be missed. Costs one distance field over the mesh, and then a microsecond
/// for each place.
Triangulation triangulate(const surface::GeodesicSolver& solver, const std::vector<surface::SurfacePoint>& points,
                          const Execution& execution = {});

/// Triangles whose rest lengths are the distances of the points times `scale`: below 1 they are stretched at the start.
/// `corners` are indices of `points`. Costs one geodesic search for each side, in parallel. Throws "network.triangle"
/// for unknown points.
std::vector<MembraneTriangle> membrane_at_rest(const surface::GeodesicSolver& solver,
                                               const std::vector<surface::SurfacePoint>& points,
                                               const std::vector<std::array<std::int32_t, 3>>& corners,
                                               double scale = 1, const Execution& execution = {});

}  // namespace supple::embedded
