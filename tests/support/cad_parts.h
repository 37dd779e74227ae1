#pragma once

#include <string>

#include "supple/base/random.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::testing {

/// How the coordinates of a part were written into its file.
enum class Digits { all, single_precision, six };

/// A part as a CAD program exports it, and how it was made.
struct CadPart {
  surface::TriangleMesh mesh;
  std::string description;
  Digits digits = Digits::all;
};

/// A machined part or a piece of bent sheet, drawn from the stream: an extruded outline with fillets and chamfers,
/// through holes, pockets and bosses; closed, without a cap, or only some of its walls. About 20 to 400 vertices.
///
/// Such meshes are hard on exact geodesics because nearly everything is straight, but only up to rounding. Rims have
/// vertices within their straight edges, flat faces are cut into fans and slivers, and edges are split where another
/// face had a vertex on them. Then the part is turned in space, and its coordinates are rounded to single precision or
/// six digits, or some of its vertices are moved by 1e-6 to 1e-12 of its size, so that angles that were pi or 2 pi are
/// so no longer. Every vertex belongs to a face.
CadPart cad_part(RandomStream& stream);

}  // namespace supple::testing
