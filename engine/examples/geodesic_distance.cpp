/// Prints the exact geodesic distance between two points of a surface, its gradient and the path.
///
///     geodesic_distance MESH      an OBJ, OFF, PLY or STL file
///
/// The first point is vertex 0. The second one is the centroid of a face in the middle of the list of faces.
#include <exception>
#include <iostream>
#include <memory>

#include "supple/surface/geodesic_solver.h"
#include "supple/surface/mesh_io.h"

namespace {

void print_distance(const char* path) {
  using namespace supple;
  const auto mesh = std::make_shared<const surface::TriangleMesh>(surface::load_mesh_file(path));
  // The solver stores everything that depends on the mesh alone. It may be used by several threads at once.
  const surface::GeodesicSolver solver(mesh);

  const surface::SurfacePoint from = surface::vertex_point(*mesh, VertexId{0});
  const surface::SurfacePoint to{FaceId{mesh->face_count() / 2}, Eigen::Vector3d::Constant(1.0 / 3)};
  const surface::Geodesic geodesic = solver.geodesic(from, to, {.derivatives = 1, .path = true});
  if (geodesic.unreachable) {
    std::cout << "no path joins the two points\n";
    return;
  }

  // The gradient at the second end is a vector in the tangent frame of its face. It has length 1 and points away from
  // the first end.
  const Eigen::Vector3d gradient =
      surface::tangent_frame(*mesh, to.face) * geodesic.derivatives->tangent_gradient.tail<2>();
  std::cout << "distance " << geodesic.distance << " mesh units\n"
            << "gradient at the second end " << gradient.transpose() << ", length " << gradient.norm() << '\n'
            << "the path has " << geodesic.path.size() << " points\n";
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 2) {
    std::cerr << "usage: geodesic_distance MESH\n";
    return 2;
  }
  print_distance(arguments[1]);
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
