#include "supple/surface/retraction.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "supple/surface/geodesic_solver.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using std::numbers::pi;

TEST(Retraction, WalksTheStraightestPathAndTurnsCoordinatesAlongIt) {
  const TriangleMesh mesh = testing::torus(16, 8);
  RandomStream random("retraction", 1);
  for (int trial = 0; trial < 50; ++trial) {
    const SurfacePoint p = testing::random_point(mesh, random);
    const Eigen::Vector2d step(random.uniform(-1, 1), random.uniform(-1, 1));
    const Retraction moved = retract(mesh, p, step, {});
    const ExponentialMap walked = exponential_map(mesh, p, tangent_frame(mesh, p.face) * step, {});
    EXPECT_LT((position(mesh, moved.end) - position(mesh, walked.end)).norm(), 1e-14);
    EXPECT_EQ(moved.travelled, step);
    EXPECT_TRUE(moved.isometric);
    // The path's direction, carried along, is its direction at the end.
    const Eigen::Vector2d carried = Eigen::Rotation2Dd(moved.turn) * step.normalized();
    EXPECT_LT((tangent_frame(mesh, moved.end.face) * carried - walked.end_direction).norm(), 1e-9);
  }
}

TEST(Retraction, SlidesAlongABoundaryThatTheStepLeadsOver) {
  const TriangleMesh mesh = testing::flat_grid(4, 4);
  // On the lower side; coordinates of the plane are those of space here, up to the face's frame.
  SurfacePoint p;
  for (int f = 0; f < mesh.face_count(); ++f)
    for (int i = 0; i < 3; ++i) {
      const auto& face = mesh.faces()[f];
      const Eigen::Vector3d a = mesh.positions()[face[i]];
      const Eigen::Vector3d b = mesh.positions()[face[(i + 1) % 3]];
      if (a.y() != 0 || b.y() != 0 || std::min(a.x(), b.x()) != 1) continue;
      p.face = FaceId{f};
      p.barycentric = Eigen::Vector3d::Zero();
      p.barycentric[i] = p.barycentric[(i + 1) % 3] = 0.5;
    }
  ASSERT_LT((position(mesh, p) - Eigen::Vector3d(1.5, 0, 0)).norm(), 1e-15);
  const auto frame = tangent_frame(mesh, p.face);
  const Retraction slid = retract(mesh, p, frame.transpose() * Eigen::Vector3d(0.4, -3, 0), {});
  EXPECT_LT((position(mesh, slid.end) - Eigen::Vector3d(1.9, 0, 0)).norm(), 1e-13);
  EXPECT_LT((frame * slid.travelled - Eigen::Vector3d(0.4, 0, 0)).norm(), 1e-13);
  EXPECT_FALSE(slid.isometric);
  const Retraction far = retract(mesh, p, frame.transpose() * Eigen::Vector3d(0.7, -3, 0), {});
  EXPECT_LT((position(mesh, far.end) - Eigen::Vector3d(2, 0, 0)).norm(), 1e-13) << "a slide ends at the next vertex";
  EXPECT_LT((frame * far.travelled - Eigen::Vector3d(0.5, 0, 0)).norm(), 1e-13);
  const Retraction inward = retract(mesh, p, frame.transpose() * Eigen::Vector3d(0.3, 8, 0), {});
  EXPECT_LT((position(mesh, inward.end) - Eigen::Vector3d(1.65, 4, 0)).norm(), 1e-13) << "the far side stops it";
  EXPECT_LT((frame * inward.travelled - Eigen::Vector3d(0.15, 4, 0)).norm(), 1e-13);
}

TEST(Retraction, LeavesATipInTheDirectionThatItsCoordinatesMean) {
  for (const double total : {2.0, 5.0, 8.0}) {
    const TriangleMesh mesh = testing::cone(8, total, 3);
    const SurfacePoint apex = vertex_point(mesh, VertexId{0});
    ASSERT_TRUE(on_cone_tip(mesh, apex));
    const VertexCone cone(mesh, 0);
    for (int k = 0; k < 40; ++k) {
      const double angle = total * (k + 0.4) / 40;
      const Eigen::Vector2d direction = cone_coordinates(cone, angle);
      EXPECT_NEAR(direction.norm(), 1, 1e-15);
      const Retraction moved = retract(mesh, apex, 0.2 * direction, {});
      EXPECT_NEAR((position(mesh, moved.end) - mesh.positions()[0]).norm(), 0.2, 1e-13);
      EXPECT_NEAR(cone.angle_to(moved.end), angle, 1e-12);
      EXPECT_LT((moved.travelled - 0.2 * direction).norm(), 1e-16);
      EXPECT_FALSE(moved.isometric);
    }
  }
}

TEST(Retraction, FromABoundaryVertexStaysOnTheSurface) {
  const TriangleMesh mesh = testing::l_shape(2);
  for (std::int32_t v = 0; v < mesh.vertex_count(); ++v) {
    if (!mesh.is_boundary(v)) continue;
    const VertexCone cone(mesh, v);
    const SurfacePoint point = vertex_point(mesh, VertexId{v});
    const double half = cone.total_angle() / 2;
    const Retraction inside = retract(mesh, point, 0.1 * cone_coordinates(cone, half), {});
    EXPECT_NEAR(cone.angle_to(inside.end), half, 1e-12);
    // Steps over the boundary slide along it, either way, by their part along it.
    const Retraction first = retract(mesh, point, {0.1, -5}, {});
    EXPECT_NEAR(cone.angle_to(first.end), 0, 1e-12);
    EXPECT_LT((first.travelled - Eigen::Vector2d(0.1, 0)).norm(), 1e-15);
    const Retraction last = retract(mesh, point, {-0.1, -5}, {});
    EXPECT_NEAR(cone.angle_to(last.end), cone.total_angle(), 1e-12);
    EXPECT_LT((last.travelled - Eigen::Vector2d(-0.1, 0)).norm(), 1e-15);
    const Retraction nowhere = retract(mesh, point, {0, -5}, {});
    EXPECT_EQ(nowhere.travelled, Eigen::Vector2d::Zero());
  }
}

TEST(Retraction, KnowsTipsFromFlatVertices) {
  const TriangleMesh grid = testing::flat_grid(3, 3);
  for (std::int32_t v = 0; v < grid.vertex_count(); ++v)
    EXPECT_EQ(on_cone_tip(grid, vertex_point(grid, VertexId{v})), grid.is_boundary(v));
  const TriangleMesh cube = testing::cube(2);
  int tips = 0;
  for (std::int32_t v = 0; v < cube.vertex_count(); ++v)
    tips += on_cone_tip(cube, vertex_point(cube, VertexId{v})) ? 1 : 0;
  EXPECT_EQ(tips, 8) << "edges of the cube are flat";
  EXPECT_FALSE(on_cone_tip(cube, {FaceId{0}, {0.2, 0.3, 0.5}}));
}

}  // namespace
}  // namespace supple::surface
