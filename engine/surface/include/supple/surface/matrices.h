#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/geodesic.h"
#include "supple/surface/surface_point.h"
#include "supple/surface/triangle_mesh.h"

// Meshes and points as matrices: one row for each vertex, face or point. Positions are in mesh units, and indices begin
// with 0.
namespace supple::surface {

/// Builds a mesh from n x 3 positions and m x 3 indices of vertices. Throws std::invalid_argument if a matrix does not
/// have three columns, and what TriangleMesh::build throws.
TriangleMesh mesh_of(const Eigen::Ref<const Eigen::MatrixXd>& vertices, const Eigen::Ref<const Eigen::MatrixXi>& faces,
                     const Execution& execution = {});

/// The positions of the vertices, n x 3.
Eigen::MatrixXd vertices_of(const TriangleMesh& mesh);
/// The vertices of the faces, m x 3.
Eigen::MatrixXi faces_of(const TriangleMesh& mesh);

/// The positions of points on the surface.
Eigen::MatrixXd positions(const TriangleMesh& mesh, const std::vector<SurfacePoint>& points);
/// The positions along a path.
Eigen::MatrixXd positions(const std::vector<PathPoint>& path);

/// The vertices as points of the surface. Throws what vertex_point throws.
std::vector<SurfacePoint> vertex_points(const TriangleMesh& mesh, const std::vector<int>& vertices);
/// The points of the surface that are nearest to positions in space, n x 3. They are found by NearestPointSearch.
/// Throws std::invalid_argument if the matrix does not have three columns or has a number that is not finite.
std::vector<SurfacePoint> nearest_points(const TriangleMesh& mesh, const Eigen::Ref<const Eigen::MatrixXd>& positions,
                                         const Execution& execution = {});

}  // namespace supple::surface
