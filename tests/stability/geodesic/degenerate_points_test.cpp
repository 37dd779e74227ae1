// Points that lie where formulas divide by nearly nothing. Each case says what is hard about it.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "supple/surface/geodesic_solver.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using Eigen::Vector3d;
using testing::share;

/// A point whose distance from a corner or side of its face is a tiny share of the face.
SurfacePoint next_to_corner(std::int32_t face, int corner, double away) {
  SurfacePoint p{FaceId(face), Vector3d::Constant(away)};
  p.barycentric[corner] = 1 - 2 * away;
  return p;
}
SurfacePoint next_to_side(std::int32_t face, int side, double along, double away) {
  SurfacePoint p{FaceId(face), Vector3d::Zero()};
  p.barycentric[(side + 2) % 3] = away;
  p.barycentric[side] = 1 - along - away;
  p.barycentric[(side + 1) % 3] = along;
  return p;
}

class DegeneratePoints : public ::testing::TestWithParam<double> {};

// Hard: a source this close to a vertex sends rays that are almost parallel to the edges of the vertex.
TEST_P(DegeneratePoints, NextToAVertexActLikeTheVertex) {
  const double away = GetParam();
  for (const auto& mesh : {share(testing::icosphere(3)), share(testing::saddle(10)), share(testing::genus3(2))}) {
    const GeodesicSolver solver(mesh);
    RandomStream stream("next_to_vertex", 1);
    for (int i = 0; i < 60; ++i) {
      const std::int32_t face = stream.below(mesh->face_count());
      const int corner = stream.below(3);
      const SurfacePoint p = next_to_corner(face, corner, away);
      const SurfacePoint v = vertex_point(*mesh, VertexId(mesh->faces()[face][corner]));
      const SurfacePoint other = testing::random_point(*mesh, stream);
      const double moved = (position(*mesh, p) - position(*mesh, v)).norm();
      const double d = solver.distance(v, other);
      EXPECT_NEAR(solver.distance(p, other), d, moved * (1 + 1e-9) + 1e-13);
      EXPECT_NEAR(solver.distance(other, p), d, moved * (1 + 1e-9) + 1e-13);
      EXPECT_NEAR(solver.distance(p, v), moved, 1e-14);
      const GeodesicField field = solver.field({&p, 1}, {.keep_windows = true});
      EXPECT_NEAR(field.distance(other), d, moved * (1 + 1e-9) + 1e-13);
      EXPECT_NEAR(field.distance(v), moved, 1e-14);
    }
  }
}

// Hard: the window across the near side is seen under half a turn.
TEST_P(DegeneratePoints, NextToAnEdgeActLikeTheirFeetOnIt) {
  const double away = GetParam();
  for (const auto& mesh : {share(testing::icosphere(3)), share(testing::saddle(10)), share(testing::sliver_sphere())}) {
    const GeodesicSolver solver(mesh);
    RandomStream stream("next_to_edge", 2);
    for (int i = 0; i < 60; ++i) {
      const std::int32_t face = stream.below(mesh->face_count());
      const int side = stream.below(3);
      const double along = stream.uniform(0.1, 0.8);
      const SurfacePoint p = next_to_side(face, side, along, away);
      const SurfacePoint foot = next_to_side(face, side, along, 0);
      const SurfacePoint other = testing::random_point(*mesh, stream);
      const double moved = (position(*mesh, p) - position(*mesh, foot)).norm();
      const double d = solver.distance(foot, other);
      EXPECT_NEAR(solver.distance(p, other), d, moved * (1 + 1e-9) + 1e-13);
      EXPECT_NEAR(solver.distance(other, p), d, moved * (1 + 1e-9) + 1e-13);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(At, DegeneratePoints,
                         ::testing::Values(1e-3, 1e-5, 1e-7, 1e-9, 1e-10, 1e-11, 1e-12, 1e-13, 3e-14, 1e-14, 5e-15,
                                           1e-15, 1e-17, 1e-300));

// Hard: the distance of a point from itself has no derivative, and no direction.
TEST(CoincidentPoints, AreAtDistanceZeroWithoutDerivatives) {
  const auto mesh = share(testing::torus(16, 8));
  const GeodesicSolver solver(mesh);
  RandomStream stream("coincident", 3);
  for (int i = 0; i < 60; ++i) {
    const SurfacePoint p = i % 3 == 0   ? testing::random_point(*mesh, stream)
                           : i % 3 == 1 ? testing::random_edge_point(*mesh, stream)
                                        : testing::random_vertex_point(*mesh, stream);
    const Geodesic g = solver.geodesic(p, p, {.derivatives = 2, .path = true});
    EXPECT_EQ(g.distance, 0);
    EXPECT_FALSE(g.unreachable);
    EXPECT_FALSE(g.derivatives);
  }
}

// Hard: the shortest path flips from one side of a saddle vertex to the other; between, it is pinned to it.
TEST(PathsPastASaddle, HaveContinuousDistancesAndGradients) {
  const auto mesh = share(testing::cone(12, 8.0, 3));
  const GeodesicSolver solver(mesh);
  const SurfacePoint from{FaceId(2), {0.2, 0.5, 0.3}};
  double previous = -1;
  Vector3d previous_direction = Vector3d::Zero();
  int pinned = 0;
  // Round the rim, face by face, in small steps.
  const GeodesicField field = solver.field({&from, 1}, {.keep_windows = true});
  for (std::int32_t f = 0; f < mesh->face_count(); ++f) {
    previous = -1;
    for (int k = 1; k < 200; ++k) {
      const SurfacePoint to{FaceId(f), {0.2, 0.8 * k / 200, 0.8 * (1 - k / 200.0)}};
      const Geodesic g = field.geodesic(to, {.derivatives = 1});
      if (!g.derivatives) continue;
      const double step = 0.8 / 200 * mesh->edge_length(3 * f + 1) * (1 + 1e-9);
      const Vector3d direction = tangent_frame(*mesh, to.face) * g.derivatives->tangent_gradient.tail<2>();
      if (previous >= 0) {
        EXPECT_LE(std::abs(g.distance - previous), step);
        // Turns no faster than a straight line from the nearest pin or source would.
        if (g.distance > 0.2) {
          EXPECT_LT((direction - previous_direction).norm(), step / 0.02);
        }
      }
      previous = g.distance;
      previous_direction = direction;
      pinned += !g.pinned_at.empty();
    }
  }
  EXPECT_GT(pinned, 100);
}

}  // namespace
}  // namespace supple::surface
