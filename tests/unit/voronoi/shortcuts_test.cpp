#include "supple/voronoi/shortcuts.h"

#include <gtest/gtest.h>

#include "supple/surface/matrices.h"
#include "support/shapes.h"

namespace supple::voronoi {
namespace {

TEST(DiagramOfAMesh, IsThatOfItsSolver) {
  const surface::TriangleMesh mesh = testing::torus(24, 12);
  const std::vector<surface::SurfacePoint> sites = random_sites(mesh, 8);
  const Diagram expected = diagram(surface::GeodesicSolver(testing::share(mesh)), sites);
  const Diagram found = diagram(mesh, sites);
  EXPECT_EQ(areas_of(found), areas_of(expected));
  EXPECT_EQ(dual_faces_of(found), dual_faces_of(expected));
  EXPECT_EQ(dual_faces_of(found).rows(), static_cast<Eigen::Index>(found.dual.size()));

  const Diagram nearest = diagram(surface::vertices_of(mesh), surface::faces_of(mesh), surface::positions(mesh, sites));
  EXPECT_LT((areas_of(nearest) - areas_of(expected)).cwiseAbs().maxCoeff(), 1e-10);
}

TEST(BoundaryOfACell, IsAClosedCurveOfPositions) {
  const surface::TriangleMesh mesh = testing::flat_grid(4, 4);
  const Diagram found = diagram(mesh, random_sites(mesh, 3));
  double area = 0;
  for (std::size_t site = 0; site < 3; ++site) {
    for (const Eigen::MatrixXd& curve : boundary_of(found, site)) {
      for (Eigen::Index i = 0; i < curve.rows(); ++i) {
        const auto next = curve.row((i + 1) % curve.rows());
        area += (curve(i, 0) * next[1] - curve(i, 1) * next[0]) / 2;
      }
    }
  }
  EXPECT_NEAR(area, areas_of(found).sum(), 1e-6 * area);
}

TEST(Optimization, OfAMeshIsThatOfItsSolver) {
  const surface::TriangleMesh mesh = testing::torus(16, 8);
  OptimizationOptions options;
  options.weights.centroidal = 1;
  options.max_iterations = 3;
  const auto sites = random_sites(mesh, 5);
  EXPECT_EQ(areas_of(optimize(mesh, sites, options).diagram),
            areas_of(optimize(surface::GeodesicSolver(testing::share(mesh)), sites, options).diagram));
}

}  // namespace
}  // namespace supple::voronoi
