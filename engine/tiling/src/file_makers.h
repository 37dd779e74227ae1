#pragma once

#include <string>

#include "supple/tiling/export.h"
#include "supple/tiling/mesh.h"

namespace supple::tiling {

// These functions make files and meshes in this process, even if there are helper processes.

std::string make_svg(const Structure& structure, const ExportOptions& options);
std::string make_dxf(const Structure& structure, const ExportOptions& options);
std::string make_stl(const Structure& structure, const ExportOptions& options);
PeriodicMesh make_mesh(const Structure& structure, const MeshOptions& options);

/// Throws "tiling.mesh_option", which names an option out of range.
void check_mesh_options(const MeshOptions& options);
/// Throws "tiling.mesh_too_large" if there are more nodes than the options allow. `kind` says how the number is known:
/// "has", "would have about".
void check_number_of_nodes(double nodes, const MeshOptions& options, const char* kind);

}  // namespace supple::tiling
