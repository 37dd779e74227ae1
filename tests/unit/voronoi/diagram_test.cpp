#include "supple/voronoi/diagram.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "supple/surface/moving_points.h"
#include "supple/surface/vertex_cone.h"
#include "support/cgal_geodesics.h"
#include "support/expect_error.h"
#include "support/sampling.h"
#include "support/shapes.h"
#include "support/valid_diagram.h"

namespace supple::voronoi {
namespace {

using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

using testing::area_of;

std::vector<SurfacePoint> drawn_sites(const TriangleMesh& mesh, int count, std::uint64_t seed) {
  return random_sites(mesh, count, seed);
}

/// Checks what every diagram has: areas that sum up to that of the mesh, borders that close, vertices of three or more
/// sites, and points that are equally far from their sites and no nearer to others. Distances come from a separate
/// search for each site.
void expect_valid(const TriangleMesh& mesh, const Diagram& diagram, double tolerance) {
  const GeodesicSolver solver(testing::share(mesh));
  std::vector<surface::GeodesicField> fields;
  for (const SurfacePoint& site : diagram.sites) fields.push_back(solver.field({&site, 1}, {.keep_windows = true}));
  double area = diagram.unreached_area;
  for (const DiagramCell& cell : diagram.cells) area += cell.area;
  EXPECT_NEAR(area, area_of(mesh), 1e-11 * area_of(mesh));

  const auto expect_at = [&](const DiagramPoint& point, std::int32_t site) {
    EXPECT_NEAR(fields[static_cast<std::size_t>(site)].distance(point.point), point.distance, tolerance)
        << "site " << site << " at " << point.position.transpose() << " kind " << static_cast<int>(point.kind);
  };
  const auto expect_nearest = [&](const DiagramPoint& point) {
    for (const auto& field : fields) EXPECT_GE(field.distance(point.point), point.distance - tolerance);
  };
  for (const DiagramPoint& point : diagram.points) expect_nearest(point);
  for (const DiagramVertex& vertex : diagram.vertices) {
    EXPECT_GE(vertex.sites.size(), 3U);
    for (const std::int32_t site : vertex.sites)
      expect_at(diagram.points[static_cast<std::size_t>(vertex.point)], site);
  }
  std::map<std::int32_t, int> ends;
  for (const DiagramEdge& edge : diagram.edges) {
    EXPECT_NE(edge.sites[0], edge.sites[1]);
    for (const std::int32_t point : edge.points)
      for (const std::int32_t site : edge.sites) expect_at(diagram.points[static_cast<std::size_t>(point)], site);
    for (const std::int32_t vertex : edge.vertices)
      if (vertex >= 0) ++ends[vertex];
  }
  for (std::size_t i = 0; i < diagram.vertices.size(); ++i)
    EXPECT_EQ(ends[static_cast<std::int32_t>(i)], static_cast<int>(diagram.vertices[i].sites.size()));
  // A border has a cell on either side: the relation of neighbours is symmetric.
  for (std::size_t i = 0; i < diagram.cells.size(); ++i)
    for (const std::int32_t other : diagram.cells[i].neighbours) {
      const auto& back = diagram.cells[static_cast<std::size_t>(other)].neighbours;
      EXPECT_TRUE(std::binary_search(back.begin(), back.end(), static_cast<std::int32_t>(i)));
    }
  // The pieces cover the cut faces.
  std::map<std::int32_t, double> covered;
  for (const DiagramPiece& piece : diagram.pieces) {
    const auto corner = [&](int i) {
      const auto& b = diagram.corners[static_cast<std::size_t>(piece.first_corner + i)];
      return Eigen::Vector2d(b[1], b[2]);
    };
    for (int i = 2; i < piece.corner_count; ++i) {
      const Eigen::Vector2d a = corner(i - 1) - corner(0);
      const Eigen::Vector2d b = corner(i) - corner(0);
      covered[piece.face] += a.x() * b.y() - a.y() * b.x();
    }
  }
  for (const auto& [face, fraction] : covered) {
    EXPECT_EQ(diagram.face_sites[static_cast<std::size_t>(face)], -1);
    EXPECT_NEAR(fraction, 1, 1e-9) << "face " << face;
  }
}

/// Euler characteristic of the surface by its cells, if these are discs, as with many sites.
int characteristic(const Diagram& diagram) {
  return static_cast<int>(diagram.vertices.size()) - static_cast<int>(diagram.edges.size()) +
         static_cast<int>(diagram.cells.size());
}

Diagram made(const TriangleMesh& mesh, const std::vector<SurfacePoint>& sites, const DiagramOptions& options = {}) {
  return diagram(GeodesicSolver(testing::share(mesh)), sites, options);
}

TEST(Diagram, OfASphereIsValid) {
  const TriangleMesh mesh = testing::icosphere(3);
  const Diagram result = made(mesh, drawn_sites(mesh, 40, 1));
  expect_valid(mesh, result, 1e-10);
  EXPECT_EQ(characteristic(result), 2);
  EXPECT_EQ(result.dual.size(), 76U);
}

TEST(Diagram, OfAHandleIsValid) {
  const TriangleMesh mesh = testing::torus(24, 12);
  const Diagram result = made(mesh, drawn_sites(mesh, 60, 2));
  expect_valid(mesh, result, 1e-10);
  EXPECT_EQ(characteristic(result), 0);
}

TEST(Diagram, OfMoreSitesThanFacesIsValid) {
  const TriangleMesh mesh = testing::icosphere(1);
  const Diagram result = made(mesh, drawn_sites(mesh, 300, 3));
  expect_valid(mesh, result, 1e-10);
  EXPECT_EQ(characteristic(result), 2);
}

TEST(Diagram, WithBoundaryIsValid) {
  for (const TriangleMesh& mesh :
       {testing::open_hemisphere(), testing::l_shape(4), testing::slit_annulus(), testing::saddle(6)}) {
    const Diagram result = made(mesh, drawn_sites(mesh, 20, 4));
    expect_valid(mesh, result, 1e-10);
  }
}

TEST(Diagram, OfOneSiteIsOneCell) {
  const TriangleMesh mesh = testing::icosphere(2);
  const Diagram result = made(mesh, drawn_sites(mesh, 1, 5));
  EXPECT_TRUE(result.points.empty());
  EXPECT_NEAR(result.cells[0].area, area_of(mesh), 1e-12);
}

TEST(Diagram, OfFewSitesIsValid) {
  for (int count = 2; count <= 5; ++count) {
    const TriangleMesh mesh = testing::genus3(2);
    expect_valid(mesh, made(mesh, drawn_sites(mesh, count, 6)), 1e-10);
  }
}

TEST(Diagram, HasItsSitesOnVertices) {
  const TriangleMesh mesh = testing::icosphere(2);
  std::vector<SurfacePoint> sites;
  for (int v = 0; v < mesh.vertex_count(); ++v) sites.push_back(vertex_point(mesh, VertexId(v)));
  const Diagram result = made(mesh, sites);
  expect_valid(mesh, result, 1e-10);
  EXPECT_EQ(characteristic(result), 2);
}

TEST(Diagram, HasItsSitesOnEdges) {
  const TriangleMesh mesh = testing::torus(16, 8);
  RandomStream random("voronoi", 7);
  std::vector<SurfacePoint> sites;
  for (int i = 0; i < 50; ++i) sites.push_back(testing::random_edge_point(mesh, random));
  expect_valid(mesh, made(mesh, sites), 1e-10);
}

TEST(Diagram, OfFourSitesAtOneDistanceHasAVertexOfFour) {
  const TriangleMesh mesh = testing::flat_grid(8, 8);
  std::vector<SurfacePoint> sites;
  for (const int v : {2 * 9 + 2, 2 * 9 + 6, 6 * 9 + 2, 6 * 9 + 6}) sites.push_back(vertex_point(mesh, VertexId(v)));
  const Diagram result = made(mesh, sites);
  expect_valid(mesh, result, 1e-10);
  ASSERT_EQ(result.vertices.size(), 1U);
  EXPECT_EQ(result.vertices[0].sites.size(), 4U);
  EXPECT_EQ(result.dual.size(), 2U);
  for (const DiagramCell& cell : result.cells) EXPECT_NEAR(cell.area, 16, 1e-12);
}

TEST(Diagram, OfNearlyCoincidentSitesIsValid) {
  const TriangleMesh mesh = testing::icosphere(2);
  for (const double gap : {1e-3, 1e-6, 1e-9, 1e-11}) {
    std::vector<SurfacePoint> sites = drawn_sites(mesh, 12, 8);
    SurfacePoint near = sites[3];
    near.barycentric += Eigen::Vector3d(gap, -gap, 0);
    sites.push_back(near);
    const Diagram result = made(mesh, sites);
    expect_valid(mesh, result, 1e-10);
    EXPECT_GT(result.cells[3].area, 0);
    EXPECT_GT(result.cells[12].area, 0);
  }
}

TEST(Diagram, OfCoincidentSitesGivesTheFirstTheCell) {
  const TriangleMesh mesh = testing::icosphere(2);
  std::vector<SurfacePoint> sites = drawn_sites(mesh, 12, 9);
  sites.insert(sites.begin() + 5, sites[2]);
  const Diagram result = made(mesh, sites);
  EXPECT_EQ(result.cells[5].area, 0);
  EXPECT_TRUE(result.cells[5].boundary.empty());
  EXPECT_EQ(result.warnings.size(), 1U);
  std::set<std::int32_t> used;
  for (const DiagramEdge& edge : result.edges) used.insert(edge.sites.begin(), edge.sites.end());
  EXPECT_EQ(used.size(), 12U);
  EXPECT_EQ(used.count(5), 0U);
  double area = 0;
  for (const DiagramCell& cell : result.cells) area += cell.area;
  EXPECT_NEAR(area, area_of(mesh), 1e-11);
}

TEST(Diagram, NamesTheSiteThatIsNoPoint) {
  const TriangleMesh mesh = testing::icosphere(1);
  std::vector<SurfacePoint> sites = drawn_sites(mesh, 3, 1);
  sites[2].face = FaceId(1000);
  const auto error = testing::expect_error("point.face_out_of_range", [&] { made(mesh, sites); });
  ASSERT_FALSE(error.details().empty());
  EXPECT_EQ(error.details()[0].where, "sites/2/face");
  testing::expect_error("voronoi.no_sites", [&] { made(mesh, {}); });
  testing::expect_error("voronoi.too_many_sites", [&] { random_sites(mesh, 10'000'000); });
}

// The diagram computes distance gradients in its propagation. Here each is compared with a geodesic of its own.
TEST(Diagram, KnowsHowDistancesAtVerticesChange) {
  for (const auto& [mesh, count] : {std::pair(testing::icosphere(2), 25),
                                    {testing::torus(20, 10), 40},
                                    {testing::genus3(2), 60},
                                    {testing::saddle(6), 20},
                                    {testing::slit_annulus(), 15}}) {
    const GeodesicSolver solver(testing::share(mesh));
    std::vector<SurfacePoint> sites = random_sites(mesh, count, 5);
    sites[0].barycentric = {0.3, 0, 0.7};
    sites[1].barycentric = {0, 0, 1};
    const Diagram found = diagram(solver, sites, {.vertex_gradients = true});
    const surface::MovingPoints points(mesh, found.sites);
    std::size_t next = 0;
    int known = 0;
    for (const DiagramVertex& vertex : found.vertices) {
      const SurfacePoint& place = found.points[static_cast<std::size_t>(vertex.point)].point;
      for (const std::int32_t site : vertex.sites) {
        const SiteDistanceGradient& pull = found.vertex_gradients[next++];
        if (pull.site < 0) continue;
        ++known;
        EXPECT_EQ(pull.site, site);
        const auto number = static_cast<std::size_t>(site);
        const surface::Geodesic path = solver.geodesic(place, found.sites[number], {.derivatives = 1, .path = true});
        EXPECT_NEAR(pull.distance, path.distance, 1e-12 * mesh.diagonal());
        ASSERT_TRUE(path.derivatives);
        EXPECT_LE((pull.by_place - path.derivatives->tangent_gradient.head<2>()).norm(), 1e-8);
        Eigen::Vector2d by_site = path.derivatives->tangent_gradient.tail<2>();
        if (points.on_tip(number)) {
          const surface::VertexCone cone(mesh, points.vertex_of(mesh, number));
          by_site = -surface::cone_coordinates(cone, cone.angle_to(path.path[path.path.size() - 2].point));
        }
        EXPECT_LE((pull.by_site - by_site).norm(), 1e-8) << "site " << site << ", " << mesh.face_count() << " faces";
      }
    }
    EXPECT_EQ(next, found.vertex_gradients.size());
    EXPECT_GT(known, 10);
  }
}

}  // namespace
}  // namespace supple::voronoi
