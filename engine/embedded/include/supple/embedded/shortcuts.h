#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/embedded/network.h"
#include "supple/embedded/relaxation.h"
#include "supple/surface/triangle_mesh.h"

// Functions for programs that have matrices, and one network on one mesh.
namespace supple::embedded {

/// A network of equal springs. Row i of `springs`, k x 2, has the indices of the points that spring i joins. The rest
/// length is in mesh units, the weight in energy per squared mesh unit. Throws std::invalid_argument if the matrix does
/// not have two columns. `relax` checks everything else.
Network spring_network(std::vector<surface::SurfacePoint> points, const Eigen::Ref<const Eigen::MatrixXi>& springs,
                       double rest_length, std::vector<std::int32_t> fixed_points = {}, double weight = 1);

/// Relaxes one network on one mesh, as the function of this name that takes a solver, with a solver of its own.
Relaxation relax(const surface::TriangleMesh& mesh, const Network& network, const RelaxationOptions& options = {},
                 const Execution& execution = {});

/// The positions of the relaxed points in space, one row each. They lie on the surface as it is at the end. `mesh` is
/// the surface at the start.
Eigen::MatrixXd positions(const surface::TriangleMesh& mesh, const Relaxation& relaxation);
/// The positions of the surface's vertices at the end, one row each: those of `mesh` on a rigid host.
Eigen::MatrixXd host_vertices(const surface::TriangleMesh& mesh, const Relaxation& relaxation);

}  // namespace supple::embedded
