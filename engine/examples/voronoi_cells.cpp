/// Divides a surface into the geodesic Voronoi cells of random sites, moves the sites to the centres of their cells,
/// and prints the areas of the cells before and after.
///
///     voronoi_cells MESH SITES
#include <cstdlib>
#include <exception>
#include <iostream>

#include "supple/surface/mesh_io.h"
#include "supple/voronoi/shortcuts.h"

namespace {

void print_cells(const char* path, int sites) {
  using namespace supple;
  const surface::TriangleMesh mesh = surface::load_mesh_file(path);
  const voronoi::Diagram diagram = voronoi::diagram(mesh, voronoi::random_sites(mesh, sites));
  const Eigen::VectorXd areas = voronoi::areas_of(diagram);
  std::cout << "the cells have areas of " << areas.minCoeff() << " to " << areas.maxCoeff() << ", in all "
            << areas.sum() << " squared mesh units\n"
            << "the border of cell 0 has " << voronoi::boundary_of(diagram, 0).front().rows() << " points\n";

  voronoi::OptimizationOptions options;
  options.weights.centroidal = 1;
  options.tolerance = 1e-4;
  const voronoi::Optimization centroidal = voronoi::optimize(mesh, diagram.sites, options);
  const Eigen::VectorXd even = voronoi::areas_of(centroidal.diagram);
  std::cout << "around their centres " << even.minCoeff() << " to " << even.maxCoeff() << ", "
            << to_string(centroidal.stopped) << " after " << centroidal.iterations << " iterations\n";
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 3) {
    std::cerr << "usage: voronoi_cells MESH SITES\n";
    return 2;
  }
  print_cells(arguments[1], std::atoi(arguments[2]));
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
