// Integrals of squared distances over polygons, over the regions of several images, and over the cells of whole
// diagrams.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "planar_face.h"
#include "polygon_integrals.h"
#include "straight_regions.h"
#include "supple/base/random.h"
#include "supple/surface/moving_points.h"
#include "supple/surface/retraction.h"
#include "supple/surface/vertex_cone.h"
#include "supple/voronoi/diagram.h"
#include "support/shapes.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// The integral of a function over a triangle: it is divided into n^2 equal triangles, each integrated by the midpoints
/// of its sides.
template <typename Function>
auto by_midpoints(const Vector2d& a, const Vector2d& b, const Vector2d& c, int n, const Function& function) {
  const Vector2d u = (b - a) / n;
  const Vector2d v = (c - a) / n;
  const double weight = std::abs(u.x() * v.y() - u.y() * v.x()) / 6;
  decltype(function(a)) sum = 0 * function(a);
  for (int i = 0; i < n; ++i) {
    for (int j = 0; i + j < n; ++j) {
      const Vector2d corner = a + i * u + j * v;
      sum += weight * (function(corner + 0.5 * u) + function(corner + 0.5 * v) + function(corner + 0.5 * (u + v)));
      if (i + j + 1 == n) continue;
      const Vector2d far = corner + u + v;
      sum += weight * (function(far - 0.5 * u) + function(far - 0.5 * v) + function(far - 0.5 * (u + v)));
    }
  }
  return sum;
}

TEST(PolygonIntegrals, AreThoseOfManySmallTriangles) {
  const Polygon triangle{{0.1, 0.2}, {1.3, 0.1}, {0.5, 1.4}};
  for (const Vector2d& centre :
       {Vector2d(0.5, 0.5), Vector2d(-2, 1), triangle[0], Vector2d(0.7, 0.15), Vector2d(3, 3)}) {
    const PolygonIntegrals found = polygon_integrals(triangle, centre);
    const auto sum = [&](const auto& function) {
      return by_midpoints(triangle[0], triangle[1], triangle[2], 400, function);
    };
    EXPECT_NEAR(found.area, sum([](const Vector2d&) { return 1.0; }), 1e-11);
    EXPECT_NEAR(found.length, sum([&](const Vector2d& x) { return (x - centre).norm(); }), 1e-6);
    EXPECT_NEAR(found.square, sum([&](const Vector2d& x) { return (x - centre).squaredNorm(); }), 1e-10);
    EXPECT_NEAR(found.offset.x(), sum([&](const Vector2d& x) { return (x - centre).x(); }), 1e-10);
    EXPECT_NEAR(found.offset.y(), sum([&](const Vector2d& x) { return (x - centre).y(); }), 1e-10);
  }
}

TEST(PolygonIntegrals, OfAWayThatTurnsFasterAreThoseOfManySmallTriangles) {
  const Polygon triangle{{0.1, 0.2}, {1.3, 0.1}, {0.5, 1.4}};
  const Vector2d zero = Vector2d(1, 0.4).normalized();
  for (const Vector2d& centre : {Vector2d(-2, 1), triangle[0], Vector2d(-0.2, 0.1)}) {
    SCOPED_TRACE("centre " + std::to_string(centre.x()));
    // With the stretch 1 the integral is that of x - centre, rotated.
    const Vector2d offset = polygon_integrals(triangle, centre).offset;
    const Vector2d turned = Eigen::Rotation2Dd(0.3 - std::atan2(zero.y(), zero.x())) * offset;
    EXPECT_LE((stretched_offset(triangle, centre, zero, 0.3, 1) - turned).norm(), 1e-9);
    for (const double stretch : {0.7, 1.3}) {
      const Vector2d found = stretched_offset(triangle, centre, zero, 0.3, stretch);
      const auto sum = [&](int part) {
        return by_midpoints(triangle[0], triangle[1], triangle[2], 400, [&](const Vector2d& x) {
          const Vector2d to = x - centre;
          const double at = 0.3 + stretch * std::atan2(zero.x() * to.y() - zero.y() * to.x(), zero.dot(to));
          return to.norm() * (part == 0 ? std::cos(at) : std::sin(at));
        });
      };
      EXPECT_NEAR(found.x(), sum(0), 1e-5);
      EXPECT_NEAR(found.y(), sum(1), 1e-5);
    }
  }
}

TEST(PolygonIntegrals, ClippedPolygonsAreWhatLiesOnOneSideOfALine) {
  const Polygon square{{0, 0}, {1, 0}, {1, 1}, {0, 1}};
  Polygon clipped;
  clip(square, Vector2d(1, 0), 0.25, clipped);
  EXPECT_NEAR(polygon_integrals(clipped, {0, 0}).area, 0.25, 1e-15);
  clip(square, Vector2d(-1, 0), -0.25, clipped);
  EXPECT_NEAR(polygon_integrals(clipped, {0, 0}).area, 0.75, 1e-15);
  clip(square, Vector2d(1, 0), 2, clipped);
  EXPECT_EQ(clipped.size(), 4U);
  clip(square, Vector2d(1, 0), -1, clipped);
  EXPECT_TRUE(clipped.empty());
}

/// The integral of the squared distance over a triangle, by its regions and by many small triangles.
std::pair<double, double> squares(const std::vector<surface::FaceArrival>& arrivals, int n) {
  const CancellationToken never;
  FaceDistances distances(never);
  distances.arrivals() = arrivals;
  Active active;
  distances.all(active);
  const Polygon triangle{{0, 0}, {1, 0}, {0.4, 0.9}};
  double found = 0;
  double area = 0;
  const auto squared = [](double length) { return length * length; };
  StraightRegions regions(distances, 1, [&](const StraightRegion& region) {
    const surface::FaceArrival& from = arrivals[static_cast<std::size_t>(region.arrival)];
    const PolygonIntegrals integrals = polygon_integrals(region.corners, from.image);
    EXPECT_GE(integrals.area, -1e-12);
    area += integrals.area;
    found += integrals.square + 2 * from.sigma * integrals.length + from.sigma * from.sigma * integrals.area;
  });
  regions.divide(triangle, active);
  EXPECT_NEAR(area, 0.45, 1e-12);
  for (const Sliver& sliver : regions.slivers())
    found += sliver.area * (squared(arrivals[static_cast<std::size_t>(sliver.gains)].length_to(sliver.place)) -
                            squared(arrivals[static_cast<std::size_t>(sliver.loses)].length_to(sliver.place)));
  const double wanted = by_midpoints(triangle[0], triangle[1], triangle[2], n,
                                     [&](const Vector2d& x) { return squared(distances.nearest(active, x).distance); });
  return {found, wanted};
}

TEST(StraightRegions, OfImagesThatAreEquallyFarFromTheSiteAreExact) {
  const auto [found, wanted] =
      squares({{.image = Vector2d(-0.5, 1.2)}, {.image = Vector2d(1.4, 1)}, {.image = Vector2d(0.5, -0.7)}}, 1000);
  EXPECT_NEAR(found, wanted, 1e-6);
}

TEST(StraightRegions, OfManyCrossingBundlesCoverThePolygonAndAreBoundedInNumber) {
  RandomStream random("bundles", 1);
  std::vector<surface::FaceArrival> arrivals;
  for (int i = 0; i < 250; ++i) {
    const Vector2d image(random.uniform() - 0.5, -1 - 0.5 * random.uniform());
    const double end = random.uniform();
    arrivals.push_back(
        {.image = image, .begin = {end - 0.3, 0}, .end = {end, 0}, .sigma = 2 - image.norm(), .everywhere = false});
  }
  const CancellationToken never;
  FaceDistances distances(never);
  distances.arrivals() = arrivals;
  Active active;
  distances.all(active);
  const Polygon triangle{{0, 0}, {1, 0}, {0.4, 0.9}};
  std::size_t count = 0;
  double area = 0;
  StraightRegions regions(distances, 1, [&](const StraightRegion& region) {
    ++count;
    area += polygon_integrals(region.corners, {0, 0}).area;
  });
  regions.divide(triangle, active);
  EXPECT_NEAR(area, 0.45, 1e-9);
  EXPECT_LT(count, 100'000U);
}

TEST(StraightRegions, OfABundleEndWhereItsPathsEnd) {
  // Beyond the ends of the bundle, paths from the image turn at these ends.
  const Vector2d image(0.3, -0.5);
  const Vector2d begin(0.2, 0);
  const Vector2d end(0.6, 0);
  const auto [found, wanted] = squares({{.image = image, .begin = begin, .end = end, .everywhere = false},
                                        {.image = begin, .sigma = (begin - image).norm()},
                                        {.image = end, .sigma = (end - image).norm()}},
                                       1000);
  EXPECT_NEAR(found, wanted, 1e-6);
}

TEST(StraightRegions, AgreeWithManySmallTrianglesForRandomImages) {
  RandomStream random("straight_regions", 1);
  for (int scene = 0; scene < 200; ++scene) {
    SCOPED_TRACE("scene " + std::to_string(scene));
    std::vector<surface::FaceArrival> arrivals;
    const int count = 2 + static_cast<int>(random.below(4));
    for (int i = 0; i < count; ++i) {
      const double angle = random.uniform(0, 6.283185307179586);
      arrivals.push_back(
          {.image = Vector2d(0.5, 0.3) + random.uniform(0.8, 1.5) * Vector2d(std::cos(angle), std::sin(angle)),
           .sigma = random.uniform() < 0.3 ? 0 : random.uniform(0, 0.3)});
    }
    const auto [found, wanted] = squares(arrivals, 200);
    EXPECT_NEAR(found, wanted, 1e-5 * wanted);
  }
}

/// The integral of the squared distance over the whole surface, by a field of all sites and small triangles.
double by_field(const TriangleMesh& mesh, const GeodesicSolver& solver, const std::vector<SurfacePoint>& sites, int n) {
  const surface::GeodesicField field = solver.field(sites, {.keep_windows = true});
  double sum = 0;
  for (std::int32_t face = 0; face < mesh.face_count(); ++face) {
    const auto corners = planar_corners(mesh, face);
    sum += by_midpoints(corners[0], corners[1], corners[2], n, [&](const Vector2d& x) {
      const double distance = field.distance({FaceId(face), barycentric(corners, x)});
      return distance * distance;
    });
  }
  return sum;
}

TEST(CellMoments, AreTheIntegralsOfTheSquaredDistance) {
  for (const auto& [mesh, count] : {std::pair(testing::icosphere(1), 5),
                                    {testing::torus(12, 6), 4},
                                    {testing::genus3(1), 3},
                                    {testing::l_shape(3), 2},
                                    {testing::slit_annulus(), 3}}) {
    const GeodesicSolver solver(testing::share(mesh));
    const std::vector<SurfacePoint> sites = random_sites(mesh, count, 1);
    const Diagram found = diagram(solver, sites, {.cell_moments = true});
    ASSERT_EQ(found.cell_moments.size(), sites.size());
    double sum = 0;
    for (const CellMoments& cell : found.cell_moments) sum += cell.squared_distance;
    const double wanted = by_field(mesh, solver, sites, 40);
    EXPECT_NEAR(sum, wanted, 2e-6 * wanted) << mesh.face_count() << " faces";
  }
}

double half_of_squares(const GeodesicSolver& solver, const std::vector<SurfacePoint>& sites) {
  double sum = 0;
  for (const CellMoments& cell : diagram(solver, sites, {.cell_moments = true}).cell_moments)
    sum += 0.5 * cell.squared_distance;
  return sum;
}

/// Moves each site along both of its tangent coordinates, and compares central differences with the gradients in
/// `gradient`.
void expect_gradients(const TriangleMesh& mesh, const std::vector<SurfacePoint>& sites, double tolerance) {
  const GeodesicSolver solver(testing::share(mesh));
  const Diagram found = diagram(solver, sites, {.cell_moments = true});
  const double step = 1e-5;
  double scale = 0;
  for (const CellMoments& cell : found.cell_moments) scale = std::max(scale, cell.gradient.norm());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    for (int k = 0; k < 2; ++k) {
      const auto value = [&](double displacement) {
        surface::MovingPoints moved(mesh, sites);
        Eigen::VectorXd all = Eigen::VectorXd::Zero(moved.dimension());
        all[2 * static_cast<Eigen::Index>(i) + k] = displacement;
        moved.move(mesh, all);
        return half_of_squares(solver, moved.points());
      };
      EXPECT_NEAR(found.cell_moments[i].gradient[k], (value(step) - value(-step)) / (2 * step), tolerance * scale)
          << "site " << i << ", coordinate " << k << ", " << mesh.face_count() << " faces";
    }
  }
}

TEST(CellMoments, HaveTheirDerivativesOnCoarseMeshes) {
  for (const auto& [mesh, count] : {std::pair(testing::icosphere(1), 5),
                                    {testing::torus(12, 6), 20},
                                    {testing::l_shape(3), 2},
                                    {testing::slit_annulus(), 3}})
    expect_gradients(mesh, random_sites(mesh, count, 2), 1e-5);
}

TEST(CellMoments, HaveTheirDerivativesBySitesOnEdges) {
  const TriangleMesh mesh = testing::torus(12, 6);
  std::vector<SurfacePoint> sites = random_sites(mesh, 20, 3);
  sites[1].barycentric = {0.4, 0, 0.6};
  expect_gradients(mesh, sites, 1e-5);
}

TEST(CellMoments, OfASiteOnAVertexPullAlongTheWaysFromIt) {
  // On the tip of a cone only directional derivatives exist. There `gradient` is minus the integral of the distance
  // times the direction in which the path leaves the site, in cone_coordinates.
  for (const TriangleMesh& mesh : {testing::icosphere(1), testing::torus(12, 6), testing::l_shape(3)}) {
    std::vector<SurfacePoint> sites = random_sites(mesh, 4, 4);
    sites[2].barycentric = {0, 1, 0};
    const GeodesicSolver solver(testing::share(mesh));
    const Diagram found = diagram(solver, sites, {.cell_moments = true});
    const surface::MovingPoints points(mesh, sites);
    ASSERT_TRUE(points.on_tip(2));
    // The same integral by sample points, each with a geodesic of its own.
    Vector2d wanted = Vector2d::Zero();
    const surface::GeodesicField field = solver.field(sites, {.keep_windows = true});
    const surface::VertexCone cone(mesh, points.vertex_of(mesh, 2));
    double weights = 0;
    for (std::int32_t face = 0; face < mesh.face_count(); ++face) {
      const auto corners = planar_corners(mesh, face);
      wanted += by_midpoints(corners[0], corners[1], corners[2], 16, [&](const Vector2d& x) -> Vector2d {
        const surface::Geodesic path = field.geodesic({FaceId(face), barycentric(corners, x)}, {.path = true});
        if (field.nearest_source({FaceId(face), barycentric(corners, x)}) != 2) return Vector2d::Zero();
        const double angle = path.path.size() < 2 ? std::nan("") : cone.angle_to(path.path[1].point);
        if (!std::isfinite(angle)) return Vector2d::Zero();
        weights += 1;
        return -path.distance * surface::cone_coordinates(cone, angle);
      });
    }
    EXPECT_GT(weights, 100);
    EXPECT_LT((found.cell_moments[2].gradient - wanted).norm(), 0.03 * wanted.norm()) << mesh.face_count();
  }
}

}  // namespace
}  // namespace supple::voronoi
