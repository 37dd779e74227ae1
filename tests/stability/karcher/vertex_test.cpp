// Means at and near vertices, where the objective may have no derivative.
#include "karcher_case.h"

namespace supple::surface {
namespace {

using std::numbers::pi;

SurfacePoint on_cone(int sector, double share) {
  // In the sector's first face, towards the middle of the opposite side.
  return {FaceId{sector}, Eigen::Vector3d(1 - share, share / 2, share / 2)};
}

/// A cone with a saddle for its apex, and points in the middle of evenly spread sectors.
class SaddleCone : public KarcherCase {
 public:
  SaddleCone(double angle, int points) : KarcherCase(testing::cone(12, angle)) {
    for (int k = 0; k < points; ++k) problem.points.push_back(on_cone(k * 12 / points, 0.5));
  }
};

// Hard: the mean is the saddle vertex itself, a tip of the objective, where no derivative tells so. Newton's method
// alone jumps from one side of it to the other.
TEST(KarcherVertex, APinnedMeanIsFoundExactlyAtTheSaddleVertex) {
  SaddleCone c(9.0, 4);
  for (const auto method :
       {MinimizationMethod::newton, MinimizationMethod::lbfgs, MinimizationMethod::gradient_descent}) {
    c.problem.method = method;
    const KarcherMean mean = c.solve();
    EXPECT_EQ(mean.stopped, KarcherTermination::kink);
    EXPECT_EQ(mean.position, c.mesh->positions()[0]);
    EXPECT_LE(mean.iterations, 20);
  }
}

// Hard: a tip is the minimum for a whole range of weights, not by symmetry.
TEST(KarcherVertex, APinnedMeanStaysAtTheVertexWhileTheWeightsChangeALittleAndLeavesWhenTheyChangeALot) {
  SaddleCone c(9.0, 4);
  c.problem.weights = {1, 1.05, 0.95, 1.02};
  EXPECT_EQ(c.solve().position, c.mesh->positions()[0]);
  c.problem.weights = {10, 1, 1, 1};
  const KarcherMean moved = c.solve();
  EXPECT_EQ(moved.stopped, KarcherTermination::converged);
  EXPECT_GT((moved.position - c.mesh->positions()[0]).norm(), 0.1);
}

// Hard: at a convex apex the distance has a kink in every direction that is opposite to a point; the gradient of any
// one unfolding is meaningless there.
TEST(KarcherVertex, AStartAtAConvexApexIsLeftSinceAnApexIsNeverAMean) {
  for (const double angle : {2.0, 4.0, 6.0}) {
    SCOPED_TRACE(::testing::Message() << "cone angle " << angle);
    KarcherCase c(testing::cone(12, angle));
    for (int k = 0; k < 3; ++k) c.problem.points.push_back(on_cone(4 * k, 0.4));
    c.problem.start = vertex_point(*c.mesh, VertexId{0});
    const KarcherMean mean = c.solve();
    EXPECT_GT((mean.position - c.mesh->positions()[0]).norm(), 1e-3);
    EXPECT_LT(mean.objective, mean.history.front().objective);
  }
}

// Hard: the point and the start are vertices, so every evaluation starts with a degenerate path.
TEST(KarcherVertex, MeansOfVerticesArriveFromStartsAtVerticesAndEdges) {
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    KarcherCase c(seed % 2 == 0 ? testing::saddle(10) : testing::icosphere(2));
    RandomStream random("karcher_vertices", seed);
    for (int i = 0; i < 4; ++i) c.problem.points.push_back(testing::random_vertex_point(*c.mesh, random));
    c.problem.start =
        seed % 4 < 2 ? testing::random_vertex_point(*c.mesh, random) : testing::random_edge_point(*c.mesh, random);
    c.solve();
  }
}

// Hard: in the plane the centroid is a vertex of the mesh, flat up to rounding, and lies on many edges.
TEST(KarcherVertex, AMeanAtAFlatVertexIsAnOrdinaryMean) {
  KarcherCase c(testing::flat_grid(4, 4));
  c.problem.points = {c.near(0.5, 0.5, 0), c.near(3.5, 0.5, 0), c.near(3.5, 3.5, 0), c.near(0.5, 3.5, 0)};
  const KarcherMean mean = c.solve();
  EXPECT_LT((mean.position - Eigen::Vector3d(2, 2, 0)).norm(), 1e-9);
}

// Hard: the mean lies exactly on an edge, whose faces have different frames.
TEST(KarcherVertex, AMeanExactlyOnAnEdgeIsReached) {
  KarcherCase c(testing::flat_grid(3, 3));
  c.problem.points = {c.near(0.5, 1.5, 0), c.near(1.5, 1.5, 0)};
  EXPECT_LT((c.solve().position - Eigen::Vector3d(1, 1.5, 0)).norm(), 1e-9);
}

// Hard: paths round a boundary corner are pinned at it, and the mean of the two ends is the corner.
TEST(KarcherVertex, AMeanAtAReflexCornerOfTheBoundaryIsFoundExactly) {
  KarcherCase c(testing::l_shape(6));
  c.problem.points = {c.near(1.9, 0.9, 0), c.near(0.9, 1.9, 0)};
  const KarcherMean mean = c.solve();
  EXPECT_LT((mean.position - Eigen::Vector3d(1, 1, 0)).norm(), 1e-9);
  // A third point outside pulls the mean away from the corner, into the surface.
  c.problem.points.push_back(c.near(0.1, 0.1, 0));
  EXPECT_GT((c.solve().position - Eigen::Vector3d(1, 1, 0)).norm(), 0.01);
}

// Hard: all points and the mean lie on the boundary, where half of all steps lead off the surface.
TEST(KarcherVertex, PointsOnTheBoundaryHaveAMeanThatDoesNotLeaveTheSurface) {
  KarcherCase c(testing::flat_grid(6, 2));
  c.problem.points = {c.near(0, 0, 0), c.near(2.3, 0, 0), c.near(6, 0, 0)};
  const KarcherMean mean = c.solve();
  EXPECT_LT((mean.position - Eigen::Vector3d(8.3 / 3, 0, 0)).norm(), 1e-9);
}

// Hard: the shortest paths run round a hole whose rim pins them.
TEST(KarcherVertex, PointsOnBothLipsOfASlitMeetRoundTheHole) {
  KarcherCase c(testing::slit_annulus());
  c.problem.points = {c.near(0.75, 0.1, 0), c.near(0.75, -0.1, 0), c.near(-0.75, 0.05, 0)};
  c.problem.weights = {1, 1, 0.01};
  const KarcherMean mean = c.solve();
  EXPECT_LT(mean.position.x(), 0) << "the mean of the lips lies on the far side of the hole";
}

// Hard: the start is within rounding of a vertex without being on it.
TEST(KarcherVertex, StartsWithinRoundingOfASaddleVertexArrive) {
  for (const double offset : {1e-16, 1e-13, 1e-10, 1e-6}) {
    SCOPED_TRACE(::testing::Message() << "offset " << offset);
    SaddleCone c(9.0, 3);
    c.problem.weights = {5, 1, 1};
    c.problem.start = SurfacePoint{FaceId{0}, Eigen::Vector3d(1 - 3 * offset, offset, 2 * offset)};
    c.solve();
  }
}

}  // namespace
}  // namespace supple::surface
