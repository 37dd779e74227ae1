// First and second derivatives of distances against finite differences, in all the ways that paths run.
#include <gtest/gtest.h>

#include <memory>
#include <utility>
#include <vector>

#include "supple/surface/geodesic_derivatives.h"
#include "supple/surface/geodesic_solver.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using testing::share;

/// The point moved within its face by barycentric differences of sum zero.
SurfacePoint moved(const SurfacePoint& point, const Vector3d& difference) {
  return {point.face, point.barycentric + difference};
}

const Vector3d kDirections[2] = {{1, -1, 0}, {1, 1, -2}};

double smallest(const SurfacePoint& point) { return point.barycentric.minCoeff(); }

/// Compares derivatives along two directions at each end with fourth-order central differences.
void expect_derivatives(const GeodesicSolver& solver, const SurfacePoint& a, const SurfacePoint& b, double tolerance) {
  const GeodesicOptions options{.derivatives = 2};
  const Geodesic g = solver.geodesic(a, b, options);
  ASSERT_TRUE(g.derivatives);
  const double h = 1e-4;
  for (int variable = 0; variable < 4; ++variable) {
    const int end = variable / 2;
    const Vector3d& direction = kDirections[variable % 2];
    Eigen::Matrix<double, 6, 1> along = Eigen::Matrix<double, 6, 1>::Zero();
    along.segment<3>(3 * end) = direction;
    const auto at = [&](double step) {
      return end == 0 ? solver.geodesic(moved(a, step * direction), b, options)
                      : solver.geodesic(a, moved(b, step * direction), options);
    };
    const Geodesic m2 = at(-2 * h), m1 = at(-h), p1 = at(h), p2 = at(2 * h);
    const double first = (m2.distance - 8 * m1.distance + 8 * p1.distance - p2.distance) / (12 * h);
    const double scale = (direction.norm() * solver.mesh().mean_edge_length());
    EXPECT_NEAR(g.derivatives->gradient.dot(along), first, tolerance * scale);
    const Eigen::Matrix<double, 6, 1> second = (m2.derivatives->gradient - 8 * m1.derivatives->gradient +
                                                8 * p1.derivatives->gradient - p2.derivatives->gradient) /
                                               (12 * h);
    for (int other = 0; other < 4; ++other) {
      Eigen::Matrix<double, 6, 1> test = Eigen::Matrix<double, 6, 1>::Zero();
      test.segment<3>(3 * (other / 2)) = kDirections[other % 2];
      const double size = scale * kDirections[other % 2].norm() * solver.mesh().mean_edge_length();
      // The shortest straight piece bounds the curvature: below it the Hessian is of size 1 / piece.
      const double bound = size * (1 + g.derivatives->tangent_hessian.norm());
      EXPECT_NEAR(test.dot(g.derivatives->hessian * along), second.dot(test), tolerance * bound);
    }
  }
}

TEST(GeodesicDerivatives, AgreeWithFiniteDifferences) {
  int checked = 0;
  for (const auto& mesh : {share(testing::icosphere(3)), share(testing::torus()), share(testing::genus3()),
                           share(testing::saddle(16)), share(testing::bumpy_cube(8)), share(testing::l_shape(4))}) {
    const GeodesicSolver solver(mesh);
    RandomStream stream("derivatives", 21);
    for (int i = 0; i < 60; ++i) {
      const SurfacePoint a = testing::random_point(*mesh, stream);
      const SurfacePoint b = testing::random_point(*mesh, stream);
      // Steps must stay in the face and away from the cut locus, where there are no derivatives.
      if (smallest(a) < 2e-3 || smallest(b) < 2e-3) continue;
      const Geodesic g = solver.geodesic(a, b);
      if (g.competing_excess < 5e-3 * mesh->mean_edge_length() || g.distance < 0.3 * mesh->mean_edge_length()) continue;
      // A path that passes a vertex closer than the steps changes its strip, and with it the second derivatives.
      const Geodesic path = solver.geodesic(a, b, {.path = true});
      bool close = false;
      for (std::size_t k = 1; k + 1 < path.path.size(); ++k) {
        const PathPoint& p = path.path[k];
        if (p.vertex == VertexId::none) close = close || p.point.barycentric.maxCoeff() > 1 - 5e-3;
      }
      if (close) continue;
      expect_derivatives(solver, a, b, 1e-6);
      ++checked;
    }
  }
  EXPECT_GT(checked, 150);
}

TEST(GeodesicDerivatives, DecoupleThroughASaddleVertex) {
  const auto mesh = share(testing::cone(12, 8.5, 3));
  const GeodesicSolver solver(mesh);
  RandomStream stream("pinned", 22);
  int pinned = 0;
  for (int i = 0; i < 200 && pinned < 20; ++i) {
    const SurfacePoint a = testing::random_point(*mesh, stream);
    const SurfacePoint b = testing::random_point(*mesh, stream);
    if (smallest(a) < 0.05 || smallest(b) < 0.05) continue;
    const Geodesic g = solver.geodesic(a, b, {.derivatives = 2});
    if (g.pinned_at.empty()) continue;
    ++pinned;
    EXPECT_EQ(g.pinned_at.size(), 1u);
    const double first = position(*mesh, a).norm();
    const double last = position(*mesh, b).norm();
    EXPECT_NEAR(g.distance, first + last, 1e-13);
    EXPECT_EQ((g.derivatives->tangent_hessian.topRightCorner<2, 2>().norm()), 0);
    EXPECT_NEAR((g.derivatives->tangent_hessian.topLeftCorner<2, 2>().trace()), 1 / first, 1e-10 / first);
    EXPECT_NEAR((g.derivatives->tangent_hessian.bottomRightCorner<2, 2>().trace()), 1 / last, 1e-10 / last);
    expect_derivatives(solver, a, b, 1e-6);
  }
  EXPECT_EQ(pinned, 20);
}

TEST(GeodesicDerivatives, SwapWithTheEnds) {
  for (const auto& mesh : {share(testing::torus(24, 12)), share(testing::saddle(12))}) {
    const GeodesicSolver solver(mesh);
    RandomStream stream("swap", 23);
    for (int i = 0; i < 100; ++i) {
      const SurfacePoint a = i % 2 ? testing::random_edge_point(*mesh, stream) : testing::random_point(*mesh, stream);
      const SurfacePoint b = i % 3 ? testing::random_point(*mesh, stream) : testing::random_edge_point(*mesh, stream);
      const Geodesic ab = solver.geodesic(a, b, {.derivatives = 2});
      const Geodesic ba = solver.geodesic(b, a, {.derivatives = 2});
      if (ab.competing_excess < 1e-6) continue;
      Eigen::Matrix4d swap = Eigen::Matrix4d::Zero();
      swap.topRightCorner<2, 2>().setIdentity();
      swap.bottomLeftCorner<2, 2>().setIdentity();
      EXPECT_LT((ab.derivatives->tangent_gradient - swap * ba.derivatives->tangent_gradient).norm(), 1e-9) << i;
      EXPECT_LT((ab.derivatives->tangent_hessian - swap * ba.derivatives->tangent_hessian * swap).norm(),
                1e-8 * (1 + ab.derivatives->tangent_hessian.norm()))
          << i;
    }
  }
}

TEST(GeodesicDerivatives, AtEdgesAndVerticesAreTheLimitsFromTheirFace) {
  const auto mesh = share(testing::flat_grid(8, 8));
  const GeodesicSolver solver(mesh);
  RandomStream stream("limits", 24);
  for (int i = 0; i < 200; ++i) {
    const SurfacePoint a =
        i % 2 ? testing::random_vertex_point(*mesh, stream) : testing::random_edge_point(*mesh, stream);
    const SurfacePoint b =
        i % 3 ? testing::random_edge_point(*mesh, stream) : testing::random_vertex_point(*mesh, stream);
    const Vector3d difference = position(*mesh, b) - position(*mesh, a);
    if (difference.norm() < 1e-3) continue;
    const Geodesic g = solver.geodesic(a, b, {.derivatives = 2});
    // In the plane everything is known: unit direction u, Hessian blocks +-(I - u u^T) / d.
    const Vector3d u = difference.normalized();
    const Vector2d ua = tangent_frame(*mesh, a.face).transpose() * u;
    const Vector2d ub = tangent_frame(*mesh, b.face).transpose() * u;
    EXPECT_LT((g.derivatives->tangent_gradient.head<2>() + ua).norm(), 1e-10) << i;
    EXPECT_LT((g.derivatives->tangent_gradient.tail<2>() - ub).norm(), 1e-10) << i;
    const Eigen::Matrix3d curvature = (Eigen::Matrix3d::Identity() - u * u.transpose()) / difference.norm();
    Eigen::Matrix<double, 3, 4> frames;
    frames << -tangent_frame(*mesh, a.face), tangent_frame(*mesh, b.face);
    EXPECT_LT((g.derivatives->tangent_hessian - frames.transpose() * curvature * frames).norm(),
              1e-8 / difference.norm())
        << i << " from " << position(*mesh, a).transpose() << " to " << position(*mesh, b).transpose();
  }
}

TEST(GeodesicDerivatives, OfTheTridiagonalFormEqualTheClosedForms) {
  for (const auto& mesh : {share(testing::icosphere(3)), share(testing::torus(24, 12)), share(testing::saddle(14)),
                           share(testing::bumpy_cube(8)), share(testing::sliver_sphere())}) {
    const GeodesicSolver solver(mesh);
    RandomStream stream("tridiagonal", 25);
    for (int i = 0; i < 60; ++i) {
      const SurfacePoint a =
          i % 4 == 1 ? testing::random_edge_point(*mesh, stream) : testing::random_point(*mesh, stream);
      const SurfacePoint b =
          i % 4 == 2 ? testing::random_edge_point(*mesh, stream) : testing::random_point(*mesh, stream);
      const Geodesic g = solver.geodesic(a, b, {.derivatives = 2, .path = true});
      if (g.distance < 0.1 * mesh->mean_edge_length()) continue;
      const PathLength general = path_length(*mesh, g.path);
      EXPECT_NEAR(general.length, g.distance, 1e-11 * g.distance);
      EXPECT_LT((general.derivatives.tangent_gradient - g.derivatives->tangent_gradient).norm(), 1e-7) << i;
      EXPECT_LT((general.derivatives.tangent_hessian - g.derivatives->tangent_hessian).norm(),
                1e-6 * (1 + g.derivatives->tangent_hessian.norm()))
          << i;
    }
  }
}

TEST(GeodesicDerivatives, OfTheTridiagonalFormEqualTheClosedFormsWithinAFace) {
  const auto mesh = share(testing::bumpy_cube(8));
  const GeodesicSolver solver(mesh);
  RandomStream stream("tridiagonal", 26);
  for (int i = 0; i < 40; ++i) {
    const SurfacePoint a = testing::random_point(*mesh, stream);
    const double x = stream.uniform(0.05, 0.45);
    const double y = stream.uniform(0.05, 0.45);
    const SurfacePoint b{a.face, {x, y, 1 - x - y}};
    const Geodesic g = solver.geodesic(a, b, {.derivatives = 2, .path = true});
    ASSERT_EQ(g.path.size(), 2U);
    if (g.distance < 0.1 * mesh->mean_edge_length()) continue;
    const PathLength general = path_length(*mesh, g.path);
    EXPECT_NEAR(general.length, g.distance, 1e-14);
    EXPECT_LT((general.derivatives.tangent_gradient - g.derivatives->tangent_gradient).norm(), 1e-12) << i;
    EXPECT_LT((general.derivatives.tangent_hessian - g.derivatives->tangent_hessian).norm(),
              1e-11 * (1 + g.derivatives->tangent_hessian.norm()))
        << i;
  }
}

TEST(Mollifier, IsTheIdentityInTheMiddleAndFlatAtTheEnds) {
  for (const double epsilon : {1e-6, 1e-2, 0.5}) {
    EXPECT_EQ(mollify(0, epsilon).value, 0);
    EXPECT_EQ(mollify(0, epsilon).slope, 0);
    EXPECT_NEAR(mollify(1, epsilon).value, 1, 1e-15);
    EXPECT_EQ(mollify(1, epsilon).slope, 0);
    EXPECT_EQ(mollify(0.5, epsilon).value, 0.5);
    for (const double t : {epsilon, 1 - epsilon}) {
      EXPECT_NEAR(mollify(t, epsilon).value, t, 1e-15);
      EXPECT_NEAR(mollify(t * (1 - 1e-12), epsilon).slope, 1, 1e-9);
    }
    for (const double t : {0.3 * epsilon, 0.9 * epsilon, 1 - 0.7 * epsilon}) {
      const double h = 1e-5 * epsilon;
      const double slope = (mollify(t + h, epsilon).value - mollify(t - h, epsilon).value) / (2 * h);
      const double curvature = (mollify(t + h, epsilon).slope - mollify(t - h, epsilon).slope) / (2 * h);
      EXPECT_NEAR(mollify(t, epsilon).slope, slope, 1e-4);
      EXPECT_NEAR(mollify(t, epsilon).curvature * epsilon, curvature * epsilon, 1e-4);
    }
  }
}

TEST(Mollifier, ChangesNothingForPathsAwayFromVertices) {
  const auto mesh = share(testing::torus(24, 12));
  const GeodesicSolver solver(mesh);
  RandomStream stream("mollified", 26);
  int compared = 0;
  for (int i = 0; i < 60; ++i) {
    const SurfacePoint a = testing::random_point(*mesh, stream);
    const SurfacePoint b = testing::random_point(*mesh, stream);
    const Geodesic g = solver.geodesic(a, b, {.derivatives = 2, .path = true});
    bool away = g.distance > mesh->mean_edge_length();
    for (std::size_t k = 1; k + 1 < g.path.size(); ++k) away = away && g.path[k].point.barycentric.maxCoeff() < 0.999;
    if (!away) continue;
    const Geodesic mollified = solver.geodesic(a, b, {.derivatives = 2, .mollifier = 1e-6});
    ASSERT_TRUE(mollified.mollified_distance);
    EXPECT_NEAR(*mollified.mollified_distance, g.distance, 1e-12 * g.distance);
    EXPECT_LT((mollified.derivatives->hessian - g.derivatives->hessian).norm(), 1e-7 * g.derivatives->hessian.norm());
    ++compared;
  }
  EXPECT_GT(compared, 20);
}

/// Compares the derivatives of the mollified distance with fourth-order central differences. Returns whether the path
/// crosses the same edges on all steps, on the same side of the blend's ends, so that all of them exist.
bool expect_mollified_derivatives(const GeodesicSolver& solver, const SurfacePoint& a, const SurfacePoint& b,
                                  double epsilon, bool ends = false) {
  const auto edges = [&](const Geodesic& g) {
    std::vector<int> passed;
    for (std::size_t k = 1; k + 1 < g.path.size(); ++k) {
      const PathPoint& p = g.path[k];
      passed.push_back(index(p.vertex));
      if (p.vertex != VertexId::none) continue;
      const double t = p.point.barycentric.maxCoeff();
      passed.push_back(3 * index(p.point.face) + side_of(p.point));
      passed.push_back(t > 1 - epsilon);
    }
    return passed;
  };
  const GeodesicOptions options{.derivatives = 2, .path = true, .mollifier = epsilon, .mollified_ends = ends};
  const Geodesic g = solver.geodesic(a, b, options);
  const double h = 1e-4 * epsilon;
  for (int variable = 0; variable < 4; ++variable) {
    const int end = variable / 2;
    const Vector3d& direction = kDirections[variable % 2];
    Eigen::Matrix<double, 6, 1> along = Eigen::Matrix<double, 6, 1>::Zero();
    along.segment<3>(3 * end) = direction;
    const auto at = [&](double step) {
      return end == 0 ? solver.geodesic(moved(a, step * direction), b, options)
                      : solver.geodesic(a, moved(b, step * direction), options);
    };
    const Geodesic m2 = at(-2 * h), m1 = at(-h), p1 = at(h), p2 = at(2 * h);
    for (const Geodesic* step : {&m2, &m1, &p1, &p2}) {
      if (edges(*step) != edges(g)) return false;
    }
    const double first =
        (*m2.mollified_distance - 8 * *m1.mollified_distance + 8 * *p1.mollified_distance - *p2.mollified_distance) /
        (12 * h);
    const double scale = direction.norm() * solver.mesh().mean_edge_length();
    EXPECT_NEAR(g.derivatives->gradient.dot(along), first, 1e-11 / h * scale) << epsilon;
    const Eigen::Matrix<double, 6, 1> second = (m2.derivatives->gradient - 8 * m1.derivatives->gradient +
                                                8 * p1.derivatives->gradient - p2.derivatives->gradient) /
                                               (12 * h);
    for (int other = 0; other < 4; ++other) {
      Eigen::Matrix<double, 6, 1> test = Eigen::Matrix<double, 6, 1>::Zero();
      test.segment<3>(3 * (other / 2)) = kDirections[other % 2];
      const double size = scale * kDirections[other % 2].norm() * solver.mesh().mean_edge_length();
      const double bound = size * (1 + g.derivatives->tangent_hessian.norm());
      EXPECT_NEAR(test.dot(g.derivatives->hessian * along), second.dot(test), 1e-4 * bound) << epsilon;
    }
  }
  return true;
}

TEST(Mollifier, DerivativesAreThoseOfTheMollifiedDistance) {
  for (const auto& mesh : {share(testing::icosphere(2)), share(testing::torus(24, 12)), share(testing::saddle(8)),
                           share(testing::l_shape(3)), share(testing::cone(12, 8.5, 3))}) {
    const GeodesicSolver solver(mesh);
    RandomStream stream("mollified_derivatives", 27);
    for (const double epsilon : {0.5, 0.1, 0.03, 0.01}) {
      int checked = 0;
      for (int i = 0; i < 60; ++i) {
        const SurfacePoint a = testing::random_point(*mesh, stream);
        const SurfacePoint b = testing::random_point(*mesh, stream);
        if (smallest(a) < 2e-3 || smallest(b) < 2e-3) continue;
        const Geodesic g = solver.geodesic(a, b);
        if (g.competing_excess < 5e-3 * mesh->mean_edge_length() || g.distance < 0.3 * mesh->mean_edge_length()) {
          continue;
        }
        checked += expect_mollified_derivatives(solver, a, b, epsilon);
      }
      EXPECT_GT(checked, 20) << epsilon;
    }
  }
}

TEST(Mollifier, OfTheEndsHasExactDerivativesToo) {
  for (const auto& mesh : {share(testing::icosphere(2)), share(testing::torus(24, 12)), share(testing::saddle(8)),
                           share(testing::cone(12, 8.5, 3))}) {
    const GeodesicSolver solver(mesh);
    RandomStream stream("mollified_ends", 29);
    for (const double epsilon : {0.4, 0.2, 0.05}) {
      int checked = 0;
      for (int i = 0; i < 80; ++i) {
        const SurfacePoint a = testing::random_point(*mesh, stream);
        const SurfacePoint b = testing::random_point(*mesh, stream);
        const Geodesic g = solver.geodesic(a, b);
        bool kinked = smallest(a) < 2e-3 || smallest(b) < 2e-3;
        for (const double w : {a.barycentric[0], a.barycentric[1], a.barycentric[2], b.barycentric[0], b.barycentric[1],
                               b.barycentric[2]}) {
          kinked = kinked || std::abs(w - epsilon) < 2e-3 || std::abs(1 - epsilon - w) < 2e-3;
        }
        if (kinked || g.competing_excess < 5e-3 * mesh->mean_edge_length() ||
            g.distance < 0.3 * mesh->mean_edge_length()) {
          continue;
        }
        checked += expect_mollified_derivatives(solver, a, b, epsilon, true);
      }
      EXPECT_GT(checked, 20) << epsilon;
    }
  }
}

// What speaks against it: on an edge, the pull off the edge vanishes.
TEST(Mollifier, OfTheEndsLeavesNoGradientOffAnEdge) {
  const auto mesh = share(testing::icosphere(2));
  const GeodesicSolver solver(mesh);
  RandomStream stream("stationary", 30);
  int checked = 0;
  for (int i = 0; i < 50; ++i) {
    const SurfacePoint a = testing::random_edge_point(*mesh, stream), b = testing::random_point(*mesh, stream);
    if (a.barycentric.maxCoeff() > 0.9) continue;
    const Geodesic exact = solver.geodesic(a, b, {.derivatives = 1});
    const Geodesic ends = solver.geodesic(a, b, {.derivatives = 1, .mollifier = 1e-5, .mollified_ends = true});
    // Towards the corner opposite, and along the edge.
    const int side = side_of(a);
    const Triangle& corners = mesh->faces()[index(a.face)];
    const auto pull = [&](const Geodesic& g, const Vector3d& direction) {
      const Vector2d along = tangent_frame(*mesh, a.face).transpose() * direction.normalized();
      return g.derivatives->tangent_gradient.head<2>().dot(along);
    };
    const Vector3d off = mesh->positions()[corners[(side + 2) % 3]] - position(*mesh, a);
    const Vector3d edge = mesh->positions()[corners[(side + 1) % 3]] - mesh->positions()[corners[side]];
    if (std::abs(pull(exact, off)) < 0.1) continue;
    ++checked;
    EXPECT_LT(std::abs(pull(ends, off)), 1e-9);
    EXPECT_NEAR(pull(ends, edge), pull(exact, edge), 1e-9);
  }
  EXPECT_GT(checked, 20);
}

// Where a path comes to be held by a hyperbolic vertex, it meets all edges between at their ends.
TEST(Mollifier, GradientsAreContinuousWhereAHyperbolicVertexBeginsToHoldThePath) {
  const auto mesh = share(testing::cone(12, 8.5, 3));
  const GeodesicSolver solver(mesh);
  RandomStream stream("hyperbolic", 28);
  int found = 0, checked = 0;
  for (int i = 0; i < 2000 && found < 40; ++i) {
    const SurfacePoint a = testing::random_point(*mesh, stream);
    SurfacePoint free = testing::random_point(*mesh, stream);
    SurfacePoint held{free.face, testing::random_point(*mesh, stream).barycentric};
    if (!solver.geodesic(a, free).pinned_at.empty()) std::swap(free, held);
    if (!solver.geodesic(a, free).pinned_at.empty() || solver.geodesic(a, held).pinned_at.empty()) continue;
    if (position(*mesh, a).norm() < 0.2 || position(*mesh, free).norm() < 0.2) continue;
    ++found;
    // Towards the border of the vertex's shadow, from both sides.
    for (int halving = 0; halving < 40; ++halving) {
      if (halving == 4 && smallest(free) > 2e-3 && smallest(a) > 2e-3) {
        for (const double epsilon : {0.3, 0.1}) checked += expect_mollified_derivatives(solver, a, free, epsilon);
      }
      const SurfacePoint middle{free.face, 0.5 * (free.barycentric + held.barycentric)};
      (solver.geodesic(a, middle).pinned_at.empty() ? free : held) = middle;
    }
    for (const double epsilon : {0.3, 0.1, 0.01, 1e-4}) {
      const GeodesicOptions options{.derivatives = 2, .mollifier = epsilon};
      const Geodesic f = solver.geodesic(a, free, options), h = solver.geodesic(a, held, options);
      EXPECT_NEAR(*f.mollified_distance, *h.mollified_distance, 1e-10);
      EXPECT_LT((f.derivatives->tangent_gradient - h.derivatives->tangent_gradient).norm(), 1e-6)
          << i << " " << epsilon;
      EXPECT_TRUE(f.derivatives->hessian.allFinite());
    }
  }
  EXPECT_EQ(found, 40);
  EXPECT_GT(checked, 20);
}

}  // namespace
}  // namespace supple::surface
