#pragma once

#include <string_view>

#include "supple/base/byte_codec.h"
#include "supple/tiling/export.h"
#include "supple/tiling/mesh.h"
#include "supple/tiling/structure.h"

namespace supple::tiling {

// Structures, options and meshes as bytes for a helper process, and back: every number keeps its bits.

void write(ByteWriter& writer, const Structure& structure);
void write(ByteWriter& writer, const ExportOptions& options);
void write(ByteWriter& writer, const MeshOptions& options);
void write(ByteWriter& writer, const PeriodicMesh& mesh);

Structure read_structure(ByteReader& reader);
ExportOptions read_export_options(ByteReader& reader);
MeshOptions read_mesh_options(ByteReader& reader);
PeriodicMesh read_mesh(ByteReader& reader);

}  // namespace supple::tiling
