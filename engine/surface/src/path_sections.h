#pragma once

#include <cstdint>
#include <vector>

#include "supple/surface/geodesic.h"
#include "supple/surface/triangle_mesh.h"

namespace supple::surface {

/// A straight section of a path, between ends of the path or vertices that bend it, with the edges that it crosses.
struct PathSection {
  struct Crossing {
    std::int32_t over;  ///< halfedge of the face before
    double t;           ///< barycentric coordinate of the head of `over`
  };
  std::size_t first, last;  ///< indices of its ends in the path
  std::int32_t entered;     ///< a halfedge of the first face
  std::vector<Crossing> crossings;

  std::int32_t face_before(const TriangleMesh& mesh, std::size_t crossing) const {
    return TriangleMesh::face_of(crossing == 0 ? entered : mesh.twin(crossings[crossing - 1].over));
  }
};

/// The straight sections of a path with at least two points, in order.
std::vector<PathSection> sections_of(const TriangleMesh& mesh, const std::vector<PathPoint>& path);

}  // namespace supple::surface
