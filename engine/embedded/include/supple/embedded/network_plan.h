#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "supple/base/execution.h"
#include "supple/embedded/network.h"
#include "supple/surface/geodesic_solver.h"

namespace supple::embedded {

/// One point in each face; see points_in_faces.
struct PointsInFaces {
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
};

/// Random points that keep their distance; see poisson_disk_points.
struct PoissonDiskPoints {
  double radius = 0;  ///< mesh units
  std::uint64_t seed = 1;
};

/// Equal springs between neighbours: pairs_of_adjacent_faces, or the edges of triangulate.
struct NeighbourSprings {
  enum class Kind { adjacent_faces, voronoi_dual } kind = Kind::adjacent_faces;
  double rest_length = 0;  ///< mesh units
  double weight = 1;       ///< energy per squared mesh unit
};

/// A network whose points and springs are given one by one, or by a rule.
struct NetworkPlan {
  std::variant<std::vector<surface::SurfacePoint>, PointsInFaces, PoissonDiskPoints> points;
  std::variant<std::vector<Spring>, NeighbourSprings> springs;
  std::vector<std::int32_t> fixed_points{};

  /// Whether a rule is followed.
  bool builds() const { return points.index() > 0 || springs.index() > 0; }
};

/// How many points and springs a rule may make.
struct NetworkLimits {
  std::size_t points = 100'000;
  std::size_t springs = 300'000;
  /// Called with "points" or "springs" and their number where a rule makes more than that, mostly before it has made
  /// them; throws.
  std::function<void(std::string_view field, std::size_t count)> refuse;
};

struct BuiltNetwork {
  Network network;
  /// Indices of points, where the springs are those of a triangulation.
  std::optional<std::vector<std::array<std::int32_t, 3>>> triangles;
};

/// Throws what the rules throw and what `limits.refuse` throws. Bills the stages "points" and "springs".
BuiltNetwork build_network(const surface::GeodesicSolver& solver, const NetworkPlan& plan, const NetworkLimits& limits,
                           const Execution& execution = {});

}  // namespace supple::embedded
