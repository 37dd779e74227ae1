#pragma once

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
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

/// A mesh, a network on it, and what the equilibrium of every hard case must satisfy.
class NetworkCase {
 public:
  explicit NetworkCase(surface::TriangleMesh built) : mesh(testing::share(std::move(built))), solver(mesh) {}

  surface::SurfacePoint near(double x, double y, double z) const { return testing::nearest_point(*mesh, {x, y, z}); }

  /// Adds the pairs as springs of rest length 0 and weight 1.
  void join(const std::vector<Pair>& pairs) {
    for (const auto& [a, b] : pairs) network.springs.push_back({a, b, 0, 1});
  }
  /// Puts a point in each face, with springs to those of the neighbouring faces.
  void fill(const Eigen::Vector3d& barycentric) {
    network.points = points_in_faces(*mesh, barycentric);
    join(pairs_of_adjacent_faces(*mesh, network.points));
  }

  /// Adds points with a least distance and a membrane of all their triangles, whose rest lengths are the distances
  /// times `rest_scale`.
  void cover(double radius, double rest_scale, std::uint64_t seed = 1) {
    network.points = poisson_disk_points(solver, radius, seed);
    network.triangles =
        membrane_at_rest(solver, network.points, triangulate(solver, network.points).triangles, rest_scale);
  }

  /// The energy by its definition, with separate geodesic searches.
  double energy_at(const std::vector<surface::SurfacePoint>& points) const {
    double sum = 0;
    for (const Spring& s : network.springs) sum += energy_of(s, points);
    for (const MembraneTriangle& t : network.triangles) sum += energy_of(t, points);
    return sum;
  }

  /// The equilibrium, after checking that it is one: the search converged with a small gradient, the energy never
  /// increased and agrees with its definition, and up to 40 free points have no lower energy in any of 16 directions.
  Relaxation solve() const {
    const Relaxation relaxed = relax(solver, network, options);
    EXPECT_EQ(relaxed.stopped, RelaxationTermination::converged);
    check(relaxed);
    return relaxed;
  }

  /// The checks of `solve` for an answer that converged.
  void check(const Relaxation& relaxed) const {
    const double weight = largest_weight(network);
    EXPECT_LE(relaxed.gradient_norm, options.tolerance * weight * mesh->diagonal());
    for (std::size_t i = 1; i < relaxed.history.size(); ++i)
      EXPECT_LE(relaxed.history[i].energy, relaxed.history[i - 1].energy * (1 + 1e-12));
    const double energy = energy_at(relaxed.points);
    // The definition of a membrane's energy by C suffers from cancellation at small strains.
    const double rounding = network.triangles.empty() ? 1e-20 : 1e-16;
    EXPECT_NEAR(relaxed.energy, energy, 1e-10 * energy + rounding * weight * mesh->diagonal() * mesh->diagonal());
    const std::size_t stride = std::max<std::size_t>(1, relaxed.points.size() / 40);
    for (std::size_t i = 0; i < relaxed.points.size(); i += stride)
      if (std::ranges::find(network.fixed_points, static_cast<std::int32_t>(i)) == network.fixed_points.end())
        expect_lowest_around(relaxed.points, i, weight);
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

  /// The vectors from corner 0 to corners 1 and 2 of a flat triangle with the sides (0, 1), (1, 2) and (2, 0), as
  /// columns.
  static Eigen::Matrix2d flat(const std::array<double, 3>& sides) {
    const auto& [a, b, c] = sides;
    const double x = (a * a + c * c - b * b) / (2 * a);
    Eigen::Matrix2d corners;
    corners << a, x, 0, std::sqrt(std::max(0.0, c * c - x * x));
    return corners;
  }

  double energy_of(const MembraneTriangle& t, const std::vector<surface::SurfacePoint>& points) const {
    std::array<double, 3> sides;
    const auto at = [&](std::size_t k) { return points[static_cast<std::size_t>(t.corners[k % 3])]; };
    for (std::size_t k = 0; k < 3; ++k) sides[k] = solver.distance(at(k), at(k + 1));
    const Eigen::Matrix2d rest = flat(t.rest_lengths);
    const Eigen::Matrix2d f = flat(sides) * rest.inverse();
    const auto& [modulus, ratio, thickness] = network.material;
    const double mu = modulus / (2 * (1 + ratio));
    const double lambda = modulus * ratio / ((1 + ratio) * (1 - 2 * ratio));
    const double log_j = std::log(f.determinant());
    const double density = mu / 2 * (f.squaredNorm() - 2 - 2 * log_j) + lambda / 2 * log_j * log_j;
    return thickness * rest.determinant() / 2 * density;
  }

  void expect_lowest_around(const std::vector<surface::SurfacePoint>& points, std::size_t i, double weight) const {
    const auto own_energy = [&](const std::vector<surface::SurfacePoint>& at) {
      double sum = 0;
      for (const Spring& s : network.springs)
        if (static_cast<std::size_t>(s.from) == i || static_cast<std::size_t>(s.to) == i) sum += energy_of(s, at);
      for (const MembraneTriangle& t : network.triangles)
        if (std::ranges::find(t.corners, static_cast<std::int32_t>(i)) != t.corners.end()) sum += energy_of(t, at);
      return sum;
    };
    const double here = own_energy(points);
    const double length = 1e-4 * mesh->mean_edge_length();
    for (int k = 0; k < 16; ++k) {
      const double angle = 2 * std::numbers::pi * (k + 0.37) / 16;
      const Eigen::Vector3d direction =
          surface::tangent_frame(*mesh, points[i].face) * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      auto beside = points;
      beside[i] = surface::exponential_map(*mesh, points[i], length * direction, {}, false).end;
      // The remaining gradient and rounding may lower the energy by this much.
      const double slack = options.tolerance * weight * mesh->diagonal() * length + 1e-13 * here;
      EXPECT_GE(own_energy(beside), here - slack) << "point " << i << " direction " << k;
    }
  }
};

}  // namespace supple::embedded
