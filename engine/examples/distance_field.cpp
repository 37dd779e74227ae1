/// Computes the distance of each vertex from vertex 0, and prints which one is farthest and how far it is.
///
///     distance_field MESH
#include <exception>
#include <iostream>

#include "supple/surface/mesh_io.h"
#include "supple/surface/shortcuts.h"

int main(int count, char** arguments) try {
  if (count != 2) {
    std::cerr << "usage: distance_field MESH\n";
    return 2;
  }
  namespace surface = supple::surface;
  // Matrices with one row for each vertex and face, as other libraries of geometry have them.
  const surface::TriangleMesh mesh = surface::load_mesh_file(arguments[1]);
  const Eigen::MatrixXd vertices = surface::vertices_of(mesh);
  const Eigen::MatrixXi faces = surface::faces_of(mesh);

  const Eigen::VectorXd distances = surface::distances_from(vertices, faces, {0});
  Eigen::Index farthest = 0;
  const double distance = distances.maxCoeff(&farthest);
  std::cout << "vertex " << farthest << " is farthest, at a distance of " << distance << " mesh units\n"
            << "it lies at " << vertices.row(farthest) << '\n';
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
