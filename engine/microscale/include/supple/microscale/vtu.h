#pragma once

#include <string>

#include "supple/microscale/simulation.h"
#include "supple/microscale/unwrapped_mesh.h"

namespace supple::microscale {

/// Writes a deformed patch as a VTK unstructured grid (VTU, ASCII). It has quadratic triangles (cell type 22) at their
/// rest positions in mm, the point data "displacement" (mm, including the macroscopic part) and the cell data
/// "energy_density" (MPa, the triangle's elastic energy per rest area from its three integration points).
///
/// `unwrapped` is unwrap(*deformed.mesh). Numbers are read back as the same doubles. A point takes about 250 bytes.
std::string write_vtu(const UnwrappedMesh& unwrapped, const DeformedMesh& deformed, const Material& material);

/// Writes a deformed part likewise. `displacements` are those of the mesh's nodes, mm. The cell data "largest_strain"
/// is that of `triangle_strains`.
std::string write_part_vtu(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2Xd& displacements,
                           const Material& material);

}  // namespace supple::microscale
