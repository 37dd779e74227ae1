#include "arrival_pulls.h"

#include <cmath>

#include "planar_cross.h"
#include "supple/surface/retraction.h"
#include "supple/surface/vertex_cone.h"

namespace supple::voronoi {
namespace {

using Eigen::Vector2d;
using surface::FaceArrival;

/// `vector` turned as the direction `from` has to be to become `to`; both are unit vectors.
Vector2d turned_like(const Vector2d& vector, const Vector2d& from, const Vector2d& to) {
  const double c = from.dot(to);
  const double s = cross(from, to);
  return {c * vector.x() - s * vector.y(), s * vector.x() + c * vector.y()};
}

Vector2d unit_vector(double angle) { return {std::cos(angle), std::sin(angle)}; }

}  // namespace

void ArrivalPulls::start(std::int32_t face) {
  face_ = face;
  departures_.assign(distances_.arrivals().size(), {});
}

bool ArrivalPulls::fans_out(std::int32_t arrival) const {
  return !(distances_.arrivals()[static_cast<std::size_t>(arrival)].sigma > 0);
}

ArrivalPulls::Departure ArrivalPulls::followed(std::int32_t arrival, const Vector2d& place) const {
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
  result.stretch = surface::cone_stretch(cone);
  return result;
}

const ArrivalPulls::Departure& ArrivalPulls::departure(std::int32_t arrival, const Vector2d& place) {
  Departure& known = departures_[static_cast<std::size_t>(arrival)];
  if (!known.known) known = followed(arrival, place);
  return known;
}

SitePull ArrivalPulls::at(const Active& active, std::int32_t site, const Vector2d& place) {
  const Slope slope = distances_.from_site(active, site, place);
  if (slope.arrival < 0) return {};
  const FaceArrival& from = distances_.arrivals()[static_cast<std::size_t>(slope.arrival)];
  const Vector2d& turn = from.turns_at(place);
  SitePull pull{site, slope.distance, slope.gradient, Vector2d::Zero()};
  if (slope.gradient.isZero(0)) return pull;
  if (&turn != &from.image) {
    pull.by_site = followed(slope.arrival, turn).by_site;
    return pull;
  }
  const Departure& known = departure(slope.arrival, place);
  if (!fans_out(slope.arrival))
    pull.by_site = known.by_site;
  else if (known.stretch == 0)
    pull.by_site = turned_like(known.by_site, known.arriving, slope.gradient);
  else
    pull.by_site = -unit_vector(known.stretch * (known.angle + std::atan2(cross(known.arriving, slope.gradient),
                                                                          known.arriving.dot(slope.gradient))));
  return pull;
}

void ArrivalPulls::add_region(const StraightRegion& region, double sign, CellMoments& moments) {
  const FaceArrival& from = distances_.arrivals()[static_cast<std::size_t>(region.arrival)];
  Vector2d middle = Vector2d::Zero();
  for (const Vector2d& corner : region.corners) middle += corner / static_cast<double>(region.corners.size());
  const PolygonIntegrals integrals = polygon_integrals(region.corners, from.image);
  const double sigma = from.sigma;
  moments.squared_distance += sign * (integrals.square + 2 * sigma * integrals.length + sigma * sigma * integrals.area);
  const Departure& known = departure(region.arrival, middle);
  if (!fans_out(region.arrival))
    moments.pull += sign * (integrals.length + sigma * integrals.area) * known.by_site;
  else if (known.stretch == 0)
    moments.pull += sign * turned_like(known.by_site, known.arriving, integrals.way);
  else
    moments.pull -=
        sign * stretched_way(region.corners, from.image, known.arriving, known.stretch * known.angle, known.stretch);
}

void ArrivalPulls::add_area(std::int32_t arrival, const Vector2d& place, double area, CellMoments& moments) {
  if (area == 0) return;
  const FaceArrival& from = distances_.arrivals()[static_cast<std::size_t>(arrival)];
  const SitePull pull = at({arrival}, from.source, place);
  moments.squared_distance += area * pull.distance * pull.distance;
  moments.pull += area * pull.distance * pull.by_site;
}

}  // namespace supple::voronoi
