#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

#include "supple/embedded/network_builders.h"
#include "supple/embedded/relaxation.h"
#include "supple/surface/exponential_map.h"
#include "support/nearest_point.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::embedded {

/// A mesh, a network on it, and what the rest of every hard case must satisfy.
class NetworkCase {
 public:
  explicit NetworkCase(surface::TriangleMesh built) : mesh(testing::share(std::move(built))), solver(mesh) {}

  surface::SurfacePoint near(double x, double y, double z) const { return testing::nearest_point(*mesh, {x, y, z}); }

  /// The pairs as springs of rest length 0 and weight 1.
  void join(const std::vector<Pair>& pairs) {
    for (const auto& [a, b] : pairs) network.springs.push_back({a, b, 0, 1});
  }
  /// A point in each face, joined to those of the neighbours.
  void fill(const Eigen::Vector3d& barycentric) {
    network.points = points_in_faces(*mesh, barycentric);
    join(pairs_of_adjacent_faces(*mesh, network.points));
  }

  /// By the definition, with searches of their own.
  double energy_at(const std::vector<surface::SurfacePoint>& points) const {
    double sum = 0;
    for (const Spring& s : network.springs) sum += energy_of(s, points);
    return sum;
  }

  /// The rest, after checking that it is one: converged with a small gradient, never rising, an energy that the
  /// definition confirms, and for up to 40 of the free points no lower energy in any of 16 directions.
  Relaxation solve() const {
    const Relaxation relaxed = relax(solver, network, options);
    EXPECT_EQ(relaxed.stopped, "converged");
    double weight = 0;
    for (const Spring& s : network.springs) weight = std::max(weight, s.weight);
    EXPECT_LE(relaxed.gradient_norm, options.tolerance * weight * mesh->diagonal());
    for (std::size_t i = 1; i < relaxed.history.size(); ++i)
      EXPECT_LE(relaxed.history[i].energy, relaxed.history[i - 1].energy * (1 + 1e-12));
    const double energy = energy_at(relaxed.points);
    EXPECT_NEAR(relaxed.energy, energy, 1e-10 * energy + 1e-20 * weight * mesh->diagonal() * mesh->diagonal());
    const std::size_t stride = std::max<std::size_t>(1, relaxed.points.size() / 40);
    for (std::size_t i = 0; i < relaxed.points.size(); i += stride)
      if (std::ranges::find(network.fixed_points, static_cast<std::int32_t>(i)) == network.fixed_points.end())
        expect_lowest_around(relaxed.points, i, weight);
    return relaxed;
  }

  std::shared_ptr<const surface::TriangleMesh> mesh;
  surface::GeodesicSolver solver;
  Network network;
  RelaxationOptions options;

 private:
  double energy_of(const Spring& s, const std::vector<surface::SurfacePoint>& points) const {
    const double excess =
        solver.distance(points[static_cast<std::size_t>(s.from)], points[static_cast<std::size_t>(s.to)]) -
        s.rest_length;
    return s.weight * excess * excess;
  }

  void expect_lowest_around(const std::vector<surface::SurfacePoint>& points, std::size_t i, double weight) const {
    const auto own_energy = [&](const std::vector<surface::SurfacePoint>& at) {
      double sum = 0;
      for (const Spring& s : network.springs)
        if (static_cast<std::size_t>(s.from) == i || static_cast<std::size_t>(s.to) == i) sum += energy_of(s, at);
      return sum;
    };
    const double here = own_energy(points);
    const double length = 1e-4 * mesh->mean_edge_length();
    for (int k = 0; k < 16; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.37) / 16;
      const Eigen::Vector3d direction =
          surface::tangent_frame(*mesh, points[i].face) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      auto beside = points;
      beside[i] = surface::exponential_map(*mesh, points[i], length * direction, false).end;
      // The gradient that is left may lower it by this much, and rounding.
      const double slack = options.tolerance * weight * mesh->diagonal() * length + 1e-13 * here;
      EXPECT_GE(own_energy(beside), here - slack) << "point " << i << " direction " << k;
    }
  }
};

}  // namespace supple::embedded
