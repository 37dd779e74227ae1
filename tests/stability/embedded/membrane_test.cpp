#include "network_case.h"

namespace supple::embedded {
namespace {

// Hard: every side of a stretched closed membrane has kinks at the vertices that it passes.
TEST(HardMembranes, StretchedAllOverClosedSurfaces) {
  for (const auto& mesh : {testing::icosphere(2), testing::torus(24, 12), testing::bumpy_cube(12)}) {
    NetworkCase hard(mesh);
    hard.cover(0.15 * mesh.diagonal(), 0.8);
    hard.network.fixed_points = {0};
    hard.options.max_iterations = 1000;
    const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
    for (const TriangleState& triangle : relaxed.triangles) EXPECT_GT(triangle.stretches[1], 0);
    // Where the membrane is stretched in one direction, sides across it are compressed. If such a side is in
    // equilibrium at its cut locus, the answer says so.
    hard.check(relaxed);
    if (std::ranges::any_of(relaxed.triangles, &TriangleState::at_cut_locus)) {
      EXPECT_NE(relaxed.warnings.back().find("side that pushes"), std::string::npos);
    }
  }
}

// Hard: triangles that are as flat as rounding permits, next to others. The energy is a barrier against their collapse.
TEST(HardMembranes, ATriangleThatHasAlmostNoAreaAtTheStart) {
  NetworkCase hard(testing::flat_grid(8, 8));
  hard.network.points = {hard.near(2, 2, 0), hard.near(6, 2, 0), hard.near(4, 6, 0), hard.near(4, 3, 0)};
  hard.network.triangles = membrane_at_rest(hard.solver, hard.network.points, {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}});
  hard.network.fixed_points = {0, 1, 2};
  for (const double height : {1e-2, 1e-4, 1e-6}) {
    hard.network.points[3] = hard.near(4, 2 + height, 0);
    const Relaxation relaxed = hard.solve();
    EXPECT_LT((surface::position(*hard.mesh, relaxed.points[3]) - Eigen::Vector3d(4, 3, 0)).norm(), 1e-6) << height;
  }
}

// Hard: the membrane is too large for the closed surface, so that shortest paths are driven to a dozen cut loci at
// once. It must reach an equilibrium there, with every triangle intact.
TEST(HardMembranes, CompressedWhereThereIsNoRoom) {
  for (const auto& mesh : {testing::icosphere(2), testing::torus(16, 8)}) {
    NetworkCase hard(mesh);
    hard.cover(0.2 * mesh.diagonal(), 1.3);
    const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
    EXPECT_LE(relaxed.energy, relaxed.history.front().energy);
    EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
    hard.check(relaxed);
    EXPECT_GT(std::ranges::count_if(relaxed.triangles, &TriangleState::at_cut_locus), 5);
    for (const TriangleState& triangle : relaxed.triangles) EXPECT_GT(triangle.stretches[1], 0);
  }
}

// Hard: a compressed sheet in the plane can grow to its size at rest, and may rotate freely while it does.
TEST(HardMembranes, CompressedWhereThereIsRoom) {
  NetworkCase hard(testing::flat_grid(20, 20));
  std::vector<std::array<std::int32_t, 3>> corners;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i) {
      hard.network.points.push_back(hard.near(8.53 + i, 8.48 + j, 0));
      if (i == 3 || j == 3) continue;
      const int a = 4 * j + i;
      corners.push_back({a, a + 1, a + 5});
      corners.push_back({a, a + 5, a + 4});
    }
  hard.network.triangles = membrane_at_rest(hard.solver, hard.network.points, corners, 1.7);
  const Relaxation relaxed = hard.solve();
  EXPECT_LT(relaxed.energy, 1e-12);
  for (const TriangleState& triangle : relaxed.triangles) EXPECT_NEAR(triangle.stretches[0], 1, 1e-6);
}

// Hard: with a Poisson's ratio close to 1/2 the membrane preserves its area and stretches unevenly.
TEST(HardMembranes, NearlyIncompressible) {
  NetworkCase hard(testing::torus(24, 12));
  hard.cover(0.4, 0.97);
  hard.network.material.poisson_ratio = 0.4999;
  hard.network.fixed_points = {0};
  hard.options.max_iterations = 1000;
  const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
  EXPECT_LT(relaxed.energy, relaxed.history.front().energy);
  EXPECT_NE(relaxed.stopped, RelaxationTermination::iteration_limit);
}

// Hard: a mesh of needles, of whose faces each side crosses dozens.
TEST(HardMembranes, OnNeedles) {
  NetworkCase hard(testing::sliver_sphere());
  hard.cover(0.2 * hard.mesh->diagonal(), 0.9);
  hard.network.fixed_points = {0};
  hard.solve();
}

}  // namespace
}  // namespace supple::embedded
