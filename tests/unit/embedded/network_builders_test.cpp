#include "supple/embedded/network_builders.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "supple/base/error.h"
#include "support/shapes.h"

namespace supple::embedded {
namespace {

using surface::GeodesicSolver;

TEST(PointsInFaces, AreOneForEachFace) {
  const auto mesh = testing::icosphere(1);
  const auto points = points_in_faces(mesh, {0.99, 1e-6, 1 - 0.99 - 1e-6});
  ASSERT_EQ(points.size(), static_cast<std::size_t>(mesh.face_count()));
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) EXPECT_EQ(index(points[static_cast<std::size_t>(f)].face), f);
  EXPECT_THROW(points_in_faces(mesh, {0.5, 0.6, 0.2}), Error);
}

TEST(PoissonDiskPoints, AreApartAndLeaveNoRoom) {
  for (const auto& mesh : {testing::torus(24, 12), testing::open_hemisphere(), testing::two_components()}) {
    const GeodesicSolver solver(testing::share(mesh));
    const double radius = 0.3;
    const auto points = poisson_disk_points(solver, radius, 3);
    ASSERT_GT(points.size(), 20U);
    double nearest = 1e9;
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) nearest = std::min(nearest, solver.distance(points[i], points[j]));
    EXPECT_GE(nearest, radius);
    const auto field = solver.field(points);
    const double widest = *std::ranges::max_element(field.vertex_distances());
    EXPECT_LT(widest, 1.6 * radius) << "some place is far from all points";
  }
}

TEST(PoissonDiskPoints, AreTheSameForTheSameSeed) {
  const GeodesicSolver solver(testing::share(testing::torus(24, 12)));
  const auto first = poisson_disk_points(solver, 0.4, 5);
  const auto again = poisson_disk_points(solver, 0.4, 5);
  const auto other = poisson_disk_points(solver, 0.4, 6);
  ASSERT_EQ(first.size(), again.size());
  for (std::size_t i = 0; i < first.size(); ++i) EXPECT_EQ(first[i].barycentric, again[i].barycentric);
  EXPECT_FALSE(std::ranges::equal(
      first, other, {}, [](const auto& p) { return p.face; }, [](const auto& p) { return p.face; }));
}

TEST(PoissonDiskPoints, RefuseARadiusThatLeavesRoomForTooMany) {
  const GeodesicSolver solver(testing::share(testing::torus(24, 12)));
  EXPECT_THROW(poisson_disk_points(solver, 0), Error);
  EXPECT_THROW(poisson_disk_points(solver, 1e-4, 1, 1000), Error);
}

TEST(PairsOfAdjacentFaces, AreTheDualGraph) {
  const auto mesh = testing::torus(12, 6);
  const auto pairs = pairs_of_adjacent_faces(mesh, points_in_faces(mesh, {0.3, 0.3, 0.4}));
  EXPECT_EQ(2 * pairs.size(), 3 * static_cast<std::size_t>(mesh.face_count()));
  for (const auto& [a, b] : pairs) EXPECT_LT(a, b);
}

/// The Euler characteristic of a triangulation that uses all points.
int euler(std::size_t points, const Triangulation& triangulation) {
  return static_cast<int>(points) - static_cast<int>(triangulation.edges.size()) +
         static_cast<int>(triangulation.triangles.size());
}

TEST(Triangulate, HasTheTopologyOfTheSurfaceAndOneOrientation) {
  const std::vector<std::pair<surface::TriangleMesh, int>> surfaces = {
      {testing::icosphere(3), 2}, {testing::torus(24, 12), 0}, {testing::genus3(3), -4}};
  for (const auto& [mesh, characteristic] : surfaces) {
    const GeodesicSolver solver(testing::share(mesh));
    const auto points = poisson_disk_points(solver, 0.12 * mesh.diagonal() * (characteristic < 0 ? 0.5 : 1), 1);
    const Triangulation triangulation = triangulate(solver, points);
    EXPECT_EQ(euler(points.size(), triangulation), characteristic);
    std::map<Pair, int> sides;  // how often the triangles have each directed edge
    for (const auto& t : triangulation.triangles)
      for (int i = 0; i < 3; ++i) ++sides[{t[static_cast<std::size_t>(i)], t[static_cast<std::size_t>((i + 1) % 3)]}];
    for (const auto& [side, count] : sides) {
      EXPECT_EQ(count, 1);
      EXPECT_EQ(sides.count({side.second, side.first}), 1U);
    }
    EXPECT_EQ(sides.size(), 2 * triangulation.edges.size());
  }
}

TEST(Triangulate, FindsCellsThatAreSmallerThanFaces) {
  const auto mesh = testing::icosphere(1);
  const GeodesicSolver solver(testing::share(mesh));
  const auto points = poisson_disk_points(solver, 0.15, 1);
  ASSERT_GT(points.size(), 4 * static_cast<std::size_t>(mesh.face_count()));
  EXPECT_EQ(euler(points.size(), triangulate(solver, points)), 2);
}

}  // namespace
}  // namespace supple::embedded
