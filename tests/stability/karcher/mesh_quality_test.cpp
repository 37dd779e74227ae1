// Means on meshes that make unfolding inaccurate or searches long.
#include "karcher_case.h"

namespace supple::surface {
namespace {

void expect_random_means(TriangleMesh mesh, int problems, int points) {
  KarcherCase c(std::move(mesh));
  for (int seed = 0; seed < problems; ++seed) {
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    RandomStream random("karcher_mesh_quality", seed);
    c.problem.points.clear();
    for (int i = 0; i < points; ++i) c.problem.points.push_back(testing::random_point(*c.mesh, random));
    c.solve();
  }
}

// Hard: obtuse faces of aspect ratio above 1,000, across which directions lose digits.
TEST(KarcherMeshQuality, ASphereOfSliversConverges) { expect_random_means(testing::sliver_sphere(), 10, 5); }

// Hard: needles along a tube so thin that every path winds or runs straight, with cut loci a hair apart.
TEST(KarcherMeshQuality, ANeedleCylinderConverges) { expect_random_means(testing::needle_cylinder(), 5, 3); }

// Hard: random diagonals and stretched faces in a plane, whose mean is known: the centroid.
TEST(KarcherMeshQuality, AJitteredPlaneGivesTheCentroid) {
  RandomStream jitter("karcher_jitter", 1);
  KarcherCase c(testing::jittered_grid(12, 12, jitter));
  RandomStream random("karcher_jitter_points", 1);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int i = 0; i < 9; ++i) {
    c.problem.points.push_back(testing::random_point(*c.mesh, random));
    sum += position(*c.mesh, c.problem.points.back());
  }
  EXPECT_LT((c.solve().position - sum / 9).norm(), 1e-9);
}

// Hard: every inner vertex is a saddle that may pin paths, and Hessians grow without bound towards it.
TEST(KarcherMeshQuality, ASurfaceOfSaddleVerticesConverges) { expect_random_means(testing::saddle(16), 15, 5); }

// Hard: bumps split the wave fronts, so that many different paths are almost equally short.
TEST(KarcherMeshQuality, ABumpyCubeConverges) { expect_random_means(testing::bumpy_cube(16, 4), 5, 5); }

// Hard: paths wind through a long tube and change sides of it from one point to the next.
TEST(KarcherMeshQuality, AKnottedTubeConverges) { expect_random_means(testing::trefoil_knot(80, 8), 8, 5); }

// Hard: a boundary that the unrestricted step crosses.
TEST(KarcherMeshQuality, AnOpenHemisphereConverges) { expect_random_means(testing::open_hemisphere(), 10, 4); }

// Hard: coordinates near the ends of the range that squares survive; tolerances must follow the mesh's size.
TEST(KarcherMeshQuality, TheMeanScalesWithTheMesh) {
  const TriangleMesh unit = testing::icosphere(2);
  Eigen::Vector3d expected = Eigen::Vector3d::Zero();
  for (const double scale : {1.0, 1e-40, 1e40}) {
    std::vector<Eigen::Vector3d> positions = unit.positions();
    for (auto& p : positions) p *= scale;
    const auto mesh = std::make_shared<const TriangleMesh>(TriangleMesh::build(positions, unit.faces()));
    const GeodesicSolver solver(mesh);
    RandomStream random("karcher_scale", 1);
    KarcherProblem problem;
    for (int i = 0; i < 4; ++i) problem.points.push_back(testing::random_point(*mesh, random));
    const KarcherMean mean = karcher_mean(solver, problem);
    EXPECT_EQ(mean.stopped, KarcherTermination::converged) << scale;
    if (scale == 1.0) expected = mean.position;
    EXPECT_LT((mean.position / scale - expected).norm(), 1e-8) << scale;
  }
}

}  // namespace
}  // namespace supple::surface
