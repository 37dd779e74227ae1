#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/surface/face_arrival.h"

namespace supple::voronoi {

/// The nearest site and its distance.
struct Nearest {
  double distance = 0;
  std::int32_t site = -1;
};

/// The distance of a place from one site, with its gradient in the plane of the face.
struct SiteDistance {
  double distance = 0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  std::int32_t arrival = -1;  ///< index of the shortest arrival; -1 if there is none
};

/// Indices of arrivals, usually of those that may be the shortest in a part of a face.
using Active = std::vector<std::int32_t>;

/// The distances from all sites within one face: the lower envelope of its arrivals. An arrival (FaceArrival) is a
/// bundle of paths from a site that reach the face straight from one image. The image is the unfolded position of the
/// site or of the vertex at which the paths have turned last; `sigma` is its distance from the site. The length of an
/// arrival changes by at most 1 per unit of length. Therefore an arrival that is longer than another at a point by more
/// than twice a radius is longer everywhere within that radius.
///
/// Queries can be slow where very many arrivals are nearly equally long. Queries count the arrivals that they visit,
/// and check the cancellation token, which must outlive this, once for every 65,536.
class FaceDistances {
 public:
  explicit FaceDistances(const CancellationToken& cancellation) : cancellation_(&cancellation) {}

  /// The arrivals of the face, to be filled by GeodesicField::arrivals.
  std::vector<surface::FaceArrival>& arrivals() { return arrivals_; }
  const std::vector<surface::FaceArrival>& arrivals() const { return arrivals_; }

  /// Sets `active` to all arrivals.
  void all(Active& active) const;
  /// Sets `remaining` to the arrivals of `active` that may be the shortest within `radius` of a point. Returns the
  /// nearest site there.
  Nearest prune(const Active& active, const Eigen::Vector2d& point, double radius, Active& remaining) const;

  /// Sets `remaining` to the arrivals of `active` from one site that may be its shortest within `radius` of a point.
  /// Returns the number of their images minus one; images closer than `tolerance` count once.
  int prune_site(const Active& active, std::int32_t site, const Eigen::Vector2d& point, double radius, double tolerance,
                 Active& remaining) const;

  Nearest nearest(const Active& active, const Eigen::Vector2d& point) const;
  /// The distance from one site; infinite if none of its arrivals is active.
  SiteDistance from_site(const Active& active, std::int32_t site, const Eigen::Vector2d& point) const;
  /// Whether the distance from one site equals `length` up to `tolerance`; faster than computing it.
  bool is_distance(const Active& active, std::int32_t site, const Eigen::Vector2d& point, double length,
                   double tolerance) const;
  /// Counts steps of a few nanoseconds that the caller does between queries. Throws what the token throws.
  void charge(std::size_t steps) const {
    steps_ += steps;
    if (steps_ < steps_between_checks) return;
    steps_ = 0;
    cancellation_->throw_if_requested();
  }

  /// Whether all arrivals of `active` come from one site.
  bool are_of_one_site(const Active& active) const;

 private:
  /// Whether all paths of an arrival to places within `radius` of a point are straight in the face.
  static bool is_straight_within(const surface::FaceArrival& arrival, const Eigen::Vector2d& point, double radius);

  static constexpr std::size_t steps_between_checks = 1 << 16;

  const CancellationToken* cancellation_;
  mutable std::size_t steps_ = 0;
  std::vector<surface::FaceArrival> arrivals_;
};

}  // namespace supple::voronoi
