#include "supple/surface/vertex_cone.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace supple::surface {
namespace {

using std::numbers::pi;

/// Relative excess over the flat angle that counts as rounding, because total angles are sums of rounded corner angles.
constexpr double relative_angle_tolerance = 1e-12;

}  // namespace

VertexCone::VertexCone(const TriangleMesh& mesh, std::int32_t vertex) : mesh_(mesh), open_(mesh.is_boundary(vertex)) {
  const std::int32_t first = mesh.outgoing(vertex);
  for (std::int32_t h = first; h >= 0;) {
    sectors_.push_back({h, total_angle_});
    total_angle_ += mesh.corner_angle(h);
    h = mesh.rotate(h);
    if (h == first) break;
  }
}

bool VertexCone::bends_paths() const { return total_angle_ > (open_ ? pi : 2 * pi) * (1 + relative_angle_tolerance); }

double VertexCone::between(double a, double b) const {
  const double turn = std::abs(a - b);
  return open_ ? turn : std::min(turn, total_angle_ - turn);
}

double VertexCone::angle_to(const SurfacePoint& neighbour) const {
  const Triangle& face = mesh_.faces()[index(neighbour.face)];
  const Eigen::Vector3d to = position(mesh_, neighbour);
  for (const Sector& sector : sectors_) {
    const Triangle& corners = mesh_.faces()[TriangleMesh::face_of(sector.halfedge)];
    bool inside = true;
    for (int i = 0; i < 3; ++i)
      inside = inside && (neighbour.barycentric[i] == 0 || std::ranges::find(corners, face[i]) != corners.end());
    if (!inside) continue;
    const Eigen::Vector3d from = mesh_.positions()[mesh_.tail(sector.halfedge)];
    const Eigen::Vector3d along = mesh_.positions()[mesh_.head(sector.halfedge)] - from;
    const Eigen::Vector3d ray = to - from;
    if (ray.squaredNorm() == 0) return std::numeric_limits<double>::quiet_NaN();
    return sector.begin + std::atan2(along.cross(ray).norm(), along.dot(ray));
  }
  return std::numeric_limits<double>::quiet_NaN();
}

VertexCone::Direction VertexCone::direction(double angle) const {
  auto sector = std::ranges::upper_bound(sectors_, angle, {}, &Sector::begin);
  if (sector != sectors_.begin()) --sector;
  const std::int32_t h = sector->halfedge;
  const double within = std::clamp(angle - sector->begin, 0.0, mesh_.corner_angle(h));
  const Eigen::Vector3d from = mesh_.positions()[mesh_.tail(h)];
  const Eigen::Vector3d along = (mesh_.positions()[mesh_.head(h)] - from).normalized();
  const Eigen::Vector3d to_apex = mesh_.positions()[mesh_.tail(TriangleMesh::previous(h))] - from;
  const Eigen::Vector3d across = (to_apex - along.dot(to_apex) * along).normalized();
  Direction direction;
  direction.vertex.face = FaceId{TriangleMesh::face_of(h)};
  direction.vertex.barycentric = Eigen::Vector3d::Unit(h % 3);
  direction.vector = std::cos(within) * along + std::sin(within) * across;
  return direction;
}

SteepestDescent steepest_descent(const VertexCone& cone, std::span<const ArrivingPath> arrivals) {
  const double total = cone.total_angle();
  // Beyond this angle from an arrival, its term is constant (the path bends at the vertex), or the turn in the other
  // direction is shorter.
  const double reach = cone.open() ? pi : std::min(pi, total / 2);

  std::vector<double> breaks{0, total};
  for (const ArrivingPath& arrival : arrivals) {
    for (double b : {arrival.angle - reach, arrival.angle + reach}) {
      if (!cone.open()) b -= total * std::floor(b / total);
      if (b > 0 && b < total) breaks.push_back(b);
    }
  }
  std::ranges::sort(breaks);

  const auto derivative = [&](double u) {
    double sum = 0;
    for (const ArrivingPath& arrival : arrivals)
      sum -= arrival.weight * std::cos(std::min(cone.between(u, arrival.angle), pi));
    return sum;
  };
  SteepestDescent best{std::numeric_limits<double>::infinity(), 0};
  const auto consider = [&](double u) {
    const double slope = derivative(u);
    if (slope < best.slope) best = {slope, u};
  };

  consider(0);
  for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
    const double begin = breaks[i];
    const double end = breaks[i + 1];
    consider(end);
    // Within the interval, every term is constant or -w cos(u - a), where a is the arrival's angle plus the multiple of
    // the total angle that is nearest to the interval.
    const double middle = (begin + end) / 2;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (const ArrivingPath& arrival : arrivals) {
      if (cone.between(middle, arrival.angle) >= pi) continue;
      double a = arrival.angle;
      if (!cone.open()) a += total * std::round((middle - a) / total);
      sum += arrival.weight * Eigen::Vector2d(std::cos(a), std::sin(a));
    }
    double u = std::atan2(sum.y(), sum.x());
    u += 2 * pi * std::ceil((begin - u) / (2 * pi));
    if (u < end) consider(u);
  }
  return best;
}

}  // namespace supple::surface
