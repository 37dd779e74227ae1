// Hard cases of local rebuilds, where sites have moved: each diagram is compared with one computed from scratch.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/voronoi/moving_diagram.h"
#include "support/diagram_comparison.h"
#include "support/shapes.h"

namespace supple::voronoi {
namespace {

using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// Kinds of positions of a site that are hard.
enum class Place { vertex, edge, near_vertex, near_edge, anywhere };

SurfacePoint drawn_place(const TriangleMesh& mesh, Place place, RandomStream& random) {
  SurfacePoint point = random_sites(mesh, 1, static_cast<std::uint64_t>(1 + 1e6 * random.uniform()))[0];
  const double fraction = 0.2 + 0.6 * random.uniform();
  switch (place) {
    case Place::vertex:
      point.barycentric = {0, 1, 0};
      break;
    case Place::edge:
      point.barycentric = {fraction, 0, 1 - fraction};
      break;
    case Place::near_vertex:
      point.barycentric = {1 - 2e-11, 1e-11, 1e-11};
      break;
    case Place::near_edge:
      point.barycentric = {fraction, 1 - fraction - 1e-11, 1e-11};
      break;
    case Place::anywhere:
      break;
  }
  return point;
}

/// Moves random ones of `count` sites to such positions, one after the other.
void expect_same_after_moves(const TriangleMesh& mesh, int count, Place place, int moves, std::uint64_t seed) {
  const GeodesicSolver solver(testing::share(mesh));
  MovingDiagram moving(solver);
  std::vector<SurfacePoint> sites = random_sites(mesh, count, seed);
  moving.move_to(sites);
  RandomStream random("moved_sites", seed);
  for (int i = 0; i < moves; ++i) {
    sites[static_cast<std::size_t>(random.uniform() * count)] = drawn_place(mesh, place, random);
    moving.move_to(sites);
    SCOPED_TRACE("move " + std::to_string(i) + " of seed " + std::to_string(seed));
    EXPECT_TRUE(moving.last_rebuild().local);
    const Diagram wanted = diagram(solver, sites);
    if (place == Place::near_vertex || place == Place::edge) {
      // Windows from a site next to a vertex overlap everywhere by the error of its directions, and rounding decides on
      // the bends of all borders. From a site on an edge of a sliver this affects some borders.
      testing::expect_same_diagram(testing::without_bends(moving.diagram()), testing::without_bends(wanted),
                                   1e-12 * mesh.diagonal());
    } else {
      testing::expect_same_diagram(moving.diagram(), wanted, 1e-12 * mesh.diagonal());
    }
    if (::testing::Test::HasFailure()) return;
  }
}

TEST(MovedSites, OntoVerticesAndEdgesGiveTheDiagramMadeAnew) {
  for (const Place place : {Place::vertex, Place::edge, Place::near_vertex, Place::near_edge}) {
    SCOPED_TRACE(static_cast<int>(place));
    expect_same_after_moves(testing::genus3(2), 60, place, 25, 11);
    expect_same_after_moves(testing::rabbit(2), 60, place, 25, 12);
  }
}

TEST(MovedSites, OnSliversGiveTheDiagramMadeAnew) {
  expect_same_after_moves(testing::sliver_sphere(), 50, Place::anywhere, 30, 13);
  expect_same_after_moves(testing::sliver_sphere(), 50, Place::edge, 20, 14);
  expect_same_after_moves(testing::needle_cylinder(), 20, Place::anywhere, 30, 19);
}

TEST(MovedSites, ThatMeetAndPartGiveTheDiagramMadeAnew) {
  const TriangleMesh mesh = testing::icosphere(2);
  const GeodesicSolver solver(testing::share(mesh));
  MovingDiagram moving(solver);
  std::vector<SurfacePoint> sites = random_sites(mesh, 30, 15);
  const std::vector<SurfacePoint> start = sites;
  moving.move_to(sites);
  const auto move = [&](std::size_t site, const SurfacePoint& to) {
    sites[site] = to;
    testing::expect_same_diagram(moving.move_to(sites), diagram(solver, sites), 1e-12 * mesh.diagonal());
    EXPECT_TRUE(moving.last_rebuild().local);
  };
  move(7, start[3]);   // the later site loses its cell
  move(3, start[7]);   // that site gets it back
  move(12, start[7]);  // onto a site that has moved
  move(1, start[7]);   // the earlier site takes the cell over
  move(1, start[1]);
  move(3, start[3]);
  move(7, start[7]);
  move(12, start[12]);
}

TEST(MovedSites, FromOneComponentToAnotherGiveTheDiagramMadeAnew) {
  const TriangleMesh one = testing::icosphere(2);
  std::vector<Eigen::Vector3d> positions = one.positions();
  std::vector<surface::Triangle> faces = one.faces();
  for (const Eigen::Vector3d& p : one.positions()) positions.push_back(p + Eigen::Vector3d(5, 0, 0));
  for (const surface::Triangle& f : one.faces())
    faces.push_back({f[0] + one.vertex_count(), f[1] + one.vertex_count(), f[2] + one.vertex_count()});
  const TriangleMesh mesh = TriangleMesh::build(positions, faces);
  const GeodesicSolver solver(testing::share(mesh));
  MovingDiagram moving(solver);
  std::vector<SurfacePoint> sites = random_sites(one, 10, 16);
  moving.move_to(sites);
  const SurfacePoint home = sites[4];
  for (const int face : {one.face_count() + 7, one.face_count() + 90}) {
    sites[4].face = FaceId{face};
    testing::expect_same_diagram(moving.move_to(sites), diagram(solver, sites), 1e-12 * mesh.diagonal());
    EXPECT_TRUE(moving.last_rebuild().local);
    EXPECT_EQ(moving.diagram().unreached_area, 0);
  }
  sites[4] = home;
  testing::expect_same_diagram(moving.move_to(sites), diagram(solver, sites), 1e-12 * mesh.diagonal());
  EXPECT_GT(moving.diagram().unreached_area, 10);
}

TEST(MovedSites, ByLessThanRoundingShowsGiveAPartitionAllTheSame) {
  const TriangleMesh mesh = testing::icosphere(2);
  const GeodesicSolver solver(testing::share(mesh));
  MovingDiagram moving(solver);
  std::vector<SurfacePoint> sites = random_sites(mesh, 40, 17);
  moving.move_to(sites);
  for (const double displacement : {1e-15, 1e-13, 1e-11, 1e-9, 1e-7}) {
    sites[5].barycentric += Eigen::Vector3d(displacement, -displacement, 0);
    testing::expect_same_diagram(moving.move_to(sites), diagram(solver, sites), 1e-12 * mesh.diagonal());
  }
}

TEST(MovedSites, AThousandTimesDoNotDriftFromTheDiagramMadeAnew) {
  const TriangleMesh mesh = testing::torus(24, 12);
  const GeodesicSolver solver(testing::share(mesh));
  MovingDiagram moving(solver);
  std::vector<SurfacePoint> sites = random_sites(mesh, 80, 18);
  moving.move_to(sites);
  RandomStream random("moved_sites", 18);
  for (int i = 0; i < 1000; ++i) {
    sites[static_cast<std::size_t>(random.uniform() * 80)] = drawn_place(mesh, Place::anywhere, random);
    moving.move_to(sites);
    ASSERT_TRUE(moving.last_rebuild().local);
  }
  testing::expect_same_diagram(moving.diagram(), diagram(solver, sites), 1e-12 * mesh.diagonal());
}

}  // namespace
}  // namespace supple::voronoi
