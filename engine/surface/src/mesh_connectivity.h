#pragma once

#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// Which halfedges share an edge, whatever the faces' orientations: the partner of each halfedge, -1 on the boundary.
/// Throws "mesh.non_manifold_edge" where more than two faces meet. O(n) plus sorting the edges of each vertex.
std::vector<std::int32_t> pair_halfedges(std::int32_t vertex_count, const std::vector<Triangle>& faces,
                                         const Execution& execution = {});
/// The same without faults: halfedges where more than two faces meet have no partner, and the number of these edges is
/// added to `non_manifold_edges`.
std::vector<std::int32_t> pair_manifold_halfedges(std::int32_t vertex_count, const std::vector<Triangle>& faces,
                                                  std::int64_t& non_manifold_edges, const Execution& execution = {});

struct Orientation {
  std::vector<std::int32_t> components;  ///< of each face, numbered in the order of their first faces
  std::int32_t component_count = 0;
  std::int64_t turned_faces = 0;
};

/// Turns faces until neighbours agree, in each component the fewer (of equals, those that disagree with the component's
/// first face), and renumbers `partners` accordingly. Throws "mesh.not_orientable". O(n).
Orientation orient_faces(std::vector<Triangle>& faces, std::vector<std::int32_t>& partners,
                         const Execution& execution = {});

/// An outgoing halfedge of each vertex as TriangleMesh::outgoing promises. Throws "mesh.non_manifold_vertex" where the
/// faces around a vertex form more than one fan. O(n).
std::vector<std::int32_t> find_fans(std::int32_t vertex_count, const std::vector<Triangle>& faces,
                                    const std::vector<std::int32_t>& twins, const Execution& execution = {});

}  // namespace supple::surface
