/// Lays a chain of springs without rest length over a surface, lets it come to rest, and prints its length. At rest the
/// chain lies along a geodesic: the last line has the distance between its ends.
///
///     relax_network MESH VERTEX VERTEX        the vertices at which the chain is fixed
#include <cstdlib>
#include <exception>
#include <iostream>

#include "supple/embedded/shortcuts.h"
#include "supple/surface/mesh_io.h"
#include "supple/surface/shortcuts.h"

namespace {

void print_chain(const char* path, int first, int last) {
  using namespace supple;
  const surface::TriangleMesh mesh = surface::load_mesh_file(path);
  // The points begin on the surface below the straight segment between the two vertices, one row of a matrix each.
  constexpr int springs = 10;
  Eigen::MatrixXd segment(springs + 1, 3);
  for (int i = 0; i < 3; ++i)
    segment.col(i).setLinSpaced(surface::vertices_of(mesh)(first, i), surface::vertices_of(mesh)(last, i));
  Eigen::MatrixXi pairs(springs, 2);
  for (int i = 0; i < springs; ++i) pairs.row(i) << i, i + 1;

  const embedded::Network chain =
      embedded::spring_network(surface::nearest_points(mesh, segment), pairs, 0, {0, springs});
  const embedded::Relaxation rest = embedded::relax(mesh, chain);
  double length = 0;
  for (const embedded::SpringState& spring : rest.springs) length += spring.length;
  std::cout << rest.iterations << " iterations, " << to_string(rest.stopped) << "; the points are at rest at\n"
            << embedded::positions(mesh, rest) << "\nlength of the chain " << length << ", distance of its ends "
            << surface::geodesic_distance(mesh, rest.points.front(), rest.points.back()) << '\n';
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 4) {
    std::cerr << "usage: relax_network MESH VERTEX VERTEX\n";
    return 2;
  }
  print_chain(arguments[1], std::atoi(arguments[2]), std::atoi(arguments[3]));
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
