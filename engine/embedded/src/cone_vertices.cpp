#include "cone_vertices.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace supple::embedded {
namespace {

/// Directional derivatives below this fraction of the summed path forces are rounding.
constexpr double slope_rounding = 1e-12;

}  // namespace

ConeForces cone_forces(const ElasticNetwork& network, std::size_t point, const PathLookup& path) {
  ConeForces forces;
  const auto add_path = [&](std::size_t number, double force) {
    const surface::TangentGeodesic& geodesic = path(number);
    if (geodesic.coincident()) return;
    forces.has_separate_end = true;
    const bool starts_here = static_cast<std::size_t>(network.paths()[number].from) == point;
    const double angle = starts_here ? geodesic.from_angle : geodesic.to_angle;
    if (std::isfinite(angle)) forces.paths.push_back({angle, force});
  };
  for (const std::int32_t s : network.springs_at(point)) {
    const auto i = static_cast<std::size_t>(s);
    const Spring& spring = network.springs()[i];
    add_path(i, 2 * spring.weight * (path(i).distance - spring.rest_length));
    if (!path(i).coincident()) {
      forces.stiffness += 2 * spring.weight;
    } else if (spring.rest_length > 0) {
      // Points in one place rest together, unless their spring pushes them apart.
      forces.is_valid = false;
    }
  }
  for (const std::int32_t t : network.triangles_at(point)) {
    const ElasticNetwork::Triangle& triangle = network.triangles()[static_cast<std::size_t>(t)];
    Eigen::Vector3d lengths;
    for (int k = 0; k < 3; ++k) lengths[k] = path(triangle.sides[static_cast<std::size_t>(k)].path).distance;
    const TriangleEnergy::Value energy = triangle.energy.at(lengths);
    forces.is_valid = forces.is_valid && std::isfinite(energy.energy);
    for (int k = 0; k < 3; ++k) {
      const std::size_t side = triangle.sides[static_cast<std::size_t>(k)].path;
      const ElasticNetwork::PathEnds& ends = network.paths()[side];
      if (static_cast<std::size_t>(ends.from) != point && static_cast<std::size_t>(ends.to) != point) continue;
      add_path(side, energy.first[k]);
      forces.stiffness += std::max(0.0, energy.second(k, k));
    }
  }
  return forces;
}

void add_cone_vertex(const ElasticNetwork& network, const NetworkState& state, std::size_t point, int order,
                     numerics::EnergySum& sum) {
  const FoundPaths& found = *state.found();
  const ConeForces forces = cone_forces(
      network, point, [&](std::size_t path) -> const surface::TangentGeodesic& { return found.geodesics[path]; });
  // The energy of springs whose ends all lie in this place is differentiable, and the elements have added it.
  if (!forces.has_separate_end) return;
  const surface::VertexCone cone(state.mesh(), state.vertex_of(point));
  const auto row = 2 * static_cast<Eigen::Index>(point);
  if (!forces.paths.empty()) {
    const surface::SteepestDescent descent = surface::steepest_descent(cone, forces.paths);
    double total = 0;
    for (const surface::ArrivingPath& arrival : forces.paths) total += std::abs(arrival.weight);
    if (descent.slope < -slope_rounding * total)
      sum.gradient.segment<2>(row) += descent.slope * surface::cone_coordinates(cone, descent.angle);
  }
  if (order < 2) return;
  for (int k = 0; k < 2; ++k) sum.hessian.add(row + k, row + k, forces.stiffness);
}

bool rests_at_vertex(const ElasticNetwork& network, const surface::GeodesicSolver& solver, const NetworkState& state,
                     std::size_t point, std::int32_t vertex) {
  const surface::SurfacePoint at = surface::vertex_point(state.mesh(), VertexId{vertex});
  const surface::VertexCone cone(state.mesh(), vertex);
  std::map<std::size_t, surface::TangentGeodesic> from_vertex;
  const auto path = [&](std::size_t number) -> const surface::TangentGeodesic& {
    const ElasticNetwork::PathEnds& ends = network.paths()[number];
    const bool starts_here = static_cast<std::size_t>(ends.from) == point;
    if (!starts_here && static_cast<std::size_t>(ends.to) != point) return state.found()->geodesics[number];
    const auto [entry, is_new] = from_vertex.try_emplace(number);
    if (is_new) {
      const auto place_of = [&](std::int32_t end) { return state.points()[static_cast<std::size_t>(end)]; };
      const surface::PointPair pair{starts_here ? at : place_of(ends.from), starts_here ? place_of(ends.to) : at};
      solver.tangent_geodesics({&pair, 1}, {&entry->second, 1}, false);
    }
    return entry->second;
  };
  const ConeForces forces = cone_forces(network, point, path);
  return forces.is_valid && !forces.paths.empty() && surface::steepest_descent(cone, forces.paths).slope >= 0;
}

}  // namespace supple::embedded
