/// Prints the Karcher mean of vertices of a surface: the point of least mean squared geodesic distance from them.
///
///     karcher_mean MESH VERTEX...
#include <cstdlib>
#include <exception>
#include <iostream>
#include <vector>

#include "supple/surface/mesh_io.h"
#include "supple/surface/shortcuts.h"

int main(int count, char** arguments) try {
  if (count < 3) {
    std::cerr << "usage: karcher_mean MESH VERTEX...\n";
    return 2;
  }
  namespace surface = supple::surface;
  const surface::TriangleMesh mesh = surface::load_mesh_file(arguments[1]);
  std::vector<int> vertices;
  for (int i = 2; i < count; ++i) vertices.push_back(std::atoi(arguments[i]));

  surface::KarcherProblem problem;
  problem.points = surface::vertex_points(mesh, vertices);
  const surface::KarcherMean mean = surface::karcher_mean(mesh, problem);
  std::cout << "the mean lies at " << mean.position.transpose() << ", in face " << index(mean.mean.face) << '\n'
            << "half the mean squared distance is " << mean.objective << '\n'
            << mean.iterations << " iterations, " << to_string(mean.stopped) << '\n';
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
