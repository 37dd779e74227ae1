#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"
#include "supple/surface/karcher_mean.h"
#include "supple/surface/matrices.h"

// Functions that answer one question about one mesh. Each of them makes a GeodesicSolver and drops it again, which
// costs O(faces). Programs with several questions about a mesh keep a solver and ask it.
namespace supple::surface {

/// A solver that refers to the mesh and does not own it. The mesh must outlive the solver and its fields.
GeodesicSolver solver_on(const TriangleMesh& mesh, const Execution& execution = {});

/// The length of the shortest path between two points of a surface, in mesh units, or infinity if no path joins them.
/// Throws what checked_point throws.
double geodesic_distance(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                         const Execution& execution = {});
/// The same between two vertices of a mesh that is given by matrices. Throws what mesh_of and vertex_point throws.
double geodesic_distance(const Eigen::Ref<const Eigen::MatrixXd>& vertices,
                         const Eigen::Ref<const Eigen::MatrixXi>& faces, int from, int to);

/// The shortest path between two points, with its positions. Throws what checked_point throws.
Geodesic shortest_path(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                       const GeodesicOptions& options = {.path = true}, const Execution& execution = {});

/// The exact distance of each vertex from the nearest of several sources, in mesh units; infinity where no path leads
/// to one. Throws what checked_point throws.
Eigen::VectorXd distances_from(const TriangleMesh& mesh, const std::vector<SurfacePoint>& sources,
                               const Execution& execution = {});
/// The same from vertices of a mesh that is given by matrices. Throws what mesh_of and vertex_point throw.
Eigen::VectorXd distances_from(const Eigen::Ref<const Eigen::MatrixXd>& vertices,
                               const Eigen::Ref<const Eigen::MatrixXi>& faces, const std::vector<int>& sources);

/// The point of least weighted mean squared distance from several points, as the function above that takes a solver.
KarcherMean karcher_mean(const TriangleMesh& mesh, const KarcherProblem& problem, const Execution& execution = {});
/// The same for vertices of equal weight of a mesh that is given by matrices.
KarcherMean karcher_mean(const Eigen::Ref<const Eigen::MatrixXd>& vertices,
                         const Eigen::Ref<const Eigen::MatrixXi>& faces, const std::vector<int>& points);

}  // namespace supple::surface
