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

/// Random points with a least distance; see poisson_disk_points.
struct PoissonDiskPoints {
  double radius = 0;  ///< least distance of two points, mesh units
  std::uint64_t seed = 1;
};

/// Equal springs between neighbours: pairs_of_adjacent_faces, or the edges of triangulate.
struct NeighbourSprings {
  enum class Kind { adjacent_faces, voronoi_dual } kind = Kind::adjacent_faces;
  double rest_length = 0;  ///< mesh units
  double weight = 1;       ///< energy per squared mesh unit
};

/// Triangles that `triangulate` finds.
struct DualTriangles {};

/// A network whose points, springs and triangles are each a list or follow a rule.
struct NetworkPlan {
  std::variant<std::vector<surface::SurfacePoint>, PointsInFaces, PoissonDiskPoints> points;
  std::variant<std::vector<Spring>, NeighbourSprings> springs;
  std::vector<std::int32_t> fixed_points{};
  /// Corners of the triangles, whose rest lengths are the distances of the points at the start times `rest_scale`.
  std::variant<std::vector<std::array<std::int32_t, 3>>, DualTriangles> triangles{};
  double rest_scale = 1;
  MembraneMaterial material{};

  /// Whether there is anything to compute: a rule to follow, or triangles whose sides must be measured.
  bool builds() const { return points.index() > 0 || springs.index() > 0 || has_membrane(); }
  bool has_membrane() const { return triangles.index() > 0 || !std::get<0>(triangles).empty(); }
};

/// Largest numbers of points, springs and triangles that a rule may build.
struct NetworkLimits {
  std::size_t points = 100'000;
  std::size_t springs = 300'000;
  std::size_t triangles = 300'000;
  /// Called with "points", "springs" or "triangles" and their number if a rule exceeds the limit, in most cases before
  /// it has built them. It must throw.
  std::function<void(std::string_view field, std::size_t count)> refuse;
};

struct BuiltNetwork {
  Network network;
  /// Corners, as indices of points, of the network's triangles; without these, of the triangulation that gave springs.
  std::optional<std::vector<std::array<std::int32_t, 3>>> triangles;
};

/// Builds the network of a plan. Throws what the rules and `limits.refuse` throw. Bills the stages "points", "springs"
/// and "triangles".
BuiltNetwork build_network(const surface::GeodesicSolver& solver, const NetworkPlan& plan, const NetworkLimits& limits,
                           const Execution& execution = {});

}  // namespace supple::embedded
