// Meshes that break geodesic codes. Each case says what is hard about it.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>

#include "supple/surface/exponential_map.h"
#include "supple/surface/geodesic_solver.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using Eigen::Vector3d;
using testing::share;

TriangleMesh transformed(const TriangleMesh& mesh, double scale, const Vector3d& shift) {
  auto positions = mesh.positions();
  for (Vector3d& p : positions) p = scale * p + shift;
  return TriangleMesh::build(std::move(positions), mesh.faces());
}

/// A flat fan of n needles around a vertex in the middle, of radius 1.
TriangleMesh wheel(int n) {
  std::vector<Vector3d> positions{{0, 0, 0}};
  std::vector<Triangle> faces;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * i / n;
    positions.emplace_back(std::cos(angle), std::sin(angle), 0);
    faces.push_back({0, 1 + i, 1 + (i + 1) % n});
  }
  return TriangleMesh::build(std::move(positions), std::move(faces));
}

/// A flat strip of 2 n faces whose lower corners are as flat as 180 degrees less `sliver` radians.
TriangleMesh obtuse_strip(int n, double sliver) {
  std::vector<Vector3d> positions;
  std::vector<Triangle> faces;
  for (int i = 0; i <= n; ++i) {
    positions.emplace_back(i, 0, 0);
    positions.emplace_back(i + 0.5, sliver, 0);
  }
  for (int i = 0; i < n; ++i) {
    faces.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    faces.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
  }
  return TriangleMesh::build(std::move(positions), std::move(faces));
}

void expect_metric(const TriangleMesh& mesh, double tolerance, int pairs) {
  const GeodesicSolver solver(std::make_shared<const TriangleMesh>(mesh));
  RandomStream stream("hard_mesh", 1);
  for (int i = 0; i < pairs; ++i) {
    const SurfacePoint a = testing::random_point(mesh, stream);
    const SurfacePoint b = testing::random_point(mesh, stream);
    const Geodesic ab = solver.geodesic(a, b, {.derivatives = 2, .path = true});
    EXPECT_NEAR(ab.distance, solver.distance(b, a), tolerance * ab.distance);
    EXPECT_GE(ab.distance, (position(mesh, a) - position(mesh, b)).norm() * (1 - tolerance));
    double length = 0;
    for (std::size_t k = 1; k < ab.path.size(); ++k) length += (ab.path[k].position - ab.path[k - 1].position).norm();
    EXPECT_NEAR(length, ab.distance, tolerance * ab.distance);
    ASSERT_TRUE(ab.derivatives);
    EXPECT_NEAR(ab.derivatives->tangent_gradient.head<2>().norm(), 1, 1e-12);
    EXPECT_NEAR(ab.derivatives->tangent_gradient.tail<2>().norm(), 1, 1e-12);
    EXPECT_TRUE(ab.derivatives->hessian.allFinite());
    const GeodesicField field = solver.field({&a, 1}, {.keep_windows = true});
    EXPECT_NEAR(field.distance(b), ab.distance, tolerance * ab.distance);
  }
}

// Hard: aspect ratio above 1,000; thousands of windows per edge wind round the cylinder. CGAL 5.5 is 5e-5 off here.
TEST(GeodesicHardMesh, ANeedleCylinderHasAMetric) { expect_metric(testing::needle_cylinder(), 1e-11, 20); }

// Hard: pairs of vertices 1e-4 apart make obtuse slivers beside large faces.
TEST(GeodesicHardMesh, ASphereOfSliversHasAMetric) { expect_metric(testing::sliver_sphere(), 1e-11, 40); }

// Hard: corners of 180 degrees less 2e-6, in which rays run almost along edges.
TEST(GeodesicHardMesh, AStripOfObtuseTrianglesIsFlat) {
  const auto mesh = share(obtuse_strip(40, 1e-6));
  const GeodesicSolver solver(mesh);
  RandomStream stream("obtuse", 2);
  for (int i = 0; i < 200; ++i) {
    const SurfacePoint a = testing::random_point(*mesh, stream);
    const SurfacePoint b = testing::random_point(*mesh, stream);
    const double exact = (position(*mesh, a) - position(*mesh, b)).norm();
    EXPECT_NEAR(solver.distance(a, b), exact, 1e-11 * (1 + exact));
  }
}

// Hard: two thousand needles meet in one vertex.
TEST(GeodesicHardMesh, AVertexOfTwoThousandFacesIsPassed) {
  const auto mesh = share(wheel(2000));
  const GeodesicSolver solver(mesh);
  RandomStream stream("wheel", 3);
  for (int i = 0; i < 100; ++i) {
    const SurfacePoint a = testing::random_point(*mesh, stream);
    const SurfacePoint b = testing::random_point(*mesh, stream);
    const double exact = (position(*mesh, a) - position(*mesh, b)).norm();
    EXPECT_NEAR(solver.distance(a, b), exact, 1e-12 * (1 + exact));
  }
}

// Hard: every vertex is flat up to rounding, so that all decisions at vertices are ties.
TEST(GeodesicHardMesh, AGridOfTiesIsFlatAndNothingPinsItsPaths) {
  const auto mesh = share(testing::flat_grid(12, 12));
  const GeodesicSolver solver(mesh);
  for (std::int32_t a = 0; a < mesh->vertex_count(); a += 11) {
    for (std::int32_t b = 0; b < mesh->vertex_count(); b += 7) {
      if (a == b) continue;
      const Geodesic g = solver.geodesic(vertex_point(*mesh, VertexId(a)), vertex_point(*mesh, VertexId(b)));
      EXPECT_NEAR(g.distance, (mesh->positions()[a] - mesh->positions()[b]).norm(), 1e-13 * 20);
      EXPECT_TRUE(g.pinned_at.empty()) << a << " " << b;
    }
  }
}

// Hard: a saddle vertex whose excess is near rounding: its shadow is a billionth of a radian wide.
TEST(GeodesicHardMesh, AVertexThatIsHardlyASaddleDiffersFromAFlatOneByAsLittle) {
  for (const double excess : {1e-6, 1e-9, 1e-12, 0.0, -1e-12, -1e-9, -1e-6}) {
    const auto mesh = share(testing::cone(12, 2 * std::numbers::pi + excess, 3));
    const GeodesicSolver solver(mesh);
    const auto flat = share(testing::cone(12, 2 * std::numbers::pi, 3));
    const GeodesicSolver flat_solver(flat);
    RandomStream stream("hardly", 4);
    for (int i = 0; i < 100; ++i) {
      const SurfacePoint a = testing::random_point(*flat, stream);
      const SurfacePoint b = testing::random_point(*flat, stream);
      EXPECT_NEAR(solver.distance(a, b), flat_solver.distance(a, b), 4 * std::abs(excess) + 1e-13) << excess;
    }
  }
}

// Hard: a cone of a twentieth of a radian; paths wind past its tip.
TEST(GeodesicHardMesh, ASharpConeUnrolls) {
  const double total = 0.05;
  const auto mesh = share(testing::cone(3, total, 8));
  const GeodesicSolver solver(mesh);
  for (std::int32_t a = 1; a < mesh->vertex_count(); ++a) {
    for (std::int32_t b = a + 1; b < mesh->vertex_count(); ++b) {
      const double ra = mesh->positions()[a].norm();
      const double rb = mesh->positions()[b].norm();
      const double d = solver.distance(vertex_point(*mesh, VertexId(a)), vertex_point(*mesh, VertexId(b)));
      bool matches = false;
      for (const double angle : {0.0, total / 3}) {
        const double half = std::sin(angle / 2);
        matches = matches || std::abs(d - std::sqrt((ra - rb) * (ra - rb) + 4 * ra * rb * half * half)) < 1e-13;
      }
      EXPECT_TRUE(matches) << a << " " << b << " " << d;
    }
  }
}

// Hard: coordinates of a micrometre or a thousand kilometres. A scale by a power of two changes no digit.
TEST(GeodesicHardMesh, DistancesScaleWithTheMesh) {
  const TriangleMesh mesh = testing::genus3(3);
  const GeodesicSolver solver(share(mesh));
  for (const double scale : {0x1p-30, 0x1p30}) {
    const GeodesicSolver scaled(share(transformed(mesh, scale, Vector3d::Zero())));
    RandomStream stream("scale", 5);
    for (int i = 0; i < 50; ++i) {
      const SurfacePoint a = testing::random_point(mesh, stream);
      const SurfacePoint b = testing::random_point(mesh, stream);
      EXPECT_EQ(scaled.distance(a, b), scale * solver.distance(a, b));
    }
  }
}

// Hard: a mesh of size 1 a million away from the origin has coordinates of ten digits left.
TEST(GeodesicHardMesh, AMeshFarFromTheOriginLosesOnlyTheDigitsOfItsCoordinates) {
  const TriangleMesh mesh = testing::icosphere(3);
  const GeodesicSolver solver(share(mesh));
  const GeodesicSolver far(share(transformed(mesh, 1, {1e6, -1e6, 1e6})));
  RandomStream stream("far", 6);
  for (int i = 0; i < 50; ++i) {
    const SurfacePoint a = testing::random_point(mesh, stream);
    const SurfacePoint b = testing::random_point(mesh, stream);
    EXPECT_NEAR(far.distance(a, b), solver.distance(a, b), 1e-8);
  }
}

// Hard: nothing lies between the points and the boundary.
TEST(GeodesicHardMesh, ASingleTriangleIsEnough) {
  const auto mesh = share(TriangleMesh::build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}));
  const GeodesicSolver solver(mesh);
  const SurfacePoint a{FaceId(0), {0.5, 0.25, 0.25}};
  for (std::int32_t v = 0; v < 3; ++v) {
    EXPECT_NEAR(solver.distance(a, vertex_point(*mesh, VertexId(v))),
                (mesh->positions()[v] - Vector3d(0.25, 0.25, 0)).norm(), 1e-15);
  }
  EXPECT_NEAR(solver.distance(vertex_point(*mesh, VertexId(1)), vertex_point(*mesh, VertexId(2))), std::sqrt(2.0),
              1e-15);
}

// Hard: the two lips of a slit lie on each other, and only the mesh knows that they are apart.
TEST(GeodesicHardMesh, TheLipsOfASlitAreFarApart) {
  const auto mesh = share(testing::slit_annulus());
  const GeodesicSolver solver(mesh);
  int pairs = 0;
  for (std::int32_t a = 0; a < mesh->vertex_count(); ++a) {
    for (std::int32_t b = a + 1; b < mesh->vertex_count(); ++b) {
      if ((mesh->positions()[a] - mesh->positions()[b]).norm() > 1e-12) continue;
      ++pairs;
      const double d = solver.distance(vertex_point(*mesh, VertexId(a)), vertex_point(*mesh, VertexId(b)));
      // Round the hole of radius 1/2, from radius r and back: at least the inscribed polygon, at most the circle.
      EXPECT_GT(d, 2.9);
      EXPECT_LT(d, 2 * std::numbers::pi);
    }
  }
  EXPECT_GT(pairs, 3);
}

}  // namespace
}  // namespace supple::surface
