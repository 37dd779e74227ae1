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

/// How distances within a face change with their sites, one face after the other. Each bundle of paths is followed back
/// to its site once: another path of the same bundle that arrives turned by some angle has left turned by that angle,
/// and one that turns at a vertex has left like all that do.
class ArrivalPulls {
 public:
  /// `sites` are all sites of the diagram, in whose coordinates derivatives are; everything outlives this.
  ArrivalPulls(const surface::TriangleMesh& mesh, const surface::GeodesicField& field,
               std::span<const surface::SurfacePoint> sites, const FaceDistances& distances)
      : mesh_(mesh), field_(field), sites_(sites), distances_(distances) {}

  /// The next face, whose arrivals are those of the field in their order, with sites as their sources.
  void start(std::int32_t face);

  /// The pull of a site at a place, by the shortest of the arrivals of it among `active`. Of site -1 where there is
  /// none.
  SitePull at(const Active& active, std::int32_t site, const Eigen::Vector2d& place);

  /// Adds the integrals over a region, or over the area of a sliver that an arrival gains or loses.
  void add_region(const StraightRegion& region, double sign, CellMoments& moments);
  void add_area(std::int32_t arrival, const Eigen::Vector2d& place, double area, CellMoments& moments);

 private:
  struct Departure {
    bool known = false;
    Eigen::Vector2d arriving = Eigen::Vector2d::Zero();  ///< direction in the face of the path that was followed
    Eigen::Vector2d by_site = Eigen::Vector2d::Zero();   ///< the distance's gradient by the site, of that path
    double angle = 0;                                    ///< under which it leaves a site on the tip of a cone
    double stretch = 0;  ///< of angles round that tip to those of coordinates; 0 where the site is on none
  };

  Departure followed(std::int32_t arrival, const Eigen::Vector2d& place) const;
  /// Of a bundle of which a path ends at a place of the face, straight.
  const Departure& departure(std::int32_t arrival, const Eigen::Vector2d& place);
  /// Whether the bundle comes from the site, so that its paths leave in different directions.
  bool fans_out(std::int32_t arrival) const;

  const surface::TriangleMesh& mesh_;
  const surface::GeodesicField& field_;
  std::span<const surface::SurfacePoint> sites_;
  const FaceDistances& distances_;
  std::int32_t face_ = -1;
  std::vector<Departure> departures_;  ///< one for each arrival
};

}  // namespace supple::voronoi
