#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "face_distances.h"
#include "straight_regions.h"
#include "supple/surface/geodesic_field.h"
#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// Gradients of distances within a face by the sites, one face after the other. Only one path of each bundle is
/// followed back to its site. In a bundle that starts at the site, a path that arrives turned by some angle from that
/// one has also left turned by that angle. In a bundle that comes from a vertex, all paths have left the site in one
/// direction.
class ArrivalGradients {
 public:
  /// `sites` are all sites of the diagram. All arguments must outlive this.
  ArrivalGradients(const surface::TriangleMesh& mesh, const surface::GeodesicField& field,
                   std::span<const surface::SurfacePoint> sites, const FaceDistances& distances)
      : mesh_(mesh), field_(field), sites_(sites), distances_(distances) {}

  /// Begins a face, whose arrivals must be those of the field in their order, with sites as their sources.
  void begin_face(std::int32_t face);

  /// The distance of a place from a site and its gradients, by the site's shortest arrival among `active`; site -1 if
  /// there is none.
  SiteDistanceGradient at(const Active& active, std::int32_t site, const Eigen::Vector2d& place);

  /// Adds the integrals over a region, or over the area of a sliver, which may be negative. `sign` is 1 or -1.
  void add_region(const StraightRegion& region, double sign, CellMoments& moments);
  void add_area(std::int32_t arrival, const Eigen::Vector2d& place, double area, CellMoments& moments);

 private:
  /// How one path of a bundle leaves its site.
  struct Departure {
    bool traced = false;
    Eigen::Vector2d arrival_direction =
        Eigen::Vector2d::Zero();                        ///< direction in which the path reaches the place in the face
    Eigen::Vector2d by_site = Eigen::Vector2d::Zero();  ///< gradient of the path's length by the site
    double angle = 0;    ///< direction in which the path leaves a site on the tip of a cone, radians
    double stretch = 0;  ///< angle in coordinates per angle around that tip; 0 if the site is on no tip
  };

  Departure trace_departure(std::int32_t arrival, const Eigen::Vector2d& place) const;
  /// The departure of an arrival's reference path, traced to `place` at the first call. That path must be straight from
  /// the image.
  const Departure& departure(std::int32_t arrival, const Eigen::Vector2d& place);
  /// Whether the bundle starts at the site, so that its paths leave in different directions.
  bool starts_at_site(std::int32_t arrival) const;

  const surface::TriangleMesh& mesh_;
  const surface::GeodesicField& field_;
  std::span<const surface::SurfacePoint> sites_;
  const FaceDistances& distances_;
  std::int32_t face_ = -1;
  std::vector<Departure> departures_;  ///< one for each arrival
};

}  // namespace supple::voronoi
