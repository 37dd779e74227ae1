#include "supple/surface/exponential_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>

#include "support/expect_error.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using std::numbers::pi;
using testing::expect_error;

Vector3d random_tangent(const TriangleMesh& mesh, FaceId face, double length, RandomStream& stream) {
  const double angle = stream.uniform(-pi, pi);
  return length * (tangent_frame(mesh, face) * Vector2d(std::cos(angle), std::sin(angle)));
}

SurfacePoint any_point(const TriangleMesh& mesh, int i, RandomStream& stream) {
  if (i % 4 == 2) return testing::random_edge_point(mesh, stream);
  if (i % 4 == 3) return testing::random_vertex_point(mesh, stream);
  return testing::random_point(mesh, stream);
}

/// What holds of every result: valid points, a trace whose segments add up to the length, a unit end direction.
void expect_sound(const TriangleMesh& mesh, const ExponentialMap& map, double asked) {
  double length = 0;
  for (std::size_t i = 0; i < map.trace.size(); ++i) {
    const PathPoint& p = map.trace[i];
    ASSERT_GE(p.point.barycentric.minCoeff(), 0);
    ASSERT_NEAR(p.point.barycentric.sum(), 1, 1e-15);
    ASSERT_EQ(p.position, position(mesh, p.point));
    if (i > 0) length += (p.position - map.trace[i - 1].position).norm();
  }
  ASSERT_GE(map.trace.size(), 2u);
  EXPECT_EQ(map.trace.back().point.barycentric, map.end.barycentric);
  EXPECT_NEAR(length, map.length, 1e-12 * asked);
  EXPECT_NEAR(map.end_direction.norm(), 1, 1e-14);
  if (!map.reached_boundary) {
    EXPECT_NEAR(map.length, asked, 1e-14 * asked);
  }
}

TEST(ExponentialMap, IsAStraightLineInThePlaneFromFacesEdgesAndVertices) {
  RandomStream stream("plane", 1);
  for (const TriangleMesh& mesh : {testing::flat_grid(20, 20), testing::jittered_grid(20, 20, stream)}) {
    int inside = 0;
    for (int i = 0; i < 2000; ++i) {
      const SurfacePoint start = any_point(mesh, i, stream);
      const double angle = stream.uniform(-pi, pi), length = stream.uniform(0, 8);
      const Vector3d vector(length * std::cos(angle), length * std::sin(angle), 0);
      const Vector3d from = position(mesh, start), wanted = from + vector;
      const ExponentialMap map = exponential_map(mesh, start, vector, {});
      expect_sound(mesh, map, length);
      const bool ends_inside = wanted.head<2>().minCoeff() > 0 && wanted.head<2>().maxCoeff() < 20;
      ASSERT_EQ(map.reached_boundary, !ends_inside);
      if (!ends_inside) continue;
      ++inside;
      EXPECT_LT((position(mesh, map.end) - wanted).norm(), 1e-12);
      EXPECT_LT((map.end_direction - vector / length).norm(), 1e-12);
    }
    EXPECT_GT(inside, 500);
  }
}

TEST(ExponentialMap, TransportsVectorsUnchangedInThePlane) {
  RandomStream stream("plane transport", 1);
  const TriangleMesh mesh = testing::jittered_grid(20, 20, stream);
  const Vector3d constant(0.6, -0.8, 0);
  for (int i = 0; i < 500; ++i) {
    const SurfacePoint start = any_point(mesh, i, stream);
    const ExponentialMap map = exponential_map(mesh, start, random_tangent(mesh, start.face, 5, stream), {}, false);
    if (map.length == 0) continue;
    const Vector2d before = tangent_frame(mesh, start.face).transpose() * constant;
    const Vector2d after = tangent_frame(mesh, map.end.face).transpose() * constant;
    EXPECT_LT((Eigen::Rotation2Dd(map.transport_angle) * before - after).norm(), 1e-12);
  }
}

TEST(ExponentialMap, WindsRoundACylinderAsInItsDevelopment) {
  constexpr int around = 12;
  const double radius = 0.3, side = 2 * radius * std::sin(pi / around);
  const TriangleMesh mesh = testing::needle_cylinder(around, 40, radius);
  // Developed coordinates of a point: along the sides of the prism, and z.
  const auto developed = [&](const SurfacePoint& point) {
    const Vector3d p = position(mesh, point);
    double angle = std::atan2(p[1], p[0]);
    if (angle < 0) angle += 2 * pi;
    const double sector = 2 * pi / around, in_sector = std::fmod(angle, sector) - sector / 2;
    const double along = radius * std::cos(sector / 2) * std::tan(in_sector) + side / 2;
    return Vector2d(std::floor(angle / sector) * side + along, p[2]);
  };
  RandomStream stream("cylinder", 1);
  int inside = 0;
  for (int i = 0; i < 500; ++i) {
    const SurfacePoint start = testing::random_point(mesh, stream);
    const double angle = stream.uniform(-0.2, 0.2), length = 3;
    const Vector3d across = tangent_frame(mesh, start.face).col(0);
    const Vector3d horizontal = Vector3d(across[0], across[1], 0).normalized();
    const Vector3d tangent = length * (std::cos(angle) * horizontal + Vector3d(0, 0, std::sin(angle)));
    const ExponentialMap map = exponential_map(mesh, start, tangent, {});
    expect_sound(mesh, map, length);
    if (map.reached_boundary) continue;
    ++inside;
    const double turn = position(mesh, start).cross(horizontal)[2] > 0 ? 1 : -1;
    const Vector2d wanted = developed(start) + length * Vector2d(turn * std::cos(angle), std::sin(angle));
    const Vector2d found = developed(map.end);
    EXPECT_NEAR(std::remainder(found[0] - wanted[0], around * side), 0, 1e-11);
    EXPECT_NEAR(found[1], wanted[1], 1e-12);
  }
  EXPECT_GT(inside, 100);
}

TEST(ExponentialMap, OnAConeFollowsItsDevelopment) {
  constexpr int n = 12;
  for (const double total : {2.5, 5.0, 9.0}) {
    const TriangleMesh mesh = testing::cone(n, total);
    const double sector = total / n;
    // Polar angle round the apex: face i is the sector between the rim vertices 1 + i and 2 + i.
    const auto polar = [&](const SurfacePoint& point) {
      const Vector3d p = position(mesh, point), rim = mesh.positions()[1 + index(point.face)];
      return index(point.face) * sector + std::atan2(rim.cross(p).norm(), rim.dot(p));
    };
    RandomStream stream("cone", static_cast<std::uint64_t>(total * 10));
    int inside = 0;
    for (int i = 0; i < 500; ++i) {
      const SurfacePoint start = testing::random_point(mesh, stream);
      const Vector3d from = position(mesh, start);
      const double radius = from.norm(), angle = stream.uniform(-pi, pi), length = stream.uniform(0, 1);
      const Vector3d radial = from / radius;
      const auto frame = tangent_frame(mesh, start.face);
      const Vector3d normal = frame.col(0).cross(frame.col(1));
      const Vector3d tangent = length * (std::cos(angle) * radial + std::sin(angle) * normal.cross(radial));
      const Vector2d wanted(radius + length * std::cos(angle), length * std::sin(angle));
      const ExponentialMap map = exponential_map(mesh, start, tangent, {});
      expect_sound(mesh, map, length);
      if (map.reached_boundary) continue;
      ++inside;
      EXPECT_NEAR(position(mesh, map.end).norm(), wanted.norm(), 1e-13);
      const double turned = std::atan2(wanted[1], wanted[0]);
      EXPECT_NEAR(std::remainder(polar(map.end) - polar(start) - turned, total), 0, 1e-11);
    }
    EXPECT_GT(inside, 100);
  }
}

TEST(ExponentialMap, LeavesAVertexWithEqualAnglesOnBothSides) {
  constexpr int n = 10;
  for (const double total : {4.0, 9.0}) {
    const TriangleMesh mesh = testing::cone(n, total);
    const double sector = total / n;
    // Down the edge to rim vertex 1, through the apex, out along the opposite edge: rim vertex 1 + n / 2.
    const SurfacePoint on_edge{FaceId(0), {0.5, 0.5, 0}};
    const ExponentialMap straight = exponential_map(mesh, on_edge, -0.75 * mesh.positions()[1], {});
    expect_sound(mesh, straight, 0.75);
    ASSERT_EQ(straight.trace.size(), 3u);
    EXPECT_EQ(straight.trace[1].vertex, VertexId(0));
    EXPECT_LT((position(mesh, straight.end) - 0.25 * mesh.positions()[1 + n / 2]).norm(), 1e-14);

    // From inside sector 0, at the share s of its angle: out at that share of the opposite sector.
    const double s = 0.3;
    const Vector3d a = mesh.positions()[1], b = mesh.positions()[2];
    const Vector3d across = (b - a.dot(b) * a).normalized();
    const Vector3d towards = std::cos(s * sector) * a + std::sin(s * sector) * across;
    const double third = std::sin(s * sector) / std::sin(sector),
                 second = std::cos(s * sector) - third * std::cos(sector);
    const SurfacePoint inside{FaceId(0), {1 - 0.5 * (second + third), 0.5 * second, 0.5 * third}};
    ASSERT_LT((position(mesh, inside) - 0.5 * towards).norm(), 1e-15);
    const ExponentialMap bent = exponential_map(mesh, inside, -0.75 * towards, {});
    expect_sound(mesh, bent, 0.75);
    EXPECT_EQ(bent.trace.at(1).vertex, VertexId(0));
    EXPECT_EQ(bent.end.face, FaceId(n / 2));
    const Vector3d rim = mesh.positions()[1 + n / 2], end = position(mesh, bent.end);
    EXPECT_NEAR(end.norm(), 0.25, 1e-14);
    EXPECT_NEAR(std::atan2(rim.cross(end).norm(), rim.dot(end)), s * sector, 1e-12);
  }
}

TEST(ExponentialMap, FromAVertexTurnsFromTheNearerSideOfTheFace) {
  constexpr int n = 10;
  for (const double total : {4.0, 9.0}) {
    const TriangleMesh mesh = testing::cone(n, total);
    const double sector = total / n;
    const SurfacePoint apex{FaceId(3), Vector3d::UnitX()};
    const auto frame = tangent_frame(mesh, apex.face);
    ASSERT_EQ(mesh.faces()[3][0], 0);
    for (const double off_bisector : {-pi + 0.1, -2.0, -0.4, 0.0, 0.3, 2.0, pi - 0.1}) {
      const double angle = sector / 2 + off_bisector;
      const ExponentialMap map =
          exponential_map(mesh, apex, frame * Vector2d(std::cos(angle), std::sin(angle)) / 2, {});
      expect_sound(mesh, map, 0.5);
      const Vector3d rim = mesh.positions()[1 + index(map.end.face)], end = position(mesh, map.end);
      const double polar = index(map.end.face) * sector + std::atan2(rim.cross(end).norm(), rim.dot(end));
      EXPECT_NEAR(end.norm(), 0.5, 1e-14);
      EXPECT_NEAR(std::remainder(polar - 3 * sector - angle, total), 0, 1e-12) << off_bisector;
    }
  }
}

TEST(ExponentialMap, RunsAlongEdgesThroughManyVertices) {
  const TriangleMesh mesh = testing::flat_grid(30, 30);
  const ExponentialMap diagonal =
      exponential_map(mesh, vertex_point(mesh, VertexId(0)), Vector3d(30.5, 30.5, 0) / 1.25, {});
  EXPECT_LT((position(mesh, diagonal.end) - Vector3d(24.4, 24.4, 0)).norm(), 1e-13);
  ASSERT_EQ(diagonal.trace.size(), 26u);
  for (int i = 0; i <= 24; ++i) EXPECT_EQ(diagonal.trace[i].vertex, VertexId(i * 31 + i));
  const ExponentialMap row = exponential_map(mesh, vertex_point(mesh, VertexId(5 * 31 + 2)), Vector3d(20, 0, 0), {});
  EXPECT_EQ(row.trace.size(), 21u);
  EXPECT_EQ(row.trace.back().vertex, VertexId(5 * 31 + 22));
}

TEST(ExponentialMap, StopsAtTheBoundary) {
  const TriangleMesh mesh = testing::flat_grid(4, 4);
  const SurfacePoint start{FaceId(0), Vector3d(0.5, 0.25, 0.25)};
  const Vector3d from = position(mesh, start);
  const ExponentialMap map = exponential_map(mesh, start, Vector3d(0, 100, 0), {});
  EXPECT_TRUE(map.reached_boundary);
  EXPECT_NEAR(map.length, 4 - from[1], 1e-14);
  EXPECT_LT((position(mesh, map.end) - Vector3d(from[0], 4, 0)).norm(), 1e-14);
  EXPECT_EQ(side_of(map.end) >= 0, true);
  EXPECT_LT((map.end_direction - Vector3d::UnitY()).norm(), 1e-14);
}

TEST(ExponentialMap, FromTheBoundaryGoesInwardAlongOrNowhere) {
  const TriangleMesh mesh = testing::flat_grid(4, 4);
  std::vector<SurfacePoint> starts = {vertex_point(mesh, VertexId(2))};
  for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
    for (int i = 0; i < 3; ++i) {
      const std::int32_t h = 3 * f + i;
      // The bottom edge from x = 2 to x = 3, at its middle.
      if (mesh.twin(h) >= 0 || mesh.positions()[mesh.tail(h)] != Vector3d(2, 0, 0)) continue;
      Vector3d b = Vector3d::Zero();
      b[i] = b[(i + 1) % 3] = 0.5;
      starts.push_back({FaceId(f), b});
    }
  }
  ASSERT_EQ(starts.size(), 2u);
  for (const SurfacePoint& start : starts) {
    const Vector3d from = position(mesh, start);
    const ExponentialMap inward = exponential_map(mesh, start, Vector3d(0.7, 1.3, 0), {});
    EXPECT_FALSE(inward.reached_boundary);
    EXPECT_LT((position(mesh, inward.end) - from - Vector3d(0.7, 1.3, 0)).norm(), 1e-14);

    const ExponentialMap outward = exponential_map(mesh, start, Vector3d(0.5, -0.5, 0), {});
    EXPECT_TRUE(outward.reached_boundary);
    EXPECT_EQ(outward.length, 0);
    EXPECT_EQ(position(mesh, outward.end), from);

    const ExponentialMap along = exponential_map(mesh, start, Vector3d(0.25, 0, 0), {});
    EXPECT_FALSE(along.reached_boundary);
    EXPECT_LT((position(mesh, along.end) - from - Vector3d(0.25, 0, 0)).norm(), 1e-15);
  }
}

TEST(ExponentialMap, TheReversedPathReturnsToItsStart) {
  struct Case {
    std::string name;
    TriangleMesh mesh;
    double length;
  };
  const Case cases[] = {{"sphere", testing::icosphere(3), 7},         {"torus", testing::torus(), 7},
                        {"genus 3", testing::genus3(), 10},           {"saddle", testing::saddle(20), 0.5},
                        {"bumpy cube", testing::bumpy_cube(20), 3},   {"cube", testing::cube(5), 10},
                        {"spiral", testing::spiral_cup(300, 12), 10}, {"needles", testing::needle_cylinder(), 0.2},
                        {"slivers", testing::sliver_sphere(), 5},     {"saddle cone", testing::cone(10, 9.0, 3), 0.4}};
  for (const auto& [name, mesh, length] : cases) {
    SCOPED_TRACE(name);
    RandomStream stream("reversed " + name, 1);
    int returned = 0;
    for (int i = 0; i < 400; ++i) {
      // Not from vertices: coming back to a vertex inside the surface ends there in any direction.
      const SurfacePoint start = any_point(mesh, i % 3, stream);
      const ExponentialMap there = exponential_map(mesh, start, random_tangent(mesh, start.face, length, stream), {});
      expect_sound(mesh, there, length);
      const ExponentialMap back = exponential_map(mesh, there.end, -there.length * there.end_direction, {});
      if (there.reached_boundary) continue;
      ++returned;
      EXPECT_LT((position(mesh, back.end) - position(mesh, start)).norm(), 1e-10);
      // A start on an edge may be met again in the edge's other face.
      if (back.end.face != start.face) continue;
      EXPECT_NEAR(std::remainder(there.transport_angle + back.transport_angle, 2 * pi), 0, 1e-10);
    }
    EXPECT_GT(returned, 100);
  }
}

TEST(ExponentialMap, PassesHardSliversInAnyDirection) {
  // Strips of height 1e-12 between ordinary ones.
  std::vector<Vector3d> positions;
  std::vector<Triangle> faces;
  const double heights[] = {0, 1, 1 + 1e-12, 2, 2 + 1e-12, 2 + 2e-12, 3};
  for (const double y : heights) {
    for (int x = 0; x <= 3; ++x) positions.push_back({static_cast<double>(x), y, 0});
  }
  for (int j = 0; j < 6; ++j) {
    for (int i = 0; i < 3; ++i) {
      const int a = 4 * j + i;
      faces.push_back({a, a + 1, a + 5});
      faces.push_back({a, a + 5, a + 4});
    }
  }
  const TriangleMesh mesh = TriangleMesh::build(positions, faces);
  RandomStream stream("hard slivers", 1);
  for (int i = 0; i < 2000; ++i) {
    const SurfacePoint start = any_point(mesh, i, stream);
    const double angle = stream.uniform(-pi, pi), length = stream.uniform(0, 3);
    const Vector3d vector(length * std::cos(angle), length * std::sin(angle), 0);
    const ExponentialMap map = exponential_map(mesh, start, vector, {}, true, 1000);
    expect_sound(mesh, map, length);
    if (map.reached_boundary || map.length == 0) continue;
    // The slivers' corners are known to 1e-16 / 1e-12 only, and a direction through one turns by as much.
    EXPECT_LT((position(mesh, map.end) - position(mesh, start) - vector).norm(), 1e-3);
  }
}

TEST(ExponentialMap, IgnoresThePartOfTheVectorAcrossTheFace) {
  const TriangleMesh mesh = testing::cube(3);
  const SurfacePoint start{FaceId(7), Vector3d(0.3, 0.3, 0.4)};
  const auto frame = tangent_frame(mesh, start.face);
  const Vector3d tangent = frame * Vector2d(0.8, 0.3), normal = frame.col(0).cross(frame.col(1));
  const ExponentialMap a = exponential_map(mesh, start, tangent, {}),
                       b = exponential_map(mesh, start, tangent + 5 * normal, {});
  EXPECT_LT((position(mesh, a.end) - position(mesh, b.end)).norm(), 1e-14);
  EXPECT_NEAR(b.length, tangent.norm(), 1e-14);
}

TEST(ExponentialMap, OfZeroIsTheStart) {
  const TriangleMesh mesh = testing::icosphere(1);
  const SurfacePoint start{FaceId(3), Vector3d(0.2, 0.3, 0.5)};
  const ExponentialMap map = exponential_map(mesh, start, Vector3d::Zero(), {});
  EXPECT_EQ(map.end.face, start.face);
  EXPECT_EQ(map.end.barycentric, start.barycentric);
  EXPECT_EQ(map.length, 0);
  EXPECT_EQ(map.transport_angle, 0);
  EXPECT_EQ(map.end_direction, Vector3d::Zero());
  EXPECT_FALSE(map.reached_boundary);
}

TEST(ExponentialMap, WritesNoTraceUnlessAsked) {
  const TriangleMesh mesh = testing::icosphere(2);
  const SurfacePoint start{FaceId(3), Vector3d(0.2, 0.3, 0.5)};
  const Vector3d tangent = tangent_frame(mesh, start.face).col(0);
  const ExponentialMap with = exponential_map(mesh, start, tangent, {}),
                       without = exponential_map(mesh, start, tangent, {}, false);
  EXPECT_GT(with.trace.size(), 2u);
  EXPECT_TRUE(without.trace.empty());
  EXPECT_EQ(with.end.barycentric, without.end.barycentric);
}

TEST(ExponentialMap, RefusesVectorsThatAreNotFiniteOrTooLong) {
  const TriangleMesh mesh = testing::icosphere(2);
  const SurfacePoint start{FaceId(0), Vector3d(0.2, 0.3, 0.5)};
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_error("exponential_map.non_finite", [&] { exponential_map(mesh, start, {0, nan, 0}, {}); });
  expect_error("exponential_map.non_finite", [&] { exponential_map(mesh, start, {1e300, 1e300, 1e300}, {}); });
  expect_error("exponential_map.too_long", [&] { exponential_map(mesh, start, {1e30, 0, 0}, {}, false, 1000); });
  expect_error<PointError>("point.outside_face", [&] {
    exponential_map(mesh, {FaceId(0), {2, -1, 0}}, {1, 0, 0}, {});
  });
}

}  // namespace
}  // namespace supple::surface
