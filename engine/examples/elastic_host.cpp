/// Tightens a net of springs around a closed surface that is a thin elastic shell and keeps its volume, and prints how
/// far the shell deforms.
///
///     elastic_host MESH RADIUS        the least distance of two knots of the net, in mesh units
#include <cstdlib>
#include <exception>
#include <iostream>

#include "supple/embedded/network_plan.h"
#include "supple/embedded/shortcuts.h"
#include "supple/surface/mesh_io.h"
#include "supple/surface/shortcuts.h"

namespace {

void print_shell(const char* path, double radius) {
  using namespace supple;
  const surface::TriangleMesh mesh = surface::load_mesh_file(path);
  const surface::GeodesicSolver solver = surface::solver_on(mesh);
  // Random knots, and springs between neighbours that pull until they are as short as the least distance.
  embedded::NetworkPlan plan;
  plan.points = embedded::PoissonDiskPoints{.radius = radius};
  plan.springs = embedded::NeighbourSprings{
      .kind = embedded::NeighbourSprings::Kind::voronoi_dual, .rest_length = radius, .weight = 10};
  const embedded::Network net = embedded::build_network(solver, plan, {}).network;

  embedded::RelaxationOptions options;
  options.host = embedded::ShellHost{.volume_weight = 1000};
  options.tolerance = 1e-6;
  const embedded::Relaxation rest = embedded::relax(solver, net, options);
  std::cout << net.points.size() << " knots and " << net.springs.size() << " springs, " << to_string(rest.stopped)
            << " after " << rest.iterations << " iterations\n"
            << "a vertex of the shell moved by " << rest.host.largest_displacement << " mesh units\n"
            << "the volume is " << rest.host.volume_ratio << " of that at rest\n";
  for (const embedded::HostState::Term& term : rest.host.terms)
    std::cout << "energy of " << term.name << ' ' << term.energy << '\n';
}

}  // namespace

int main(int count, char** arguments) try {
  if (count != 3) {
    std::cerr << "usage: elastic_host MESH RADIUS\n";
    return 2;
  }
  print_shell(arguments[1], std::atof(arguments[2]));
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
