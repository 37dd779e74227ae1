// Paths: what they touch, how long they are, what pins them, and whether they are the only shortest ones.
#include <gtest/gtest.h>

#include <memory>
#include <set>

#include "supple/surface/geodesic_solver.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using Eigen::Vector3d;
using testing::share;

std::set<std::int32_t> faces_of(const TriangleMesh& mesh, const SurfacePoint& point) {
  std::set<std::int32_t> faces{index(point.face)};
  if (const int corner = corner_of(point); corner >= 0) {
    const std::int32_t first = mesh.outgoing(mesh.faces()[index(point.face)][corner]);
    std::int32_t h = first;
    do {
      faces.insert(h / 3);
      h = mesh.rotate(h);
    } while (h >= 0 && h != first);
  } else if (const int side = side_of(point); side >= 0) {
    const std::int32_t twin = mesh.twin(3 * index(point.face) + side);
    if (twin >= 0) faces.insert(twin / 3);
  }
  return faces;
}

void expect_valid(const TriangleMesh& mesh, const Geodesic& g, const SurfacePoint& from, const SurfacePoint& to) {
  ASSERT_GE(g.path.size(), 2u);
  EXPECT_LT((g.path.front().position - position(mesh, from)).norm(), 1e-14);
  EXPECT_LT((g.path.back().position - position(mesh, to)).norm(), 1e-14);
  double length = 0;
  for (std::size_t i = 0; i < g.path.size(); ++i) {
    EXPECT_LT((g.path[i].position - position(mesh, g.path[i].point)).norm(), 1e-12);
    if (i == 0) continue;
    length += (g.path[i].position - g.path[i - 1].position).norm();
    const auto here = faces_of(mesh, g.path[i].point);
    bool shared = false;
    for (const std::int32_t f : faces_of(mesh, g.path[i - 1].point)) shared = shared || here.count(f);
    EXPECT_TRUE(shared) << "points " << i - 1 << " and " << i << " lie in no common face";
  }
  EXPECT_NEAR(length, g.distance, 1e-11 * g.distance);
}

TEST(GeodesicPath, StaysOnTheSurfaceAndHasTheDistanceAsItsLength) {
  for (const auto& mesh :
       {share(testing::icosphere(3)), share(testing::genus3()), share(testing::saddle(16)), share(testing::l_shape(5)),
        share(testing::sliver_sphere()), share(testing::bumpy_cube(12)), share(testing::flat_grid(6, 6)),
        share(testing::slit_annulus()), share(testing::cone(12, 8.0, 3)), share(testing::needle_cylinder())}) {
    const GeodesicSolver solver(mesh);
    RandomStream stream("path", 11);
    for (int i = 0; i < 90; ++i) {
      const auto draw = [&](int kind) {
        return kind == 0   ? testing::random_point(*mesh, stream)
               : kind == 1 ? testing::random_edge_point(*mesh, stream)
                           : testing::random_vertex_point(*mesh, stream);
      };
      const SurfacePoint a = draw(i % 3);
      const SurfacePoint b = draw(i / 3 % 3);
      const Geodesic g = solver.geodesic(a, b, {.path = true});
      if (g.distance < 1e-9) continue;
      expect_valid(*mesh, g, a, b);
      if (i % 10 == 0) {
        const GeodesicField field = solver.field({&a, 1}, {.keep_windows = true});
        expect_valid(*mesh, field.geodesic(b, {.path = true}), a, b);
      }
    }
  }
}

TEST(GeodesicPath, IsPinnedOnlyWhereBothSidesMeasureAtLeastPi) {
  const auto mesh = share(testing::bumpy_cube(12, 4, 0.08));
  const GeodesicSolver solver(mesh);
  RandomStream stream("pins", 12);
  int pins = 0;
  for (int i = 0; i < 150; ++i) {
    const SurfacePoint a = testing::random_point(*mesh, stream);
    const SurfacePoint b = testing::random_point(*mesh, stream);
    const Geodesic g = solver.geodesic(a, b, {.path = true});
    std::size_t seen = 0;
    for (const PathPoint& p : g.path) {
      if (seen < g.pinned_at.size() && p.vertex == g.pinned_at[seen]) ++seen;
    }
    EXPECT_EQ(seen, g.pinned_at.size()) << "the path does not show its pins in order";
    for (const VertexId v : g.pinned_at) EXPECT_GT(mesh->vertex_angle(index(v)), 2 * 3.14159265358979 - 1e-9);
    pins += static_cast<int>(g.pinned_at.size());
  }
  EXPECT_GT(pins, 50);
}

TEST(GeodesicPath, IsNotUniqueAcrossTheCutLocus) {
  const auto cube = share(testing::cube(2));
  const GeodesicSolver solver(cube);
  const auto vertex = [&](const Vector3d& place) {
    for (std::int32_t v = 0; v < cube->vertex_count(); ++v) {
      if ((cube->positions()[v] - place).norm() < 1e-12) return vertex_point(*cube, VertexId(v));
    }
    throw std::runtime_error("no such vertex");
  };
  const Geodesic opposite = solver.geodesic(vertex({0.5, 0.5, 0}), vertex({0.5, 0.5, 1}));
  EXPECT_FALSE(opposite.unique);
  EXPECT_NEAR(opposite.competing_excess, 0, 1e-12);
  const Geodesic neighbour = solver.geodesic(vertex({0.5, 0.5, 0}), vertex({0.5, 0, 0.5}));
  EXPECT_TRUE(neighbour.unique);
  const Geodesic diagonal = solver.geodesic(vertex({0, 0, 0}), vertex({1, 1, 1}));
  EXPECT_FALSE(diagonal.unique);

  // A target just off the middle of the far side: the competitor's excess grows with its distance from the cut locus.
  const GeodesicSolver fine(share(testing::cube(3)));
  const TriangleMesh& mesh = fine.mesh();
  RandomStream stream("cut", 13);
  int near = 0;
  for (int i = 0; i < 2000; ++i) {
    const SurfacePoint a = testing::random_point(mesh, stream);
    const SurfacePoint b = testing::random_point(mesh, stream);
    const Geodesic g = fine.geodesic(a, b);
    EXPECT_GE(g.competing_excess, 0);
    near += g.competing_excess < 0.05;
    EXPECT_TRUE(g.unique);
  }
  EXPECT_GT(near, 10);
}

TEST(GeodesicPath, OnAFlatGridIsUniqueThoughItPassesThroughVertices) {
  const auto mesh = share(testing::flat_grid(6, 6));
  const GeodesicSolver solver(mesh);
  for (std::int32_t a = 0; a < mesh->vertex_count(); a += 3) {
    for (std::int32_t b = a + 1; b < mesh->vertex_count(); b += 5) {
      const Geodesic g = solver.geodesic(vertex_point(*mesh, VertexId(a)), vertex_point(*mesh, VertexId(b)));
      EXPECT_TRUE(g.unique) << a << " " << b;
    }
  }
}

}  // namespace
}  // namespace supple::surface
