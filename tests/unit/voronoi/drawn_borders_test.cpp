// The points of borders lie where borders run: at their bends within faces, and along their arcs.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <string>
#include <vector>

#include "supple/base/random.h"
#include "supple/voronoi/diagram.h"
#include "support/expect_error.h"
#include "support/sampling.h"
#include "support/shapes.h"
#include "support/symmetric_shapes.h"
#include "support/valid_diagram.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

Diagram drawn(const TriangleMesh& mesh, const std::vector<SurfacePoint>& sites, const DiagramOptions& options = {}) {
  return diagram(GeodesicSolver(testing::share(mesh)), sites, options);
}

double length_of_lines(const Diagram& diagram) {
  double length = 0;
  for (const DiagramEdge& edge : diagram.edges)
    for (std::size_t i = 1; i < edge.points.size(); ++i)
      length += (diagram.points[static_cast<std::size_t>(edge.points[i])].position -
                 diagram.points[static_cast<std::size_t>(edge.points[i - 1])].position)
                    .norm();
  return length;
}

double length_of_borders(const Diagram& diagram) {
  double length = 0;
  for (const DiagramEdge& edge : diagram.edges) length += edge.length;
  return length;
}

Vector2d corner_of(const Diagram& diagram, const DiagramPiece& piece, int i) {
  const Vector3d& b = diagram.corners[static_cast<std::size_t>(piece.first_corner + i % piece.corner_count)];
  return {b[1], b[2]};
}

/// Whether the piece contains the place, by the number of times that a ray along the first coordinate crosses its
/// sides.
bool contains(const Diagram& diagram, const DiagramPiece& piece, const Vector2d& place) {
  bool inside = false;
  for (int i = 0; i < piece.corner_count; ++i) {
    const Vector2d a = corner_of(diagram, piece, i);
    const Vector2d b = corner_of(diagram, piece, i + 1);
    if ((a.y() > place.y()) == (b.y() > place.y())) continue;
    if (place.x() < a.x() + (place.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x())) inside = !inside;
  }
  return inside;
}

/// Expects random points to lie in the piece of their nearest site. A point close to a border may lie in another piece
/// if the polyline is up to `deviation` off: each of the two distances then differs by no more than that.
void expect_points_in_their_pieces(const TriangleMesh& mesh, const Diagram& diagram, double deviation, int count,
                                   RandomStream& stream) {
  const testing::SiteDistances distances(mesh, diagram.sites);
  int without_piece = 0;
  for (int k = 0; k < count; ++k) {
    const SurfacePoint point = testing::random_point(mesh, stream);
    const std::int32_t face = index(point.face);
    std::int32_t site = diagram.face_sites[static_cast<std::size_t>(face)];
    if (site == -2) continue;
    for (const DiagramPiece& piece : diagram.pieces)
      if (piece.face == face && contains(diagram, piece, {point.barycentric[1], point.barycentric[2]}))
        site = piece.site;
    if (site < 0) {
      ++without_piece;  // on a side up to rounding
      continue;
    }
    EXPECT_LE(distances.from(site, point), distances.least(point) + (2 * deviation + 1e-9) * mesh.diagonal())
        << "point " << k << " in face " << face << " at " << point.barycentric.transpose();
  }
  EXPECT_LE(without_piece, 2);
}

/// Expects the areas of whole faces and pieces to sum up to those of the cells, and the polygons of pieces to have the
/// areas of these up to what polylines that are `deviation` off can leave out.
void expect_areas_of_pieces(const TriangleMesh& mesh, const Diagram& diagram, double deviation) {
  std::vector<double> areas(diagram.cells.size(), 0);
  double whole = 0;
  for (std::size_t face = 0; face < diagram.face_sites.size(); ++face) {
    const double area = testing::area_of(mesh, static_cast<std::int32_t>(face));
    whole += area;
    if (diagram.face_sites[face] >= 0) areas[static_cast<std::size_t>(diagram.face_sites[face])] += area;
  }
  for (const DiagramPiece& piece : diagram.pieces) {
    areas[static_cast<std::size_t>(piece.site)] += piece.area;
    double doubled = 0;
    for (int i = 2; i < piece.corner_count; ++i) {
      const Vector2d a = corner_of(diagram, piece, i - 1) - corner_of(diagram, piece, 0);
      const Vector2d b = corner_of(diagram, piece, i) - corner_of(diagram, piece, 0);
      doubled += a.x() * b.y() - a.y() * b.x();
    }
    double around = 0;
    const auto position = [&](int i) {
      const Vector2d b = corner_of(diagram, piece, i);
      return surface::position(mesh, {FaceId(piece.face), Vector3d(1 - b.x() - b.y(), b.x(), b.y())});
    };
    for (int i = 0; i < piece.corner_count; ++i) around += (position(i + 1) - position(i)).norm();
    EXPECT_NEAR(piece.area, doubled * testing::area_of(mesh, piece.face),
                deviation * mesh.diagonal() * around + 1e-9 * whole)
        << "face " << piece.face << ", site " << piece.site;
  }
  for (std::size_t i = 0; i < areas.size(); ++i)
    EXPECT_NEAR(areas[i], diagram.cells[i].area, 1e-9 * whole) << "site " << i;
}

void expect_drawn_where_they_run(const TriangleMesh& mesh, const std::vector<SurfacePoint>& sites, int points,
                                 RandomStream& stream) {
  for (const double deviation : {1e-3, DiagramOptions{}.border_deviation}) {
    SCOPED_TRACE("deviation " + std::to_string(deviation));
    const Diagram found = drawn(mesh, sites, {.border_deviation = deviation});
    expect_areas_of_pieces(mesh, found, deviation);
    expect_points_in_their_pieces(mesh, found, deviation, points, stream);
    // Quadrature is less accurate for lengths than for areas where arcs curve sharply.
    EXPECT_GE(length_of_borders(found), length_of_lines(found) * (1 - 1e-5));
    if (deviation < 1e-4) {
      EXPECT_LE(length_of_borders(found), length_of_lines(found) * (1 + 1e-4));
    }
  }
}

TEST(DrawnBorders, HaveTheCornersThatTheyHaveInFaces) {
  const TriangleMesh mesh = TriangleMesh::build({{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                                                {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}});
  const std::vector<SurfacePoint> sites{{FaceId(0), {0.2, 0.6, 0.2}}, {FaceId(3), {0.2, 0.3, 0.5}}};
  const Diagram found = drawn(mesh, sites);
  EXPECT_NEAR(length_of_borders(found), 6.3996209946, 1e-9);
  EXPECT_NEAR(length_of_lines(found), length_of_borders(found), 1e-9);
  RandomStream stream("drawn_tetrahedron", 1);
  expect_points_in_their_pieces(mesh, found, 0, 2000, stream);
  expect_areas_of_pieces(mesh, found, 0);
}

TEST(DrawnBorders, RunBetweenTheNearestSitesOnCurvedSurfaces) {
  RandomStream stream("drawn_curved", 1);
  const auto expect = [&](const std::string& name, const TriangleMesh& mesh, int count) {
    SCOPED_TRACE(name);
    const std::vector<SurfacePoint> sites = random_sites(mesh, count, 5);
    expect_drawn_where_they_run(mesh, sites, 300, stream);
    expect_drawn_where_they_run(mesh, testing::on_vertices_and_edges(sites), 300, stream);
  };
  expect("torus", testing::torus(16, 8), 4);
  expect("genus 3", testing::genus3(2), 5);
  expect("bumpy cube", testing::bumpy_cube(6, 2.5, 0.1), 4);
  expect("rabbit", testing::rabbit(2), 8);
  expect("saddle", testing::saddle(8), 5);
  expect("L", testing::l_shape(3), 3);
}

TEST(DrawnBorders, RunBetweenTheNearestSitesOnSymmetricShapesAndNextToThem) {
  for (int family = 0; family < testing::symmetric_families; ++family) {
    for (const double noise : {0.0, 1e-10, 1e-7, 1e-4}) {
      const std::uint64_t seed = 100 + static_cast<std::uint64_t>(family);
      RandomStream stream("drawn_symmetric", seed);
      const testing::SymmetricSites sites =
          testing::disturbed(testing::random_symmetric_sites(family, stream), {.noise = noise}, stream);
      SCOPED_TRACE(sites.name + ", seed " + std::to_string(seed) + ", noise " + std::to_string(noise));
      expect_drawn_where_they_run(sites.mesh, sites.sites, 60, stream);
    }
  }
}

TEST(DrawnBorders, HaveMorePointsWhereTheyAreToBeNearer) {
  const TriangleMesh mesh = testing::torus(16, 8);
  const std::vector<SurfacePoint> sites = random_sites(mesh, 4, 5);
  std::size_t points = 0;
  double lines = 0;
  const Diagram finest = drawn(mesh, sites, {.border_deviation = min_border_deviation});
  for (const double deviation : {1.0, 1e-3, 1e-4, 1e-5, 1e-6, min_border_deviation}) {
    const Diagram found = drawn(mesh, sites, {.border_deviation = deviation});
    EXPECT_GE(found.points.size(), points);
    EXPECT_GE(length_of_lines(found), lines);
    points = found.points.size();
    lines = length_of_lines(found);
    EXPECT_NEAR(length_of_borders(found), length_of_borders(finest), 1e-7 * lines);
    for (std::size_t i = 0; i < sites.size(); ++i)
      EXPECT_NEAR(found.cells[i].area, finest.cells[i].area, 1e-8 * testing::area_of(mesh));
  }
  EXPECT_GT(points, drawn(mesh, sites).points.size());
}

TEST(DrawnBorders, AreTheSameForMomentsAndSamples) {
  const TriangleMesh mesh = testing::genus3(2);
  const std::vector<SurfacePoint> sites = random_sites(mesh, 5, 3);
  const DiagramOptions coarse{.border_deviation = 1, .border_samples = true, .cell_moments = true};
  DiagramOptions fine = coarse;
  fine.border_deviation = 1e-6;
  const Diagram one = drawn(mesh, sites, coarse);
  const Diagram other = drawn(mesh, sites, fine);
  EXPECT_GT(other.points.size(), one.points.size());
  ASSERT_EQ(one.border_samples.size(), other.border_samples.size());
  for (std::size_t i = 0; i < sites.size(); ++i) {
    EXPECT_NEAR(one.cells[i].area, other.cells[i].area, 1e-12);
    EXPECT_NEAR(one.cell_moments[i].squared_distance, other.cell_moments[i].squared_distance, 1e-12);
  }
}

TEST(DrawnBorders, AreNoFinerThanTheLimitAndNoCoarserThanTheMesh) {
  const TriangleMesh mesh = testing::l_shape(1);
  for (const double deviation : {0.0, 0.9 * min_border_deviation, 1.1, std::nan("")})
    testing::expect_error("voronoi.invalid_option",
                          [&] { drawn(mesh, random_sites(mesh, 2, 1), {.border_deviation = deviation}); });
}

}  // namespace
}  // namespace supple::voronoi
