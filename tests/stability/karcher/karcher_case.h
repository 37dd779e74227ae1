#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "supple/surface/exponential_map.h"
#include "supple/surface/karcher_mean.h"
#include "support/nearest_point.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::surface {

/// A mesh, a problem on it, and what every mean of a hard case must satisfy.
class KarcherCase {
 public:
  explicit KarcherCase(TriangleMesh built)
      : mesh(std::make_shared<const TriangleMesh>(std::move(built))), solver(mesh) {}

  SurfacePoint near(double x, double y, double z) const { return testing::nearest_point(*mesh, {x, y, z}); }

  double objective_at(const SurfacePoint& p) const {
    double sum = 0;
    double weights = 0;
    for (std::size_t i = 0; i < problem.points.size(); ++i) {
      const double w = problem.weights.empty() ? 1 : problem.weights[i];
      const double g = solver.distance(problem.points[i], p);
      sum += w * g * g;
      weights += w;
    }
    return sum / (2 * weights);
  }

  /// The mean, after checking that it stopped at a minimum: small slope, no lower value in any of 24 directions at two
  /// radii, not above its start, and an objective that the definition confirms.
  KarcherMean solve() const {
    const KarcherMean mean = karcher_mean(solver, problem);
    EXPECT_TRUE(mean.stopped == KarcherTermination::converged || mean.stopped == KarcherTermination::kink)
        << to_string(mean.stopped);
    EXPECT_LE(mean.gradient_norm, problem.tolerance * mesh->diagonal());
    EXPECT_LE(mean.objective, mean.history.front().objective);
    const double rounding = 1e-12 * (1 + mean.objective);
    EXPECT_NEAR(mean.objective, objective_at(mean.mean), rounding);
    for (const double radius : {1e-4, 1e-6}) {
      for (int k = 0; k < 24; ++k) {
        const double angle = 2 * std::numbers::pi * (k + 0.37) / 24;
        const Eigen::Vector3d direction =
            tangent_frame(*mesh, mean.mean.face) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
        const double length = radius * mesh->mean_edge_length();
        const SurfacePoint beside = exponential_map(*mesh, mean.mean, length * direction, {}, false).end;
        EXPECT_GE(objective_at(beside), mean.objective - rounding) << "radius " << radius << " direction " << k;
      }
    }
    return mean;
  }

  std::shared_ptr<const TriangleMesh> mesh;
  GeodesicSolver solver;
  KarcherProblem problem;
};

}  // namespace supple::surface
