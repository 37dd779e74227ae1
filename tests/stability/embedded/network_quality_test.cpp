#include "network_case.h"
#include "supple/surface/vertex_cone.h"

namespace supple::embedded {
namespace {

// Hard: weights over twelve orders of magnitude make Hessians in which small entries are below the rounding of large
// ones.
TEST(HardNetworks, WeightsOfTwelveOrdersOfMagnitude) {
  NetworkCase hard(testing::torus(16, 8));
  hard.fill({0.3, 0.3, 0.4});
  for (std::size_t i = 0; i < hard.network.springs.size(); ++i)
    hard.network.springs[i].weight = std::pow(10.0, -6.0 + static_cast<double>(i % 13));
  hard.network.fixed_points = {0, 40, 80};
  const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
  EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_LT(relaxed.energy, relaxed.history.front().energy);
}

// Hard: no part of the method may depend on the unit of length.
TEST(HardNetworks, MeshesOfAnySize) {
  std::vector<int> iterations;
  for (const double size : {1e-6, 1.0, 1e6}) {
    const auto unit = testing::torus(16, 8);
    auto positions = unit.positions();
    for (auto& x : positions) x *= size;
    NetworkCase hard(surface::TriangleMesh::build(positions, unit.faces()));
    hard.fill({0.3, 0.3, 0.4});
    iterations.push_back(hard.solve().iterations);
  }
  EXPECT_EQ(iterations[0], iterations[1]);
  EXPECT_EQ(iterations[2], iterations[1]);
}

// Hard: faces a thousand times as long as wide, and needles next to large faces.
TEST(HardNetworks, SliversAndNeedles) {
  for (const auto& mesh : {testing::needle_cylinder(), testing::sliver_sphere()}) {
    NetworkCase hard(mesh);
    hard.fill({0.3, 0.3, 0.4});
    hard.options.max_iterations = 500;
    hard.solve();
  }
}

// Hard: points are pushed against a boundary, and paths bend around its corners.
TEST(HardNetworks, BoundariesThatHold) {
  for (const auto& mesh : {testing::l_shape(5), testing::slit_annulus(), testing::open_hemisphere()}) {
    NetworkCase hard(mesh);
    const testing::SurfaceSampler sampler(mesh);
    RandomStream random("boundary", 1);
    for (int i = 0; i < 24; ++i) hard.network.points.push_back(sampler.point(random));
    for (int i = 0; i < 24; ++i) {
      hard.network.springs.push_back({i, (i + 1) % 24, 0, 1});
      hard.network.springs.push_back({i, (i + 7) % 24, 0, 1});
    }
    hard.network.fixed_points = {0, 5, 11, 17};
    hard.solve();
  }
}

// Hard: every inner vertex is a saddle, at which paths bend and points can be in equilibrium.
TEST(HardNetworks, ASurfaceOfSaddlesOnly) {
  NetworkCase hard(testing::saddle(12));
  hard.fill({0.6, 0.2, 0.2});
  // The points at the sides are fixed, or the network would shrink to a point.
  for (std::size_t i = 0; i < hard.network.points.size(); ++i) {
    const Eigen::Vector3d at = surface::position(*hard.mesh, hard.network.points[i]);
    if (std::max(std::abs(at.x()), std::abs(at.y())) > 0.85)
      hard.network.fixed_points.push_back(static_cast<std::int32_t>(i));
  }
  hard.solve();
}

// Hard: the energy has its minimum exactly at a vertex, where it is not differentiable.
TEST(HardNetworks, RestsAtASaddleVertex) {
  for (const double angle : {2.02, 2.2, 2.6}) {
    NetworkCase hard(testing::cone(12, angle * std::numbers::pi, 3));
    const surface::VertexCone cone(*hard.mesh, 0);
    for (int k = 0; k < 3; ++k) {
      const auto direction = cone.direction((k + 0.1) / 3 * cone.total_angle());
      hard.network.points.push_back(
          surface::exponential_map(*hard.mesh, direction.vertex, 0.7 * direction.vector, {}).end);
      hard.network.springs.push_back({k, 3, 0, 1});
    }
    hard.network.fixed_points = {0, 1, 2};
    const auto aside = cone.direction(0.5);
    hard.network.points.push_back(surface::exponential_map(*hard.mesh, aside.vertex, 0.2 * aside.vector, {}).end);
    const Relaxation relaxed = hard.solve();
    EXPECT_EQ(relaxed.at_vertices, std::vector<std::int32_t>{3}) << "angle " << angle << " pi";
  }
}

// Hard: no shortest path passes a vertex of small total angle, and the point in the middle must choose a side.
TEST(HardNetworks, SpringsThatPassASharpTip) {
  NetworkCase hard(testing::cone(12, 0.9 * std::numbers::pi, 3));
  const surface::VertexCone cone(*hard.mesh, 0);
  for (int k = 0; k < 2; ++k) {
    const auto direction = cone.direction((k + 0.1) / 2 * cone.total_angle());
    hard.network.points.push_back(
        surface::exponential_map(*hard.mesh, direction.vertex, 0.7 * direction.vector, {}).end);
    hard.network.springs.push_back({k, 2, 0, 1});
  }
  hard.network.fixed_points = {0, 1};
  hard.network.points.push_back(surface::vertex_point(*hard.mesh, VertexId{0}));
  const Relaxation relaxed = hard.solve();
  EXPECT_TRUE(relaxed.at_vertices.empty());
}

// Hard: a part of the network without fixed points can slide over the surface without any force.
TEST(HardNetworks, PartsThatNothingHolds) {
  NetworkCase hard(testing::two_components());
  const testing::SurfaceSampler sampler(*hard.mesh);
  RandomStream random("parts", 2);
  while (hard.network.points.size() < 12) {
    const auto point = sampler.point(random);
    const bool second = hard.mesh->component(index(point.face)) != 0;
    if (second == (hard.network.points.size() >= 6)) hard.network.points.push_back(point);
  }
  for (int part = 0; part < 2; ++part)
    for (int i = 0; i < 5; ++i) hard.network.springs.push_back({6 * part + i, 6 * part + i + 1, 0.2, 1});
  hard.network.points.push_back(sampler.point(random));
  const Relaxation relaxed = hard.solve();
  EXPECT_EQ(relaxed.loose_points, std::vector<std::int32_t>{12});
  EXPECT_LT(relaxed.energy, 1e-15);
}

// Hard: there are no unknowns, or no springs.
TEST(HardNetworks, NothingToDo) {
  NetworkCase hard(testing::icosphere(1));
  hard.network.points = {hard.near(0, 0, 1), hard.near(1, 0, 0)};
  hard.solve();
  hard.network.springs = {{0, 1, 0, 1}};
  hard.network.fixed_points = {1, 0, 1};
  EXPECT_EQ(hard.solve().iterations, 0);
}

}  // namespace
}  // namespace supple::embedded
