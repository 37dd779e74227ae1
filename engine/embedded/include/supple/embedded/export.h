#pragma once

#include <string>
#include <vector>

#include "supple/embedded/network.h"
#include "supple/embedded/relaxation.h"

// A relaxed network as files, in mesh units. Numbers read back as the same doubles.
namespace supple::embedded {

/// A Wavefront OBJ file with a line element for each spring, in their order: along its path where `relaxation` has the
/// paths, otherwise the segment between its ends; then a face for each triangle of a membrane, with its corners on the
/// surface and flat between them. Of a host that gave way, the objects "network" and "host": the second is its surface.
/// `network` is the one that was relaxed, `mesh` the surface as it is at the end.
std::string write_obj(const surface::TriangleMesh& mesh, const Network& network, const Relaxation& relaxation);

/// The same as a VTK unstructured grid (VTU, ASCII) of polylines (cell type 4) and triangles (5) with the cell data
/// "energy", "length" and "rest_length" (mesh units), "weight", "compressed" and "at_cut_locus" (0 or 1), all but the
/// first 0 for triangles, and where there are any "greater_stretch" and "lesser_stretch" (0 for springs). A host that
/// gave way follows, tetrahedra (10) of a solid and triangles of a shell, and the cell data "host" is 1 there.
std::string write_vtu(const surface::TriangleMesh& mesh, const Network& network, const Relaxation& relaxation);

/// An SVG diagram of a relaxation: energy and gradient norm over the iterations, one above the other, each on a
/// logarithmic axis. States where a value is zero have no point in its curve.
std::string write_convergence_svg(const std::vector<RelaxationStep>& history);

}  // namespace supple::embedded
