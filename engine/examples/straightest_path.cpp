/// Walks straight ahead on a surface, and prints where the walk ends and how long the shortest way back is.
///
///     straightest_path MESH LENGTH        in mesh units
///
/// The walk begins at the centroid of face 0, along the first side of this face.
#include <cstdlib>
#include <exception>
#include <iostream>

#include "supple/surface/exponential_map.h"
#include "supple/surface/mesh_io.h"
#include "supple/surface/shortcuts.h"

int main(int count, char** arguments) try {
  if (count != 3) {
    std::cerr << "usage: straightest_path MESH LENGTH\n";
    return 2;
  }
  namespace surface = supple::surface;
  const surface::TriangleMesh mesh = surface::load_mesh_file(arguments[1]);
  const surface::SurfacePoint start{supple::FaceId{0}, Eigen::Vector3d::Constant(1.0 / 3)};
  const Eigen::Vector3d tangent = std::atof(arguments[2]) * surface::tangent_frame(mesh, start.face).col(0);

  // The token of another thread could stop the walk; nobody has this one.
  const surface::ExponentialMap walk = surface::exponential_map(mesh, start, tangent, supple::CancellationToken{});
  std::cout << "after " << walk.length << " mesh units and " << walk.trace.size() << " points the walk ends at "
            << surface::position(mesh, walk.end).transpose() << (walk.reached_boundary ? ", on the boundary" : "")
            << "\nthe shortest way back is " << surface::geodesic_distance(mesh, walk.end, start) << " mesh units\n";
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
