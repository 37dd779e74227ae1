#include "supple/voronoi/moving_diagram.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/surface/moving_points.h"
#include "support/diagram_comparison.h"
#include "support/expect_error.h"
#include "support/shapes.h"

namespace supple::voronoi {
namespace {

using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// Moves one site after the other, each by up to `reach` in a random direction, and compares each diagram with a full
/// computation. Returns the number of local rebuilds.
int expect_same_after_moves(const TriangleMesh& mesh, int sites, int moves, double reach, std::uint64_t seed,
                            const DiagramOptions& options = {}) {
  const GeodesicSolver solver(testing::share(mesh));
  MovingDiagram moving(solver, options);
  surface::MovingPoints points(mesh, random_sites(mesh, sites, seed));
  moving.move_to(points.points());
  RandomStream random("moved_sites", seed);
  int local = 0;
  for (int i = 0; i < moves; ++i) {
    Eigen::VectorXd step = Eigen::VectorXd::Zero(points.dimension());
    const auto site = static_cast<Eigen::Index>(random.uniform() * sites);
    const double angle = 6.283185307179586 * random.uniform();
    const double length = reach * random.uniform();
    step[2 * site] = length * std::cos(angle);
    step[2 * site + 1] = length * std::sin(angle);
    points.move(mesh, step);
    moving.move_to(points.points());
    local += moving.last_rebuild().local ? 1 : 0;
    SCOPED_TRACE("move " + std::to_string(i) + " of seed " + std::to_string(seed));
    testing::expect_same_diagram(moving.diagram(), diagram(solver, points.points(), options), 1e-12 * mesh.diagonal());
    if (::testing::Test::HasFailure()) break;
  }
  return local;
}

TEST(MovingDiagram, AfterSmallMovesIsTheOneMadeAnew) {
  EXPECT_EQ(expect_same_after_moves(testing::icosphere(3), 98, 15, 0.1, 1), 15);
  EXPECT_EQ(expect_same_after_moves(testing::torus(24, 12), 60, 15, 0.1, 2), 15);
  EXPECT_EQ(expect_same_after_moves(testing::genus3(2), 50, 10, 0.2, 3), 10);
}

TEST(MovingDiagram, AfterMovesAcrossManyCellsIsTheOneMadeAnew) {
  EXPECT_EQ(expect_same_after_moves(testing::icosphere(3), 98, 10, 3, 4), 10);
  EXPECT_EQ(expect_same_after_moves(testing::genus3(2), 50, 10, 5, 5), 10);
}

TEST(MovingDiagram, TakesMemoryForTheMeshAndForWhatIsCutHoweverManySitesThereAre) {
  const TriangleMesh mesh = testing::icosphere(4);
  const GeodesicSolver solver(testing::share(mesh));
  const DiagramOptions with_derivatives{.vertex_gradients = true, .border_samples = true, .cell_moments = true};
  for (const DiagramOptions& options : {DiagramOptions{}, with_derivatives}) {
    const double per_face = options.cell_moments ? 95 : 54;
    for (const int sites : {1, 5, 20, 80, 320}) {
      SCOPED_TRACE(sites);
      MovingDiagram moving(solver, options);
      const Diagram& diagram = moving.move_to(random_sites(mesh, sites, 1));
      // The paths from a border to its sites cross so many faces.
      const double crossed = std::sqrt(static_cast<double>(mesh.face_count()) / sites);
      const double per_cut_face = options.cell_moments ? 1900 + 220 * crossed : 600 + 80 * crossed;
      const auto cut = static_cast<double>(std::ranges::count(diagram.face_sites, -1));
      const auto bytes = static_cast<double>(moving.memory_bytes());
      EXPECT_LE(bytes, 1000 + per_face * mesh.face_count() + per_cut_face * cut);
      EXPECT_GE(bytes, 40.0 * mesh.face_count());
    }
  }
}

TEST(MovingDiagram, OfMoreSitesThanFacesIsTheOneMadeAnew) {
  EXPECT_EQ(expect_same_after_moves(testing::icosphere(1), 300, 15, 0.2, 6), 15);
}

TEST(MovingDiagram, OfFewSitesWhoseCellsWrapHandlesIsTheOneMadeAnew) {
  for (const int sites : {1, 2, 3, 5}) {
    SCOPED_TRACE(sites);
    EXPECT_EQ(expect_same_after_moves(testing::torus(24, 12), sites, 10, 1, 7), 10);
  }
}

TEST(MovingDiagram, WithBoundaryIsTheOneMadeAnew) {
  for (const TriangleMesh& mesh :
       {testing::open_hemisphere(), testing::l_shape(4), testing::slit_annulus(), testing::saddle(6)})
    expect_same_after_moves(mesh, 20, 10, 0.3, 8);
}

TEST(MovingDiagram, HasTheDerivativesOfTheOneMadeAnew) {
  expect_same_after_moves(testing::torus(24, 12), 60, 10, 0.3, 9,
                          {.vertex_gradients = true, .border_samples = true, .cell_moments = true});
}

TEST(MovingDiagram, OfSeveralSitesThatMoveAtOnceIsTheOneMadeAnew) {
  const TriangleMesh mesh = testing::icosphere(3);
  const GeodesicSolver solver(testing::share(mesh));
  MovingDiagram moving(solver);
  std::vector<SurfacePoint> sites = random_sites(mesh, 200, 1);
  moving.move_to(sites);
  const std::vector<SurfacePoint> others = random_sites(mesh, 25, 2);
  for (std::size_t i = 0; i < others.size(); ++i) sites[8 * i] = others[i];
  testing::expect_same_diagram(moving.move_to(sites), diagram(solver, sites), 1e-12 * mesh.diagonal());
  EXPECT_TRUE(moving.last_rebuild().local);
  EXPECT_EQ(moving.last_rebuild().moved_sites, 25);
}

TEST(MovingDiagram, CutsOnlyFacesNearTheMovedSite) {
  const TriangleMesh mesh = testing::icosphere(4);
  const GeodesicSolver solver(testing::share(mesh));
  MovingDiagram moving(solver);
  surface::MovingPoints points(mesh, random_sites(mesh, 500, 1));
  moving.move_to(points.points());
  EXPECT_FALSE(moving.last_rebuild().local);
  EXPECT_EQ(moving.last_rebuild().cut_faces, mesh.face_count());
  Eigen::VectorXd step = Eigen::VectorXd::Zero(points.dimension());
  step[0] = 0.01;
  points.move(mesh, step);
  EXPECT_TRUE(moving.is_near(points.points()));
  moving.move_to(points.points());
  EXPECT_TRUE(moving.last_rebuild().local);
  EXPECT_EQ(moving.last_rebuild().moved_sites, 1);
  EXPECT_GT(moving.last_rebuild().cut_faces, 0);
  EXPECT_LT(moving.last_rebuild().cut_faces, mesh.face_count() / 50);
}

TEST(MovingDiagram, IsMadeAnewForOtherNumbersOfSitesAndOtherMethods) {
  const TriangleMesh mesh = testing::icosphere(2);
  const GeodesicSolver solver(testing::share(mesh));
  const std::vector<SurfacePoint> sites = random_sites(mesh, 30, 1);
  MovingDiagram moving(solver);
  EXPECT_FALSE(moving.is_near(sites));
  moving.move_to(sites);
  const std::vector<SurfacePoint> more = random_sites(mesh, 31, 1);
  EXPECT_FALSE(moving.is_near(more));
  testing::expect_same_diagram(moving.move_to(more), diagram(solver, more), 1e-12);
  MovingDiagram bounded(solver, {.method = DiagramMethod::bounded});
  bounded.move_to(sites);
  EXPECT_FALSE(bounded.is_near(sites));
}

TEST(MovingDiagram, IsMadeAnewAfterAFault) {
  const TriangleMesh mesh = testing::icosphere(2);
  const GeodesicSolver solver(testing::share(mesh));
  std::vector<SurfacePoint> sites = random_sites(mesh, 30, 1);
  MovingDiagram moving(solver);
  moving.move_to(sites);
  const Execution stopped;
  stopped.cancellation.request(StopReason::cancelled);
  sites[3] = random_sites(mesh, 1, 2)[0];
  EXPECT_ANY_THROW(moving.move_to(sites, stopped));
  testing::expect_same_diagram(moving.move_to(sites), diagram(solver, sites), 1e-12);
  EXPECT_FALSE(moving.last_rebuild().local);
}

}  // namespace
}  // namespace supple::voronoi
