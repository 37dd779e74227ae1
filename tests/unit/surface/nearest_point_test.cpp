#include "supple/surface/nearest_point.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "supple/base/random.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

/// The distance of p from the triangle by trying many of its points, finer and finer around the nearest one.
double sampled_distance(const Eigen::Vector3d& p, const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c) {
  double u = 1.0 / 3, v = 1.0 / 3, reach = 1, least = std::numeric_limits<double>::infinity();
  for (int level = 0; level < 45; ++level, reach *= 0.6) {
    const double middle_u = u, middle_v = v;
    for (int i = -4; i <= 4; ++i) {
      for (int j = -4; j <= 4; ++j) {
        const double s = std::clamp(middle_u + reach * i / 4, 0.0, 1.0);
        const double t = std::clamp(middle_v + reach * j / 4, 0.0, 1 - s);
        const double distance = (a + s * (b - a) + t * (c - a) - p).norm();
        if (distance >= least) continue;
        least = distance;
        u = s;
        v = t;
      }
    }
  }
  return least;
}

TEST(NearestPoint, IsAsNearAsTheNearestOfAllFaces) {
  for (const TriangleMesh& mesh : {testing::torus(12, 8), testing::bumpy_cube(4), testing::open_hemisphere()}) {
    const NearestPointSearch search(mesh);
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      RandomStream stream("nearest points", seed);
      const double size = std::pow(10, stream.uniform(-2, 2));
      const Eigen::Vector3d p(stream.uniform(-size, size), stream.uniform(-size, size), stream.uniform(-size, size));
      double least = std::numeric_limits<double>::infinity();
      for (const Triangle& face : mesh.faces()) {
        const auto& x = mesh.positions();
        least = std::min(least, sampled_distance(p, x[face[0]], x[face[1]], x[face[2]]));
      }
      const NearestPoint nearest = search.find(p);
      EXPECT_NEAR(nearest.distance, least, 1e-8 * (1 + size)) << "seed " << seed;
      EXPECT_NEAR((position(mesh, nearest.point) - p).norm(), nearest.distance, 1e-12 * (1 + size));
      EXPECT_GE(nearest.point.barycentric.minCoeff(), 0);
      EXPECT_NO_THROW(checked_point(mesh, nearest.point));
    }
  }
}

TEST(NearestPoint, OfAVertexOrAPointOnTheSurfaceIsThatPoint) {
  const TriangleMesh mesh = testing::icosphere(3);
  const NearestPointSearch search(mesh);
  RandomStream stream("on the surface", 1);
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
    const std::int32_t v = mesh.faces()[f][f % 3];
    const NearestPoint vertex = search.find(mesh.positions()[v]);
    EXPECT_EQ(vertex.distance, 0);
    ASSERT_GE(corner_of(vertex.point), 0);
    EXPECT_EQ(mesh.faces()[index(vertex.point.face)][corner_of(vertex.point)], v);
    const double a = stream.uniform(0.05, 0.9), b = stream.uniform(0.05, 0.95 - a);
    const SurfacePoint inner{FaceId(f), {a, b, 1 - a - b}};
    const NearestPoint found = search.find(position(mesh, inner));
    EXPECT_EQ(index(found.point.face), f);
    EXPECT_LT((found.point.barycentric - inner.barycentric).norm(), 1e-13);
    EXPECT_LT(found.distance, 1e-15);
  }
}

TEST(NearestPoint, OfEquallyNearOnesBelongsToTheFirstFace) {
  // The middle of a sphere is as far from every face of an octahedron.
  const TriangleMesh mesh =
      TriangleMesh::build({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
                          {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}});
  const NearestPoint nearest = NearestPointSearch(mesh).find({0, 0, 0});
  EXPECT_EQ(index(nearest.point.face), 0);
  EXPECT_NEAR(nearest.distance, 1 / std::sqrt(3), 1e-15);
  EXPECT_EQ(NearestPointSearch(mesh).find({1e70, 0, 0}).point.barycentric, Eigen::Vector3d(1, 0, 0));
}

TEST(NearestPoint, OnSliversIsNotLostInTheirThinness) {
  const TriangleMesh mesh = TriangleMesh::build({{0, 0, 0}, {1, 0, 0}, {0.5, 1e-9, 0}}, {{0, 1, 2}});
  const NearestPoint nearest = NearestPointSearch(mesh).find({0.25, 3, 4});
  EXPECT_NEAR(nearest.distance, 5, 1e-8);
  EXPECT_NEAR(nearest.position[0], 0.25, 1e-8);
}

}  // namespace
}  // namespace supple::surface
