#include "supple/surface/surface_point.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>

#include "supple/base/random.h"
#include "support/expect_error.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using testing::expect_error;
using testing::places;
using Places = std::vector<std::string>;

TEST(CheckedPoint, LeavesValidPointsUntouched) {
  const TriangleMesh mesh = testing::torus();
  RandomStream stream("valid points", 1);
  for (int i = 0; i < 1000; ++i) {
    const SurfacePoint once = checked_point(mesh, testing::random_point(mesh, stream));
    const SurfacePoint twice = checked_point(mesh, once);
    EXPECT_EQ(once.barycentric, twice.barycentric);
    EXPECT_NEAR(once.barycentric.sum(), 1, 1e-15);
    EXPECT_GE(once.barycentric.minCoeff(), 0);
  }
  const SurfacePoint corner{FaceId(3), {0, 1, 0}};
  EXPECT_EQ(checked_point(mesh, corner).barycentric, corner.barycentric);
}

TEST(CheckedPoint, ClampsRoundingAndKeepsTheDigitsOfSmallCoordinates) {
  const TriangleMesh mesh = testing::torus();
  EXPECT_EQ(checked_point(mesh, {FaceId(0), {-1e-10, 0.5, 0.5}}).barycentric, Eigen::Vector3d(0, 0.5, 0.5));
  const Eigen::Vector3d b = checked_point(mesh, {FaceId(0), {1e-12, 1e-20, 1 + 5e-10}}).barycentric;
  EXPECT_NEAR(b[0], 1e-12, 1e-20);
  EXPECT_NEAR(b[1], 1e-20, 1e-28);
}

TEST(CheckedPoint, NormalizesCoordinatesOfSinglePrecision) {
  const TriangleMesh mesh = testing::torus();
  for (std::uint64_t seed = 1; seed <= 100; ++seed) {
    RandomStream stream("single precision", seed);
    const float a = static_cast<float>(stream.uniform(0, 1)), b = static_cast<float>(stream.uniform(0, 1 - a));
    const Eigen::Vector3d given(a, b, 1.0F - a - b);
    const Eigen::Vector3d off = given + Eigen::Vector3d(-9e-6, 3e-6, 1e-6) * stream.uniform(-1, 1);
    for (const Eigen::Vector3d& coordinates : {given, off}) {
      const Eigen::Vector3d checked = checked_point(mesh, {FaceId(0), coordinates}).barycentric;
      EXPECT_NEAR(checked.sum(), 1, 4e-16) << "seed " << seed;
      EXPECT_GE(checked.minCoeff(), 0);
      EXPECT_LT((checked - coordinates).norm(), 2e-5);
    }
  }
}

TEST(CheckedPoint, NamesTheFieldAtFault) {
  const TriangleMesh mesh = testing::icosphere(0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto check = [&](std::int32_t face, const Eigen::Vector3d& b) {
    return [&mesh, face, b] { checked_point(mesh, {FaceId(face), b}, "pairs/3/from"); };
  };
  const Places face{"pairs/3/from/face"}, barycentric{"pairs/3/from/barycentric"};
  EXPECT_EQ(places(expect_error<PointError>("point.face_out_of_range", check(20, {1, 0, 0}))), face);
  EXPECT_EQ(places(expect_error<PointError>("point.face_out_of_range", check(-1, {1, 0, 0}))), face);
  EXPECT_EQ(places(expect_error<PointError>("point.non_finite", check(0, {nan, 0, 1}))), barycentric);
  EXPECT_EQ(places(expect_error<PointError>("point.outside_face", check(0, {-1.1e-5, 0.5, 0.5}))), barycentric);
  EXPECT_EQ(places(expect_error<PointError>("point.outside_face", check(0, {0.5, 0.5, 1.1e-5}))), barycentric);
  EXPECT_EQ(places(expect_error<PointError>("point.outside_face", check(0, {1e308, 1e308, 1e308}))), barycentric);
}

TEST(VertexPoint, LiesOnTheVertex) {
  const TriangleMesh mesh = testing::saddle(4);
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    const SurfacePoint point = vertex_point(mesh, VertexId(v));
    EXPECT_EQ(position(mesh, point), mesh.positions()[v]);
    EXPECT_EQ(mesh.faces()[index(point.face)][corner_of(point)], v);
  }
}

TEST(VertexPoint, RefusesVerticesOutsideOfTheSurface) {
  const TriangleMesh mesh = TriangleMesh::build({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 2, 2}}, {{0, 1, 2}});
  expect_error<PointError>("point.vertex_out_of_range", [&] { vertex_point(mesh, VertexId(4)); });
  expect_error<PointError>("point.vertex_out_of_range", [&] { vertex_point(mesh, VertexId::none); });
  expect_error<PointError>("point.isolated_vertex", [&] { vertex_point(mesh, VertexId(3)); });
}

TEST(SurfacePoint, KnowsTheCornerOrSideThatItLiesOnExactly) {
  const auto at = [](double a, double b, double c) { return SurfacePoint{FaceId(0), {a, b, c}}; };
  EXPECT_EQ(corner_of(at(0, 0, 1)), 2);
  EXPECT_EQ(side_of(at(0, 0, 1)), -1);
  EXPECT_EQ(side_of(at(0.5, 0.5, 0)), 0);
  EXPECT_EQ(side_of(at(0, 0.5, 0.5)), 1);
  EXPECT_EQ(side_of(at(0.5, 0, 0.5)), 2);
  EXPECT_EQ(corner_of(at(1e-300, 0.5, 0.5)), -1);
  EXPECT_EQ(side_of(at(1e-300, 0.5, 0.5)), -1);
}

TEST(TangentFrame, IsOrthonormalAndTurnsCounterclockwise) {
  for (const TriangleMesh& mesh : {testing::torus(), testing::needle_cylinder(), testing::sliver_sphere()}) {
    for (std::int32_t f = 0; f < mesh.face_count(); ++f) {
      const auto frame = tangent_frame(mesh, FaceId(f));
      EXPECT_NEAR((frame.transpose() * frame - Eigen::Matrix2d::Identity()).norm(), 0, 1e-15);
      const Eigen::Vector3d a = mesh.positions()[mesh.faces()[f][0]];
      const Eigen::Vector2d first = frame.transpose() * (mesh.positions()[mesh.faces()[f][1]] - a);
      const Eigen::Vector2d second = frame.transpose() * (mesh.positions()[mesh.faces()[f][2]] - a);
      EXPECT_NEAR(first[0], mesh.edge_length(3 * f), 1e-15);
      EXPECT_NEAR(first[1], 0, 1e-15);
      EXPECT_GT(second[1], 0);
    }
  }
}

}  // namespace
}  // namespace supple::surface
