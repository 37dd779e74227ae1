#pragma once

#include "supple/base/byte_codec.h"
#include "supple/meshing/planar_mesh.h"
#include "supple/tiling/part.h"

namespace supple::tiling {

// Parts as bytes for a helper process, and back: every number keeps its bits.

void write(ByteWriter& writer, const PartDesign& design);
void write(ByteWriter& writer, const Part& part);
void write(ByteWriter& writer, const std::vector<SolidFace>& faces);
void write(ByteWriter& writer, const meshing::PlanarMesh& mesh);

PartDesign read_part_design(ByteReader& reader);
Part read_part(ByteReader& reader);
std::vector<SolidFace> read_faces(ByteReader& reader);
meshing::PlanarMesh read_planar_mesh(ByteReader& reader);

}  // namespace supple::tiling
