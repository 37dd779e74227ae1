// Means whose anchors are seen from near their cut loci, where the distance has a kink and no derivative.
#include "karcher_case.h"

namespace supple::surface {
namespace {

// Hard: every point of the equator is a mean, and seen from either pole the other one's direction is arbitrary.
TEST(KarcherCutLocus, AntipodalPointsHaveAMeanHalfwayBetweenThem) {
  KarcherCase c(testing::icosphere(3));
  c.problem.points = {c.near(0, 0, 1), c.near(0, 0, -1)};
  const double whole = c.solver.distance(c.problem.points[0], c.problem.points[1]);
  const KarcherMean mean = c.solve();
  EXPECT_NEAR(c.solver.distance(c.problem.points[0], mean.mean), whole / 2, 1e-8);
  EXPECT_NEAR(c.solver.distance(c.problem.points[1], mean.mean), whole / 2, 1e-8);
}

// Hard: by symmetry the gradient vanishes at the start for one choice of equally short paths, though the start is a
// maximum along the meridians.
TEST(KarcherCutLocus, AStartOppositeToAllPointsIsLeft) {
  KarcherCase c(testing::icosphere(3));
  for (int k = 0; k < 3; ++k) {
    const double angle = 2 * std::numbers::pi * k / 3;
    c.problem.points.push_back(c.near(0.3 * std::cos(angle), 0.3 * std::sin(angle), 0.95));
  }
  c.problem.start = c.near(0, 0, -1);
  const KarcherMean mean = c.solve();
  EXPECT_GT(mean.position.z(), 0.9);
}

// Hard: the start lies exactly on the other two points' cut locus (the ring opposite to them on the tube), where their
// gradients cancel for one choice of paths.
TEST(KarcherCutLocus, AStartOnTheCutLocusOfATorusIsLeft) {
  KarcherCase c(testing::torus(48, 24));
  c.problem.points = {c.near(1.4, 0, 0), c.near(-1.4, 0, 0)};
  c.problem.start = c.near(0, 1.0, 0.4);
  const KarcherMean symmetric = c.solve();
  c.problem.start = c.near(0, 0.6, 0);
  const KarcherMean inner = c.solve();
  EXPECT_LE(inner.objective, inner.history.front().objective);
  EXPECT_LE(symmetric.objective, symmetric.history.front().objective);
}

// Hard: on a smooth sphere the objective of evenly spread points is nearly constant; on the mesh it has hundreds of
// pieces with a kink between each two.
TEST(KarcherCutLocus, EvenlySpreadPointsConverge) {
  KarcherCase c(testing::icosphere(3));
  for (const double s : {1.0, -1.0})
    for (int axis = 0; axis < 3; ++axis)
      c.problem.points.push_back(testing::nearest_point(*c.mesh, s * Eigen::Vector3d::Unit(axis)));
  c.solve();
}

// Hard: five points anywhere on a sphere; the iteration crosses cut loci on its way. Every seed must arrive.
TEST(KarcherCutLocus, RandomPointsOnASphereArriveByEveryMethod) {
  KarcherCase c(testing::icosphere(3));
  for (const auto method :
       {MinimizationMethod::newton, MinimizationMethod::lbfgs, MinimizationMethod::gradient_descent}) {
    for (int seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE(::testing::Message() << "seed " << seed);
      RandomStream random("karcher_cut_locus", seed);
      c.problem = {};
      for (int i = 0; i < 5; ++i) c.problem.points.push_back(testing::random_point(*c.mesh, random));
      c.problem.method = method;
      c.solve();
    }
  }
}

// Hard: paths run round either side of each hole, so that the objective has kinks along curves all over the surface.
TEST(KarcherCutLocus, PointsAcrossTheHandlesOfAGenusThreeSurfaceArrive) {
  KarcherCase c(testing::genus3());
  for (int seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    RandomStream random("karcher_genus3", seed);
    c.problem.points.clear();
    for (int i = 0; i < 6; ++i) c.problem.points.push_back(testing::random_point(*c.mesh, random));
    c.solve();
  }
}

// Hard: on the torus two of the four ways between the points are equally short.
TEST(KarcherCutLocus, OppositePointsOfATorusHaveAMean) {
  KarcherCase c(testing::torus());
  c.problem.points = {c.near(1.4, 0, 0), c.near(-0.6, 0, 0), c.near(0, 1, 0.4)};
  c.solve();
}

}  // namespace
}  // namespace supple::surface
