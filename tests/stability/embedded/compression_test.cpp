#include "network_case.h"

namespace supple::embedded {
namespace {

// The failure case of [Thesis]: a compressed spring lengthens its path until another path is as short.
// Hard: the energy has a valley there that no single path describes. The search must end with less energy and say why.
TEST(HardNetworks, SpringsUnderCompressionEndAtTheCutLocusAndSaySo) {
  for (const auto& mesh : {testing::icosphere(2), testing::torus(16, 8), testing::genus3(2)}) {
    NetworkCase hard(mesh);
    hard.network.points = {{FaceId{0}, {0.2, 0.3, 0.5}}, {FaceId{3}, {0.4, 0.3, 0.3}}};
    hard.network.springs = {{0, 1, 3 * mesh.diagonal(), 1}};
    hard.network.fixed_points = {0};
    const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
    EXPECT_LT(relaxed.energy, relaxed.history.front().energy);
    EXPECT_TRUE(relaxed.springs[0].compressed);
    EXPECT_NE(relaxed.stopped, RelaxationTermination::iteration_limit);
    ASSERT_FALSE(relaxed.warnings.empty());
    EXPECT_NE(relaxed.warnings.front().find("shorter than at rest"), std::string::npos) << relaxed.warnings.front();
  }
}

// Hard: half of the springs are compressed. Hessians are indefinite and there are many equilibria; the surface has
// enough room for all rest lengths.
TEST(HardNetworks, PushingSpringsThatHaveRoom) {
  NetworkCase hard(testing::torus(24, 12));
  const auto points = poisson_disk_points(hard.solver, 0.5, 1);
  hard.network.points = points;
  for (const auto& [a, b] : triangulate(hard.solver, points).edges)
    hard.network.springs.push_back({a, b, (a + b) % 2 == 0 ? 0.65 : 0.5, 1});
  hard.options.max_iterations = 1000;
  const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
  EXPECT_LT(relaxed.energy, relaxed.history.front().energy);
  EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
  EXPECT_TRUE(std::ranges::any_of(relaxed.springs, &SpringState::compressed));
}

// Hard: a chain that is too long buckles sideways from an exactly straight start on a flat sheet.
TEST(HardNetworks, AStraightChainThatBuckles) {
  NetworkCase hard(testing::flat_grid(10, 10));
  for (int i = 0; i <= 6; ++i) hard.network.points.push_back(hard.near(2 + i, 5, 0));
  for (int i = 0; i < 6; ++i) hard.network.springs.push_back({i, i + 1, 1.2, 1});
  hard.network.fixed_points = {0, 6};
  const Relaxation relaxed = relax(hard.solver, hard.network, hard.options);
  // The straight chain is an unstable equilibrium. If the search ends there, a warning tells that springs are
  // compressed.
  if (relaxed.springs[0].compressed) {
    EXPECT_FALSE(relaxed.warnings.empty());
  } else {
    EXPECT_LT(relaxed.energy, 1e-12);
  }
  hard.network.points[3] = hard.near(5, 5.01, 0);
  const Relaxation buckled = relax(hard.solver, hard.network, hard.options);
  EXPECT_EQ(buckled.stopped, RelaxationTermination::converged);
  EXPECT_LT(buckled.energy, 1e-12);
  for (const SpringState& spring : buckled.springs) EXPECT_NEAR(spring.length, 1.2, 1e-6);
}

}  // namespace
}  // namespace supple::embedded
