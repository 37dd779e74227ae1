// What the elements add to the energy and its derivatives, as their points can move.
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "geodesic_elements.h"

namespace supple::embedded {
namespace {

/// A barycentric coordinate up to which a point is on the side: rounding leaves one there that slides along it.
constexpr double on_border = 1e-12;
/// How much stiffer than along it points are across a cut locus: a Newton step then leaves it by no more than rounding
/// and its curvature, and factorizations keep the digits that they need.
constexpr double stiffness_across = 1e4;
/// A slope above this share of the pulls that make it counts as none.
constexpr double slope_rounding = 1e-12;

}  // namespace

void GeodesicElements::add(const NetworkState& state, int order, numerics::EnergySum& sum) const {
  if (state.collapsed()) {
    sum.value = std::numeric_limits<double>::infinity();
    return;
  }
  const Walls walls = order >= 1 ? walls_at(state) : Walls();
  add_elements(state, order, walls, sum);
  if (order < 1 || !std::isfinite(sum.value)) return;
  for (const std::size_t point : free_)
    if (state.on_tip(point)) add_on_tip(state, point, order, sum);
  if (order >= 2) hold_at_cut_loci(state, sum);
  for (const Wall& wall : walls) {
    if (order < 2) break;
    // Nothing moves there: any stiffness will do.
    const double stiffness = stiffness_at(static_cast<std::size_t>(wall.point));
    for (int k = 0; k < 2; ++k)
      for (int l = 0; l <= k; ++l)
        sum.hessian.add(2 * wall.point + k, 2 * wall.point + l, stiffness * wall.out[k] * wall.out[l]);
  }
}

void GeodesicElements::hold_at_cut_loci(const NetworkState& state, numerics::EnergySum& sum) const {
  for (const EqualPaths& equal : state.found()->equal) {
    const auto from = static_cast<std::size_t>(paths_[equal.path].from);
    const auto to = static_cast<std::size_t>(paths_[equal.path].to);
    const double stiffness = stiffness_across * (stiffness_at(from) + stiffness_at(to));
    SpringElement element({paths_[equal.path].from, paths_[equal.path].to});
    for (const Eigen::Vector4d& across : equal.across) element.hessian += stiffness * across * across.transpose();
    element.add_to(sum, 2);
  }
}

void GeodesicElements::add_elements(const NetworkState& state, int order, const Walls& walls,
                                    numerics::EnergySum& sum) const {
  if (state.surface()) {
    add_on_host(state, order, walls, sum);
  } else {
    add_on_rigid_host(state, order, walls, sum);
  }
}

GeodesicElements::Walls GeodesicElements::walls_at(const NetworkState& state) const {
  Walls walls;
  const surface::TriangleMesh& mesh = state.mesh();
  for (const std::size_t point : free_) {
    if (state.on_tip(point)) continue;
    const surface::SurfacePoint& at = state.points()[point];
    for (int corner = 0; corner < 3; ++corner) {
      // The side opposite a corner is that of the next one.
      const std::int32_t side = 3 * index(at.face) + (corner + 1) % 3;
      if (at.barycentric[corner] > on_border || mesh.twin(side) >= 0) continue;
      const Eigen::Matrix<double, 3, 2> frame = surface::tangent_frame(mesh, at.face);
      const Eigen::Vector2d along =
          frame.transpose() * (mesh.positions()[mesh.head(side)] - mesh.positions()[mesh.tail(side)]);
      walls.push_back({static_cast<std::int32_t>(point), Eigen::Vector2d(along.y(), -along.x()).normalized()});
      break;
    }
  }
  if (walls.empty()) return walls;
  // Those that are pushed inwards, or not at all, are free.
  numerics::EnergySum free;
  free.clear(state.dimension(), 1);
  add_elements(state, 1, {}, free);
  std::erase_if(walls, [&](const Wall& wall) {
    return !std::isfinite(free.value) || !(free.gradient.segment<2>(2 * wall.point).dot(wall.out) < 0);
  });
  return walls;
}

const GeodesicElements::Wall* GeodesicElements::wall_of(const Walls& walls, std::int32_t point) {
  const auto found = std::ranges::lower_bound(walls, point, {}, &Wall::point);
  return found != walls.end() && found->point == point ? &*found : nullptr;
}

void GeodesicElements::add_on_rigid_host(const NetworkState& state, int order, const Walls& walls,
                                         numerics::EnergySum& sum) const {
  const FoundPaths& found = *state.found();
  const auto as_free = [&](auto& element, int corner, std::int32_t point) {
    if (order < 1) return;
    if (state.on_tip(static_cast<std::size_t>(point))) element.take_out(corner);
    if (const Wall* wall = wall_of(walls, point)) element.hold(corner, wall->out);
  };
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    SpringElement element = spring_at(found, i, order);
    if (!found.geodesics[i].coincident()) {
      as_free(element, 0, springs_[i].from);
      as_free(element, 1, springs_[i].to);
    }
    element.add_to(sum, order);
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    TriangleElement element = triangle_at(found, t, order);
    for (int k = 0; k < 3; ++k) as_free(element, k, triangles_[t].given.corners[static_cast<std::size_t>(k)]);
    element.add_to(sum, order);
  }
}

void GeodesicElements::add_on_host(const NetworkState& state, int order, const Walls& walls,
                                   numerics::EnergySum& sum) const {
  const auto as_free = [&](HostElement element, std::span<const std::int32_t> points) {
    for (const std::int32_t point : points) {
      if (order < 1) break;
      if (state.on_tip(static_cast<std::size_t>(point))) element.take_out(point);
      if (const Wall* wall = wall_of(walls, point)) element.hold(point, wall->out);
    }
    return element;
  };
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    if (state.found()->geodesics[i].coincident()) {
      // One place of the material stays one place, however the host moves.
      spring_at(*state.found(), i, order).add_to(sum, order);
      continue;
    }
    const std::array<std::int32_t, 2> ends{springs_[i].from, springs_[i].to};
    as_free(host_spring_at(state, i, order, sum.convex), ends).add_to(sum, order);
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const HostElement element = host_triangle_at(state, t, order, sum.convex);
    if (!std::isfinite(element.value)) {
      sum.value = element.value;
      return;
    }
    as_free(element, triangles_[t].given.corners).add_to(sum, order);
  }
}

GeodesicElements::Arrivals GeodesicElements::arrivals_at(std::size_t point, const PathOf& path) const {
  Arrivals arrivals;
  const auto arrive = [&](const surface::TangentGeodesic& geodesic, std::size_t number, double pull) {
    if (geodesic.coincident()) return;
    arrivals.parted = true;
    const double angle =
        static_cast<std::size_t>(paths_[number].from) == point ? geodesic.from_angle : geodesic.to_angle;
    if (std::isfinite(angle)) arrivals.paths.push_back({angle, pull});
  };
  for (const std::int32_t s : springs_at_[point]) {
    const auto i = static_cast<std::size_t>(s);
    const surface::TangentGeodesic& geodesic = path(i);
    arrive(geodesic, i, 2 * springs_[i].weight * (geodesic.distance - springs_[i].rest_length));
    arrivals.stiffness += 2 * springs_[i].weight;
    // Points in one place rest together, unless their spring pushes them apart.
    if (geodesic.coincident() && springs_[i].rest_length > 0) arrivals.valid = false;
  }
  for (const std::int32_t t : triangles_at_[point]) {
    const Triangle& triangle = triangles_[static_cast<std::size_t>(t)];
    Eigen::Vector3d lengths;
    for (int k = 0; k < 3; ++k) lengths[k] = path(triangle.sides[static_cast<std::size_t>(k)].path).distance;
    const TriangleEnergy::Value energy = triangle.energy.at(lengths);
    arrivals.valid = arrivals.valid && std::isfinite(energy.energy);
    for (int k = 0; k < 3; ++k) {
      const Side& side = triangle.sides[static_cast<std::size_t>(k)];
      const Ends& ends = paths_[side.path];
      if (static_cast<std::size_t>(ends.from) != point && static_cast<std::size_t>(ends.to) != point) continue;
      arrive(path(side.path), side.path, energy.first[k]);
      arrivals.stiffness += std::max(0.0, energy.second(k, k));
    }
  }
  return arrivals;
}

void GeodesicElements::add_on_tip(const NetworkState& state, std::size_t point, int order,
                                  numerics::EnergySum& sum) const {
  const FoundPaths& found = *state.found();
  const Arrivals arrivals =
      arrivals_at(point, [&](std::size_t path) -> const surface::TangentGeodesic& { return found.geodesics[path]; });
  // Springs to points in the same place are differentiable there.
  if (!arrivals.parted) return;
  const surface::VertexCone cone(state.mesh(), state.vertex_of(point));
  const auto row = 2 * static_cast<Eigen::Index>(point);
  if (!arrivals.paths.empty()) {
    const surface::SteepestDescent descent = surface::steepest_descent(cone, arrivals.paths);
    double pulls = 0;
    for (const surface::ArrivingPath& arrival : arrivals.paths) pulls += std::abs(arrival.weight);
    if (descent.slope < -slope_rounding * pulls)
      sum.gradient.segment<2>(row) += descent.slope * surface::cone_coordinates(cone, descent.angle);
  }
  if (order < 2) return;
  // The Hessian of flat pieces: the way down is as long as if the surface were flat.
  for (int k = 0; k < 2; ++k) sum.hessian.add(row + k, row + k, arrivals.stiffness);
}

}  // namespace supple::embedded
