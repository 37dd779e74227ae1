#pragma once

#include <string>

#include "supple/base/random.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::testing {

/// Precision with which the coordinates of a part were written into its file.
enum class Digits { all, single_precision, six };

/// A part as a CAD program exports it, and a description of its construction.
struct CadPart {
  surface::TriangleMesh mesh;
  std::string description;
  Digits digits = Digits::all;
};

/// A random machined part or piece of bent sheet: an extruded outline with fillets and chamfers, through holes, pockets
/// and bosses. It is closed, lacks a cap, or has only some of its walls. It has about 20 to 400 vertices.
///
/// Such meshes are difficult for exact geodesics because almost everything is straight, but only up to rounding. Rims
/// have vertices within their straight edges, planar regions consist of fans and slivers, and edges are split where
/// another face had a vertex on them. Then the part is rotated in space, and its coordinates are rounded to single
/// precision or six digits, or some of its vertices are moved by 1e-6 to 1e-12 of its size, so that angles that were pi
/// or 2 pi are not exactly so any more. Every vertex belongs to a face.
CadPart cad_part(RandomStream& stream);

}  // namespace supple::testing
