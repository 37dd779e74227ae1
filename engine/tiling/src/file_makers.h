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

}  // namespace supple::tiling
