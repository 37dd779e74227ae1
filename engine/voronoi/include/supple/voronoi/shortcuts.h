#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/triangle_mesh.h"
#include "supple/voronoi/diagram.h"
#include "supple/voronoi/optimization.h"

// Functions for programs that have matrices, and one diagram of one mesh.
namespace supple::voronoi {

/// Computes one diagram of one mesh, as the function of this name that takes a solver, with a solver of its own.
Diagram diagram(const surface::TriangleMesh& mesh, const std::vector<surface::SurfacePoint>& sites,
                const DiagramOptions& options = {}, const Execution& execution = {});
/// The same for a mesh that is given by matrices (see surface::mesh_of), with the sites at the points of the surface
/// that are nearest to the rows of `sites`.
Diagram diagram(const Eigen::Ref<const Eigen::MatrixXd>& vertices, const Eigen::Ref<const Eigen::MatrixXi>& faces,
                const Eigen::Ref<const Eigen::MatrixXd>& sites, const DiagramOptions& options = {});

/// Optimizes the sites of one mesh, as the function of this name that takes a solver, with a solver of its own.
Optimization optimize(const surface::TriangleMesh& mesh, std::vector<surface::SurfacePoint> sites,
                      const OptimizationOptions& options, const Execution& execution = {});

/// The areas of the cells, squared mesh units, in the order of the sites.
Eigen::VectorXd areas_of(const Diagram& diagram);
/// The closed curves that bound the cell of a site, DiagramCell::boundary, with one row for each point.
std::vector<Eigen::MatrixXd> boundary_of(const Diagram& diagram, std::size_t site);
/// Diagram::dual with one row for each triangle of sites.
Eigen::MatrixXi dual_faces_of(const Diagram& diagram);

}  // namespace supple::voronoi
