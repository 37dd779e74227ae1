#include "support/cgal_geodesics.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>

#include <limits>

namespace supple::testing {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Traits = CGAL::Surface_mesh_shortest_path_traits<Kernel, Mesh>;
using ShortestPath = CGAL::Surface_mesh_shortest_path<Traits>;

Mesh converted(const surface::TriangleMesh& mesh) {
  Mesh result;
  for (const auto& p : mesh.positions()) result.add_vertex(Kernel::Point_3(p.x(), p.y(), p.z()));
  for (const auto& [a, b, c] : mesh.faces()) {
    result.add_face(Mesh::Vertex_index(a), Mesh::Vertex_index(b), Mesh::Vertex_index(c));
  }
  return result;
}

constexpr double edge_offset = 1e-12;

double reached(double distance) { return distance < 0 ? std::numeric_limits<double>::infinity() : distance; }

}  // namespace

struct CgalGeodesics::Implementation {
  explicit Implementation(const surface::TriangleMesh& source_mesh)
      : faces(source_mesh.faces()), mesh(converted(source_mesh)) {}

  /// The point for CGAL, which counts a face's corners from the source of its halfedge, and not from the face's first
  /// vertex. Points on edges are moved into the face.
  ShortestPath::Face_location location(const surface::SurfacePoint& point) const {
    const Mesh::Face_index face(index(point.face));
    const auto first = mesh.halfedge(face);
    const std::array<Mesh::Vertex_index, 3> corners{mesh.source(first), mesh.target(first),
                                                    mesh.target(mesh.next(first))};
    Eigen::Vector3d inside = point.barycentric;
    if (const int side = side_of(point); side >= 0) {
      inside *= 1 - edge_offset;
      inside[(side + 2) % 3] = edge_offset;
    }
    std::array<double, 3> barycentric{};
    for (int i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) {
        if (Mesh::Vertex_index(faces[index(point.face)][k]) == corners[i]) barycentric[i] = inside[k];
      }
    }
    return {face, {barycentric[0], barycentric[1], barycentric[2]}};
  }

  std::vector<surface::Triangle> faces;
  Mesh mesh;
  std::unique_ptr<ShortestPath> search;
};

CgalGeodesics::CgalGeodesics(const surface::TriangleMesh& mesh)
    : implementation_(std::make_unique<Implementation>(mesh)) {}
CgalGeodesics::~CgalGeodesics() = default;

void CgalGeodesics::set_source(const surface::SurfacePoint& source) {
  Implementation& own = *implementation_;
  own.search = std::make_unique<ShortestPath>(own.mesh);
  own.search->add_source_point(own.location(source));
}

void CgalGeodesics::search() { implementation_->search->build_sequence_tree(); }

double CgalGeodesics::distance(const surface::SurfacePoint& point) const {
  const ShortestPath::Face_location location = implementation_->location(point);
  return reached(implementation_->search->shortest_distance_to_source_points(location.first, location.second).first);
}

std::vector<double> CgalGeodesics::vertex_distances() const {
  std::vector<double> result;
  for (const Mesh::Vertex_index v : implementation_->mesh.vertices()) {
    result.push_back(reached(implementation_->search->shortest_distance_to_source_points(v).first));
  }
  return result;
}

}  // namespace supple::testing
