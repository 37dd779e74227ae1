// Hard cases of geodesic Voronoi diagrams. Every border is checked with one distance field for each site, and every
// partition by its areas and by the ends of its edges.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "supple/voronoi/diagram.h"
#include "supple/voronoi/optimization.h"
#include "support/sampling.h"
#include "support/shapes.h"
#include "support/valid_diagram.h"

namespace supple::voronoi {
namespace {

using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

constexpr double equidistance = 1e-10;

using testing::area_of;

void expect_partition(const TriangleMesh& mesh, const Diagram& diagram) {
  double area = diagram.unreached_area;
  for (const DiagramCell& cell : diagram.cells) {
    EXPECT_GE(cell.area, 0);
    area += cell.area;
  }
  EXPECT_NEAR(area, area_of(mesh), 1e-10 * area_of(mesh));
  std::map<std::int32_t, std::size_t> ends;
  for (const DiagramEdge& edge : diagram.edges)
    for (const std::int32_t vertex : edge.vertices)
      if (vertex >= 0) ++ends[vertex];
  for (std::size_t v = 0; v < diagram.vertices.size(); ++v) {
    EXPECT_GE(diagram.vertices[v].sites.size(), 3U);
    EXPECT_EQ(ends[static_cast<std::int32_t>(v)], diagram.vertices[v].sites.size());
  }
}

void expect_equidistant(const TriangleMesh& mesh, const Diagram& diagram) {
  const GeodesicSolver solver(testing::share(mesh));
  const double tolerance = equidistance * mesh.diagonal();
  std::map<std::int32_t, surface::GeodesicField> fields;
  const auto field = [&](std::int32_t site) -> const surface::GeodesicField& {
    const auto found = fields.find(site);
    if (found != fields.end()) return found->second;
    return fields
        .emplace(site, solver.field({&diagram.sites[static_cast<std::size_t>(site)], 1}, {.keep_windows = true}))
        .first->second;
  };
  for (const DiagramEdge& edge : diagram.edges) {
    for (const std::int32_t number : edge.points) {
      const DiagramPoint& point = diagram.points[static_cast<std::size_t>(number)];
      for (const std::int32_t site : edge.sites)
        EXPECT_NEAR(field(site).distance(point.point), point.distance, tolerance);
    }
  }
}

Diagram checked(const TriangleMesh& mesh, const std::vector<SurfacePoint>& sites) {
  Diagram result = diagram(GeodesicSolver(testing::share(mesh)), sites);
  expect_partition(mesh, result);
  expect_equidistant(mesh, result);
  return result;
}

TEST(VoronoiHardCases, SitesOnVerticesOfASymmetricMeshTieEverywhere) {
  // Borders run along edges, four cells meet at each vertex, and whole edges are equally near to two sites.
  const TriangleMesh mesh = testing::flat_grid(8, 8);
  std::vector<SurfacePoint> sites;
  for (int y = 1; y < 9; y += 2)
    for (int x = 1; x < 9; x += 2) sites.push_back(vertex_point(mesh, VertexId(9 * y + x)));
  const Diagram result = checked(mesh, sites);
  for (const DiagramCell& cell : result.cells) EXPECT_GT(cell.area, 0.5);
  for (const DiagramVertex& vertex : result.vertices) EXPECT_EQ(vertex.sites.size(), 4U);
  EXPECT_EQ(result.vertices.size(), 9U);
}

TEST(VoronoiHardCases, CubeWithSitesAtItsCornersTies) {
  const TriangleMesh mesh = testing::cube(4);
  std::vector<SurfacePoint> sites;
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    const Eigen::Vector3d& p = mesh.positions()[static_cast<std::size_t>(v)];
    if ((p.array() == 0 || p.array() == 1).all()) sites.push_back(vertex_point(mesh, VertexId(v)));
  }
  ASSERT_EQ(sites.size(), 8U);
  const Diagram result = checked(mesh, sites);
  for (const DiagramCell& cell : result.cells) EXPECT_NEAR(cell.area, 0.75, 1e-10);
}

TEST(VoronoiHardCases, AsManySitesAsVerticesOnAMeshOfSlivers) {
  const TriangleMesh mesh = testing::sliver_sphere(12, 4, 1e-3);
  std::vector<SurfacePoint> sites;
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) sites.push_back(vertex_point(mesh, VertexId(v)));
  checked(mesh, sites);
}

TEST(VoronoiHardCases, RandomSitesOnSliversAndNeedles) {
  const TriangleMesh slivers = testing::sliver_sphere();
  checked(slivers, random_sites(slivers, 40, 1));
  const TriangleMesh needles = testing::needle_cylinder();
  checked(needles, random_sites(needles, 10, 1));
}

TEST(VoronoiHardCases, SurfaceOfGenusThree) {
  const TriangleMesh mesh = testing::genus3(4);
  const Diagram few = checked(mesh, random_sites(mesh, 3, 1));
  const Diagram many = checked(mesh, random_sites(mesh, 300, 1));
  EXPECT_EQ(static_cast<int>(many.vertices.size()) - static_cast<int>(many.edges.size()) + 300, -4);
  EXPECT_FALSE(few.edges.empty());
}

TEST(VoronoiHardCases, TwoSitesOfATorusHaveCellsThatWrapTheHandle) {
  const TriangleMesh mesh = testing::torus(24, 12);
  // The sites are at opposite places of the outer equator.
  std::vector<SurfacePoint> sites(2);
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    const Eigen::Vector3d& p = mesh.positions()[static_cast<std::size_t>(v)];
    if (std::abs(std::abs(p.x()) - 1.4) < 1e-9) sites[p.x() > 0 ? 0 : 1] = vertex_point(mesh, VertexId(v));
  }
  const Diagram result = checked(mesh, sites);
  EXPECT_TRUE(result.vertices.empty());
  EXPECT_EQ(result.edges.size(), 2U);
  for (const DiagramCell& cell : result.cells) {
    EXPECT_EQ(cell.boundary.size(), 2U);
    EXPECT_NEAR(cell.area, 0.5 * area_of(mesh), 1e-6 * area_of(mesh));
  }
}

TEST(VoronoiHardCases, BordersThatRunAlongEdgesAreBordersLikeOthers) {
  const TriangleMesh grid = testing::flat_grid(8, 8);
  std::vector<SurfacePoint> corners;
  for (const int v : {0, 72, 80, 8}) corners.push_back(vertex_point(grid, VertexId(v)));
  const Diagram square = checked(grid, corners);
  EXPECT_EQ(square.vertices.size(), 1U);
  EXPECT_EQ(square.edges.size(), 4U);
  for (const DiagramCell& cell : square.cells) EXPECT_NEAR(cell.area, 16, 1e-10);

  const TriangleMesh sphere = testing::icosphere(3);
  std::int32_t antipode = 0;
  for (std::int32_t v = 0; v < sphere.vertex_count(); ++v)
    if ((sphere.positions()[static_cast<std::size_t>(v)] + sphere.positions()[0]).norm() < 1e-9) antipode = v;
  const Diagram halves = checked(sphere, {vertex_point(sphere, VertexId(0)), vertex_point(sphere, VertexId(antipode))});
  ASSERT_EQ(halves.edges.size(), 1U);
  EXPECT_EQ(halves.edges[0].points.front(), halves.edges[0].points.back());
  EXPECT_NEAR(halves.edges[0].length, 2 * std::numbers::pi, 0.02);
}

TEST(VoronoiHardCases, BoundaryThatPathsBendAround) {
  const TriangleMesh mesh = testing::slit_annulus();
  checked(mesh, random_sites(mesh, 15, 2));
  const TriangleMesh corner = testing::l_shape(6);
  // Regions behind the corner are reached through it only. They are equally near to two sites if the corner lies on the
  // border.
  checked(corner, {vertex_point(corner, VertexId(0)), random_sites(corner, 1, 3)[0]});
}

TEST(VoronoiHardCases, ComponentsWithoutASite) {
  const TriangleMesh one = testing::icosphere(2);
  std::vector<Eigen::Vector3d> positions = one.positions();
  std::vector<surface::Triangle> faces = one.faces();
  const auto count = static_cast<std::int32_t>(positions.size());
  for (std::int32_t v = 0; v < count; ++v)
    positions.push_back(positions[static_cast<std::size_t>(v)] + Eigen::Vector3d(3, 0, 0));
  for (const surface::Triangle& f : one.faces()) faces.push_back({f[0] + count, f[1] + count, f[2] + count});
  const TriangleMesh mesh = TriangleMesh::build(positions, faces);
  std::vector<SurfacePoint> sites = random_sites(one, 5, 1);
  const Diagram result = checked(mesh, sites);
  EXPECT_NEAR(result.unreached_area, area_of(one), 1e-12 * area_of(one));
  EXPECT_EQ(result.warnings.size(), 1U);
}

TEST(VoronoiHardCases, SitesThatMeetAndPartAgain) {
  const TriangleMesh mesh = testing::icosphere(2);
  const SurfacePoint fixed{FaceId(7), {0.3, 0.3, 0.4}};
  std::vector<SurfacePoint> sites = random_sites(mesh, 10, 4);
  sites.push_back(fixed);
  for (const double gap : {1e-2, 1e-5, 1e-8, 1e-10, 1e-12, 0.0, -1e-12, -1e-10, -1e-8, -1e-5, -1e-2}) {
    std::vector<SurfacePoint> moved = sites;
    moved.push_back({fixed.face, fixed.barycentric + Eigen::Vector3d(gap, -gap, 0)});
    const Diagram result = checked(mesh, moved);
    EXPECT_GT(result.cells[10].area, 0) << gap;
    if (gap == 0) {
      EXPECT_EQ(result.cells[11].area, 0);
    } else if (std::abs(gap) >= 1e-10) {
      EXPECT_GT(result.cells[11].area, 0) << gap;
    }
  }
}

TEST(VoronoiHardCases, ManySitesAlmostInOnePlaceEndInTime) {
  // The cells are eight strips all over the sphere, as wide as the distances between the sites. Below 1e-6 only the
  // last digits of distances tell the sites apart. The result must still be a partition.
  const TriangleMesh mesh = testing::icosphere(2);
  for (const double gap : {1e-2, 1e-3, 1e-5, 1e-7, 1e-9}) {
    std::vector<SurfacePoint> sites;
    for (int i = 0; i < 8; ++i) sites.push_back({FaceId(0), {0.3 + gap * i, 0.3, 0.4 - gap * i}});
    const Diagram result = diagram(GeodesicSolver(testing::share(mesh)), sites);
    double area = 0;
    for (const DiagramCell& cell : result.cells) area += cell.area;
    EXPECT_NEAR(area, area_of(mesh), 1e-6) << gap;
    EXPECT_EQ(result.warnings.empty(), gap >= 1e-5) << gap;
    if (gap >= 1e-5) {
      expect_partition(mesh, result);
      expect_equidistant(mesh, result);
    }
  }
}

TEST(VoronoiHardCases, CellThatShrinksBetweenItsNeighbours) {
  // A site in a ring of twelve others: its cell shrinks to 1e-9 of an edge.
  const TriangleMesh mesh = testing::flat_grid(3, 3);
  for (const double radius : {0.3, 1e-3, 1e-6, 1e-9}) {
    std::vector<SurfacePoint> sites{{FaceId(8), {1.0 / 3, 1.0 / 3, 1.0 / 3}}};
    for (int k = 0; k < 12; ++k) {
      const double angle = 2 * std::numbers::pi * k / 12 + 0.1;
      const double b = radius * std::cos(angle);
      const double c = radius * std::sin(angle);
      sites.push_back({FaceId(8), {1.0 / 3 - b - c, 1.0 / 3 + b, 1.0 / 3 + c}});
      if (sites.back().barycentric.minCoeff() < 0) sites.pop_back();
    }
    const Diagram result = checked(mesh, sites);
    EXPECT_GT(result.cells[0].area, 0) << radius;
    EXPECT_LT(result.cells[0].area, radius * radius) << radius;
    EXPECT_GE(result.cells[0].neighbours.size(), 3U);
  }
}

TEST(VoronoiHardCases, DerivativesHoldNextToAChangeOfNeighbours) {
  // Four sites nearly on a circle: the Voronoi edge in the middle is short, and which cells it separates depends on the
  // sign of `offset`.
  const TriangleMesh mesh = testing::flat_grid(4, 4);
  const GeodesicSolver solver(testing::share(mesh));
  const auto at = [&](double x, double y) {
    for (std::int32_t face = 0; face < mesh.face_count(); ++face) {
      Eigen::Matrix3d corners;
      for (int i = 0; i < 3; ++i) {
        const Eigen::Vector3d& p = mesh.positions()[static_cast<std::size_t>(
            mesh.faces()[static_cast<std::size_t>(face)][static_cast<std::size_t>(i)])];
        corners.col(i) << p.x(), p.y(), 1;
      }
      const Eigen::Vector3d b = corners.inverse() * Eigen::Vector3d(x, y, 1);
      if (b.minCoeff() >= -1e-12) return SurfacePoint{FaceId(face), b.cwiseMax(0.0) / b.cwiseMax(0.0).sum()};
    }
    ADD_FAILURE() << x << " " << y;
    return SurfacePoint{};
  };
  for (const double offset : {1e-2, 1e-4, 1e-6, -1e-6, -1e-4, -1e-2}) {
    const std::vector<SurfacePoint> sites{at(1.13, 1.21), at(2.87, 1.21 + offset), at(2.87, 2.79), at(1.13, 2.79)};
    const Diagram result = checked(mesh, sites);
    ASSERT_EQ(result.vertices.size(), 2U) << offset;
    const Eigen::Vector3d a = result.points[static_cast<std::size_t>(result.vertices[0].point)].position;
    const Eigen::Vector3d b = result.points[static_cast<std::size_t>(result.vertices[1].point)].position;
    EXPECT_GT((a - b).norm(), 0);
    EXPECT_LT((a - b).norm(), 20 * std::abs(offset));
    OptimizationOptions options;
    options.weights.equal_area = 1;
    const Optimization found = optimize(solver, sites, options);
    EXPECT_EQ(found.stopped, OptimizationTermination::converged) << offset;
    EXPECT_LT(found.after.area.deviation, 1e-6);
  }
}

TEST(VoronoiHardCases, OptimizationSpreadsSitesOfOneFace) {
  const TriangleMesh mesh = testing::icosphere(2);
  const GeodesicSolver solver(testing::share(mesh));
  std::vector<SurfacePoint> sites;
  for (int i = 0; i < 8; ++i) sites.push_back({FaceId(0), {0.3 + 1e-2 * i, 0.3, 0.4 - 1e-2 * i}});
  OptimizationOptions options;
  options.weights.centroidal = 1;
  options.method = OptimizationMethod::lbfgs;
  options.max_iterations = 60;
  const Optimization found = optimize(solver, sites, options);
  EXPECT_LT(found.energy, 0.5 * found.history.front().energy);
  EXPECT_LT(found.after.area.greatest, 3 * found.after.area.mean);
}

}  // namespace
}  // namespace supple::voronoi
