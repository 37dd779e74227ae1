#pragma once

#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// The partner of each halfedge: the other halfedge of its edge, whatever the faces' orientations; -1 on the boundary.
/// Throws "mesh.non_manifold_edge" if an edge has more than two faces. O(n) plus sorting the edges of each vertex.
std::vector<std::int32_t> pair_halfedges(std::int32_t vertex_count, const std::vector<Triangle>& faces,
                                         const Execution& execution = {});
/// The same, but halfedges of edges with more than two faces have no partner. The number of these edges is added to
/// `non_manifold_edges`.
std::vector<std::int32_t> pair_manifold_halfedges(std::int32_t vertex_count, const std::vector<Triangle>& faces,
                                                  std::int64_t& non_manifold_edges, const Execution& execution = {});

struct Orientation {
  /// Component of each face; components are numbered in the order of their first faces.
  std::vector<std::int32_t> components;
  std::int32_t component_count = 0;
  std::int64_t turned_faces = 0;
};

/// Turns faces until neighbours agree, and renumbers `partners` accordingly. In each component the smaller group of
/// faces is turned; if both are equal, the faces that disagree with the first one. Throws "mesh.not_orientable". O(n).
Orientation orient_faces(std::vector<Triangle>& faces, std::vector<std::int32_t>& partners,
                         const Execution& execution = {});

/// An outgoing halfedge of each vertex, as TriangleMesh::outgoing describes it. Throws "mesh.non_manifold_vertex" if
/// the faces around a vertex form more than one fan. O(n).
std::vector<std::int32_t> find_fans(std::int32_t vertex_count, const std::vector<Triangle>& faces,
                                    const std::vector<std::int32_t>& twins, const Execution& execution = {});

}  // namespace supple::surface
