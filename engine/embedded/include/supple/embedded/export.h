#pragma once

#include <string>
#include <vector>

#include "supple/embedded/network.h"
#include "supple/embedded/relaxation.h"

// Files of a relaxed network, in mesh units. Reading a number gives the same double that was written.
namespace supple::embedded {

/// A Wavefront OBJ file with a line element for each spring, in their order, and a flat face for each triangle of a
/// membrane. A line follows the spring's path if `relaxation` has the paths; otherwise it is the segment between its
/// ends. With a host that deformed or moved, the file has two objects, "network" and "host"; the second is the host's
/// surface. `network` is the one that was relaxed, `mesh` the surface at the end.
std::string write_obj(const surface::TriangleMesh& mesh, const Network& network, const Relaxation& relaxation);

/// The same content as a VTK unstructured grid (VTU, ASCII) of polylines (cell type 4) and triangles (5). Its cell data
/// are "energy", "length" and "rest_length" (mesh units), "weight", "compressed" and "at_cut_locus" (0 or 1); all but
/// "energy" are 0 for triangles. A network with triangles also has "greater_stretch" and "lesser_stretch", 0 for
/// springs. A host that deformed or moved follows as tetrahedra (10) of a solid or triangles of a surface, for which
/// the cell data "host" is 1.
std::string write_vtu(const surface::TriangleMesh& mesh, const Network& network, const Relaxation& relaxation);

/// An SVG diagram of a relaxation: energy above gradient norm, over the iterations, with logarithmic axes. A value that
/// is not positive and finite has no point in its curve.
std::string write_convergence_svg(const std::vector<RelaxationStep>& history);

}  // namespace supple::embedded
