#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/tiling/mesh.h"

namespace supple::microscale {

/// For each triangle the largest |principal stretch - 1| at its three integration points, dimensionless.
/// `displacements` are those of the mesh's nodes, mm, without a macroscopic part. O(n) for n triangles.
std::vector<double> triangle_strains(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2Xd& displacements);

/// The largest of these.
double largest_strain(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2Xd& displacements);

}  // namespace supple::microscale
