#include "network_case.h"

namespace supple::embedded {
namespace {

// Hard: a path between points next to a vertex can rotate by any angle when they move by 1e-6 edges, and the first
// steps are 1e5 times longer than the springs.
TEST(HardNetworks, StartsNextToVertices) {
  for (const auto& mesh : {testing::torus(24, 12), testing::genus3(2), testing::trefoil_knot(60, 8)}) {
    NetworkCase hard(mesh);
    hard.fill({0.99, 1e-6, 1 - 0.99 - 1e-6});
    hard.solve();
  }
}

// Hard: half of the springs cross an edge that is very close to both of their ends.
TEST(HardNetworks, StartsNextToEdges) {
  for (const auto& mesh : {testing::torus(24, 12), testing::genus3(2)}) {
    NetworkCase hard(mesh);
    hard.fill({0.5, 0.5 - 1e-6, 1e-6});
    hard.solve();
  }
}

// Hard: several points are exactly at each vertex, where energies have no derivative and springs no direction.
TEST(HardNetworks, StartsExactlyOnVertices) {
  for (const auto& mesh : {testing::torus(16, 8), testing::genus3(2), testing::saddle(6)}) {
    NetworkCase hard(mesh);
    hard.fill({1, 0, 0});
    const Relaxation relaxed = hard.solve();
    EXPECT_GT(relaxed.iterations, 0);
  }
}

// Hard: points are exactly on edges, given in either face.
TEST(HardNetworks, StartsExactlyOnEdges) {
  NetworkCase hard(testing::genus3(2));
  hard.fill({0.5, 0.5, 0});
  hard.solve();
}

// Hard: all points are at one place, and the directions in which they separate are not determined.
TEST(HardNetworks, StartsWithAllPointsInOnePlace) {
  NetworkCase hard(testing::icosphere(2));
  hard.network.points.assign(6, hard.near(0.3, 0.5, 0.8));
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < i; ++j) hard.network.springs.push_back({i, j, (i + j) % 2 == 0 ? 0.0 : 0.4, 1});
  hard.network.fixed_points = {0};
  const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
  EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_LT(relaxed.energy, 0.5 * relaxed.history.front().energy);
}

// Hard: the first step crosses more faces than a strip can have, goes around the torus and passes cut loci.
TEST(HardNetworks, PointsThatCrossManyFacesInOneStep) {
  NetworkCase hard(testing::torus(96, 48));
  const testing::SurfaceSampler sampler(*hard.mesh);
  RandomStream random("far", 1);
  for (int i = 0; i < 30; ++i) hard.network.points.push_back(sampler.point(random));
  for (int i = 0; i < 30; ++i)
    for (int k = 1; k <= 3; ++k) hard.network.springs.push_back({i, (i + k * k) % 30, 0, 1});
  hard.network.fixed_points = {0, 10, 20};
  hard.solve();
}

// Hard: springs' ends are at each other's cut loci, where two shortest paths have forces in different directions.
TEST(HardNetworks, StartsAtCutLoci) {
  NetworkCase hard(testing::icosphere(3));
  hard.network.points = {hard.near(0, 0, 1), hard.near(0, 0, -1), hard.near(1, 0, 0), hard.near(-1, 0, 0)};
  hard.network.springs = {{0, 1, 0, 1}, {2, 3, 0, 1}, {0, 2, 0, 0.5}};
  hard.network.fixed_points = {0, 3};
  hard.solve();
}

}  // namespace
}  // namespace supple::embedded
