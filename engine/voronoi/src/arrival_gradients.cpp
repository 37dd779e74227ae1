#include "arrival_gradients.h"

#include <cmath>

#include "planar_cross.h"
#include "supple/surface/retraction.h"
#include "supple/surface/vertex_cone.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using surface::FaceArrival;

/// `vector` rotated by the angle from the unit vector `from` to the unit vector `to`.
Vector2d rotated_by(const Vector2d& vector, const Vector2d& from, const Vector2d& to) {
  const double c = from.dot(to);
  const double s = cross(from, to);
  return {c * vector.x() - s * vector.y(), s * vector.x() + c * vector.y()};
}

Vector2d unit_vector(double angle) { return {std::cos(angle), std::sin(angle)}; }

}  // namespace

void ArrivalGradients::begin_face(std::int32_t face) {
  face_ = face;
  departures_.assign(distances_.arrivals().size(), {});
}

bool ArrivalGradients::starts_at_site(std::int32_t arrival) const {
  return !(distances_.arrivals()[static_cast<std::size_t>(arrival)].sigma > 0);
}

ArrivalGradients::Departure ArrivalGradients::trace_departure(std::int32_t arrival, const Vector2d& place) const {
  const FaceArrival& from = distances_.arrivals()[static_cast<std::size_t>(arrival)];
  const surface::SurfacePoint& site = sites_[static_cast<std::size_t>(from.source)];
  const surface::PathStart start = field_.start_of_path(FaceId(face_), static_cast<std::size_t>(arrival), place);
  Departure result{true, (place - from.image).normalized(), -start.direction, 0, 0};
  if (!surface::on_cone_tip(mesh_, site)) return result;
  result.by_site.setZero();
  if (!std::isfinite(start.angle)) return result;
  const surface::VertexCone cone(
      mesh_, mesh_.faces()[static_cast<std::size_t>(index(site.face))][static_cast<std::size_t>(corner_of(site))]);
  result.by_site = -surface::cone_coordinates(cone, start.angle);
  result.angle = start.angle;
  result.stretch = surface::cone_angle_scale(cone);
  return result;
}

const ArrivalGradients::Departure& ArrivalGradients::departure(std::int32_t arrival, const Vector2d& place) {
  Departure& entry = departures_[static_cast<std::size_t>(arrival)];
  if (!entry.traced) entry = trace_departure(arrival, place);
  return entry;
}

SiteDistanceGradient ArrivalGradients::at(const Active& active, std::int32_t site, const Vector2d& place) {
  const SiteDistance shortest = distances_.from_site(active, site, place);
  if (shortest.arrival < 0) return {};
  const FaceArrival& from = distances_.arrivals()[static_cast<std::size_t>(shortest.arrival)];
  const Vector2d& turn = from.turns_at(place);
  SiteDistanceGradient gradient{site, shortest.distance, shortest.gradient, Vector2d::Zero()};
  if (shortest.gradient.isZero(0)) return gradient;
  if (&turn != &from.image) {
    gradient.by_site = trace_departure(shortest.arrival, turn).by_site;
    return gradient;
  }
  const Departure& reference = departure(shortest.arrival, place);
  if (!starts_at_site(shortest.arrival))
    gradient.by_site = reference.by_site;
  else if (reference.stretch == 0)
    gradient.by_site = rotated_by(reference.by_site, reference.arrival_direction, shortest.gradient);
  else
    gradient.by_site = -unit_vector(reference.stretch *
                                    (reference.angle + std::atan2(cross(reference.arrival_direction, shortest.gradient),
                                                                  reference.arrival_direction.dot(shortest.gradient))));
  return gradient;
}

void ArrivalGradients::add_region(const StraightRegion& region, double sign, CellMoments& moments) {
  const FaceArrival& from = distances_.arrivals()[static_cast<std::size_t>(region.arrival)];
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& corner : region.corners) middle += corner / static_cast<double>(region.corners.size());
  const PolygonIntegrals integrals = polygon_integrals(region.corners, from.image);
  const double sigma = from.sigma;
  moments.squared_distance += sign * (integrals.square + 2 * sigma * integrals.length + sigma * sigma * integrals.area);
  const Departure& reference = departure(region.arrival, middle);
  if (!starts_at_site(region.arrival))
    moments.gradient += sign * (integrals.length + sigma * integrals.area) * reference.by_site;
  else if (reference.stretch == 0)
    moments.gradient += sign * rotated_by(reference.by_site, reference.arrival_direction, integrals.offset);
  else
    moments.gradient -= sign * stretched_offset(region.corners, from.image, reference.arrival_direction,
                                                reference.stretch * reference.angle, reference.stretch);
}

void ArrivalGradients::add_area(std::int32_t arrival, const Vector2d& place, double area, CellMoments& moments) {
  if (area == 0) return;
  const FaceArrival& from = distances_.arrivals()[static_cast<std::size_t>(arrival)];
  const SiteDistanceGradient gradient = at({arrival}, from.source, place);
  moments.squared_distance += area * gradient.distance * gradient.distance;
  moments.gradient += area * gradient.distance * gradient.by_site;
}

}  // namespace supple::voronoi
