// Degenerate choices of points and weights.
#include "karcher_case.h"
#include "support/expect_error.h"

namespace supple::surface {
namespace {

SurfacePoint random_point(const KarcherCase& c, std::uint64_t seed) {
  RandomStream random("karcher_points", seed);
  return testing::random_point(*c.mesh, random);
}

// Hard: at the only point the distance has no derivative.
TEST(KarcherPoints, OnePointIsItsOwnMeanFromAnyStart) {
  KarcherCase c(testing::icosphere(2));
  c.problem.points = {random_point(c, 1)};
  const Eigen::Vector3d expected = position(*c.mesh, c.problem.points[0]);
  EXPECT_LT((c.solve().position - expected).norm(), 1e-12);
  for (int seed = 2; seed < 8; ++seed) {
    c.problem.start = random_point(c, seed);
    EXPECT_LT((c.solve().position - expected).norm(), 1e-9);
  }
}

// Hard: every distance is zero at the mean.
TEST(KarcherPoints, CoincidentPointsAreTheirMean) {
  KarcherCase c(testing::torus());
  c.problem.points.assign(7, random_point(c, 1));
  c.problem.start = random_point(c, 2);
  const KarcherMean mean = c.solve();
  EXPECT_LT((mean.position - position(*c.mesh, c.problem.points[0])).norm(), 1e-9);
  EXPECT_LT(mean.objective, 1e-17);
}

// Hard: distances of 1e-9 next to an edge, whose relative accuracy decides.
TEST(KarcherPoints, AClusterOfAlmostCoincidentPointsHasItsMeanWithinTheCluster) {
  KarcherCase c(testing::icosphere(2));
  for (int k = 0; k < 5; ++k) {
    const double offset = 1e-9 * (k + 1);
    c.problem.points.push_back({FaceId{17}, Eigen::Vector3d(0.5 - offset, 0.5 - offset, 2 * offset)});
  }
  const KarcherMean mean = c.solve();
  EXPECT_LT((mean.position - position(*c.mesh, c.problem.points[2])).norm(), 5e-9);
}

// Hard: two points, whose objective is flat across the geodesic where it is long.
TEST(KarcherPoints, TwoPointsMeetHalfwayOnEveryShape) {
  for (int shape = 0; shape < 4; ++shape) {
    SCOPED_TRACE(::testing::Message() << "shape " << shape);
    KarcherCase c(shape == 0   ? testing::icosphere(2)
                  : shape == 1 ? testing::torus(24, 12)
                  : shape == 2 ? testing::saddle(10)
                               : testing::genus3(2));
    for (int seed = 0; seed < 5; ++seed) {
      c.problem.points = {random_point(c, 2 * seed), random_point(c, 2 * seed + 1)};
      const double whole = c.solver.distance(c.problem.points[0], c.problem.points[1]);
      const KarcherMean mean = c.solve();
      EXPECT_NEAR(c.solver.distance(c.problem.points[0], mean.mean), whole / 2, 1e-8);
      EXPECT_NEAR(mean.objective, whole * whole / 8, 1e-8);
    }
  }
}

// Hard: weights over twelve orders of magnitude; the light points still turn the last digits that the tolerance asks
// for.
TEST(KarcherPoints, WeightsFromATrillionthToOneConverge) {
  KarcherCase c(testing::icosphere(3));
  for (int k = 0; k <= 12; ++k) {
    c.problem.points.push_back(random_point(c, k));
    c.problem.weights.push_back(std::pow(10.0, -k));
  }
  const KarcherMean mean = c.solve();
  EXPECT_LT(c.solver.distance(c.problem.points[0], mean.mean), 0.5) << "the heavy point should dominate";
}

// Hard: one point outweighs the rest so far that the mean is at it up to the weights' ratio.
TEST(KarcherPoints, AnOverwhelmingWeightPullsTheMeanToItsPoint) {
  KarcherCase c(testing::genus3(2));
  for (int k = 0; k < 4; ++k) c.problem.points.push_back(random_point(c, k));
  c.problem.weights = {1e-12, 1e-12, 1, 1e-12};
  const KarcherMean mean = c.solve();
  EXPECT_LT((mean.position - position(*c.mesh, c.problem.points[2])).norm(), 1e-9 * c.mesh->diagonal());
}

// Hard: there is no path between the components; the error must name who is where instead of returning infinity.
TEST(KarcherPoints, PointsOnTwoComponentsAreAnErrorThatNamesThem) {
  KarcherCase c(testing::two_components());
  std::int32_t other = 0;
  while (c.mesh->component(other) == 0) ++other;
  const Eigen::Vector3d centre = Eigen::Vector3d::Constant(1.0 / 3);
  c.problem.points = {{FaceId{0}, centre}, {FaceId{other}, centre}, {FaceId{1}, centre}, {FaceId{other}, centre}};
  const Error error = testing::expect_error("karcher.unreachable", [&] { karcher_mean(c.solver, c.problem); });
  EXPECT_EQ(testing::places(error), (std::vector<std::string>{"points/1", "points/3"}));
  c.problem.points = {{FaceId{0}, centre}};
  c.problem.start = SurfacePoint{FaceId{other}, centre};
  const Error start = testing::expect_error("karcher.unreachable", [&] { karcher_mean(c.solver, c.problem); });
  EXPECT_EQ(testing::places(start), (std::vector<std::string>{"start"}));
}

}  // namespace
}  // namespace supple::surface
