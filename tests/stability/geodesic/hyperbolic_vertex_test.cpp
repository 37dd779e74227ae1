// A path is moved across a hyperbolic vertex: first it runs past it on one side, then the vertex holds it, then it runs
// past it on the other side. Hard: where holding begins and ends, the second derivatives of its length jump, from those
// of one straight segment to those of two that do not know of each other.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "supple/surface/geodesic_solver.h"
#include "support/shapes.h"

namespace supple::surface {
namespace {

using Eigen::Vector3d;
using testing::share;

/// Lengths and derivatives as the second end passes behind vertex 0 of a cone of four sectors: from one side of its
/// shadow to the other.
struct Crossing {
  std::shared_ptr<const TriangleMesh> mesh = share(testing::cone(4, 8.5));
  GeodesicSolver solver{mesh};

  /// The point at polar angle `angle` and distance r from vertex 0, in the developed cone.
  SurfacePoint at(double angle, double r) const {
    const std::int32_t first = mesh->outgoing(0);
    std::int32_t h = first;
    double rest = angle;
    while (rest > mesh->corner_angle(h)) {
      rest -= mesh->corner_angle(h);
      h = mesh->rotate(h);
    }
    // Both sides of the corner have length 1: b and c are the parts along them.
    const double whole = mesh->corner_angle(h);
    const double b = r * std::sin(whole - rest) / std::sin(whole), c = r * std::sin(rest) / std::sin(whole);
    SurfacePoint point{FaceId(TriangleMesh::face_of(h)), Vector3d::Zero()};
    point.barycentric[h % 3] = 1 - b - c;
    point.barycentric[(h + 1) % 3] = b;
    point.barycentric[(h + 2) % 3] = c;
    return point;
  }

  /// `offset` is the angle beyond the border of the shadow, at which the path comes to be held; negative before.
  Geodesic past(double offset, double epsilon) const {
    // The edges lie at multiples of 2.125, so that one or two of them are crossed before the shadow's border.
    return solver.geodesic(at(start, 0.4), at(start + std::numbers::pi + offset, 0.5),
                           {.derivatives = 2, .path = true, .mollifier = epsilon});
  }

  double start = 0.6;  ///< polar angle of the first end
};

/// The largest change from one sample to the next, over the largest change from the first sample.
struct Roughness {
  double value = 0, gradient = 0, hessian = 0;
};

Roughness roughness(const Crossing& crossing, double epsilon, double width, int samples) {
  std::vector<Geodesic> all;
  for (int i = 0; i <= samples; ++i) {
    // At the border itself both sides are meant: the samples lie beside it.
    all.push_back(crossing.past(width * (2 * (i + 0.25) / samples - 1), epsilon));
  }
  const auto value = [](const Geodesic& g) { return g.mollified_distance.value_or(g.distance); };
  double ranges[3] = {0, 0, 0}, steps[3] = {0, 0, 0};
  for (int i = 1; i <= samples; ++i) {
    const auto compare = [&](const Geodesic& a, const Geodesic& b, double* largest) {
      largest[0] = std::max(largest[0], std::abs(value(a) - value(b)));
      largest[1] = std::max(largest[1], (a.derivatives->tangent_gradient - b.derivatives->tangent_gradient).norm());
      largest[2] = std::max(largest[2], (a.derivatives->tangent_hessian - b.derivatives->tangent_hessian).norm());
    };
    compare(all[i], all[i - 1], steps);
    compare(all[i], all[0], ranges);
  }
  return {steps[0] / ranges[0], steps[1] / ranges[1], steps[2] / ranges[2]};
}

TEST(HyperbolicVertices, HoldPathsWithAJumpOfTheHessianThatTheMollifierRemovesWhereOneEdgeIsCrossed) {
  const Crossing crossing;
  ASSERT_TRUE(crossing.past(-1e-3, 0).pinned_at.empty());
  ASSERT_EQ(crossing.past(-1e-3, 0).path.size(), 3u);
  ASSERT_EQ(crossing.past(1e-3, 0).pinned_at.size(), 1u);
  for (const double epsilon : {0.05, 1e-2, 1e-4}) {
    const double width = 5 * epsilon;
    // Four times the samples: a quarter of the steps where there is continuity, all of a jump where there is none.
    const Roughness plain = roughness(crossing, 0, width, 1600);
    EXPECT_GT(plain.hessian, 0.5);
    const Roughness coarse = roughness(crossing, epsilon, width, 400);
    const Roughness fine = roughness(crossing, epsilon, width, 1600);
    EXPECT_LT(fine.value, 0.3 * coarse.value + 1e-12) << epsilon;
    EXPECT_LT(fine.gradient, 0.3 * coarse.gradient) << epsilon;
    EXPECT_LT(fine.hessian, 0.3 * coarse.hessian) << epsilon;
    EXPECT_LT(fine.hessian, 0.02) << epsilon;
  }
}

TEST(HyperbolicVertices, AreReachedByMollifiedDerivativesThatMeetThoseOfTheHeldPath) {
  const Crossing crossing;
  for (const double epsilon : {0.2, 1e-2, 1e-4, 1e-6}) {
    const Geodesic before = crossing.past(-1e-6 * epsilon, epsilon), after = crossing.past(1e-6 * epsilon, epsilon);
    ASSERT_TRUE(before.pinned_at.empty());
    ASSERT_EQ(after.pinned_at.size(), 1u);
    EXPECT_NEAR(*before.mollified_distance, *after.mollified_distance, 1e-11);
    EXPECT_LT((before.derivatives->tangent_gradient - after.derivatives->tangent_gradient).norm(),
              1e-5 * epsilon + 1e-11);
    EXPECT_LT((before.derivatives->tangent_hessian - after.derivatives->tangent_hessian).norm(), 1e-4) << epsilon;
  }
}

// A limit, not a promise: crossings that are mollified each by itself do not stay on one line.
TEST(HyperbolicVertices, LeaveAJumpOfTheMollifiedHessianWhereTwoEdgesAreCrossed) {
  Crossing crossing;
  crossing.start = 1.3;
  double last = 0;
  for (const double epsilon : {0.2, 2e-2, 2e-3}) {
    const Geodesic before = crossing.past(-1e-6 * epsilon, epsilon), after = crossing.past(1e-6 * epsilon, epsilon);
    ASSERT_EQ(before.path.size(), 4u);
    EXPECT_NEAR(*before.mollified_distance, *after.mollified_distance, 1e-11);
    EXPECT_LT((before.derivatives->tangent_gradient - after.derivatives->tangent_gradient).norm(), 1e-5);
    const double jump = (before.derivatives->tangent_hessian - after.derivatives->tangent_hessian).norm();
    EXPECT_TRUE(std::isfinite(jump));
    EXPECT_TRUE(last == 0 || std::abs(jump / last - 10) < 0.5) << jump / last;  // as 1 / epsilon
    last = jump;
  }
}

}  // namespace
}  // namespace supple::surface
