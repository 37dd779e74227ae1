#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/surface/face_arrival.h"

namespace supple::voronoi {

/// A distance and the site that it is from.
struct Nearest {
  double distance = 0;
  std::int32_t site = -1;
};

/// A distance with its gradient in the plane of the face.
struct Slope {
  double distance = 0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  std::int32_t arrival = -1;  ///< index of the arrival that is the shortest
};

/// Indices of those arrivals that may be the shortest in a part of a face.
using Active = std::vector<std::int32_t>;

/// The distances from all sites within one face: the lower envelope of what arrives there. Every arrival grows by at
/// most 1 per unit of length, so that one which is longer than another at a point by more than twice a radius is so
/// everywhere within that radius.
///
/// What asks for distances can be slow where very many arrivals are nearly as short: each question counts the arrivals
/// that it looks at, and the token is looked at for every 65,536 of them. It has to outlive this.
class FaceDistances {
 public:
  explicit FaceDistances(const CancellationToken& cancellation) : cancellation_(&cancellation) {}

  /// Room for the arrivals of a face, filled by GeodesicField::arrivals.
  std::vector<surface::FaceArrival>& arrivals() { return arrivals_; }
  const std::vector<surface::FaceArrival>& arrivals() const { return arrivals_; }

  /// All arrivals.
  void all(Active& active) const;
  /// The arrivals of `active` that may be the shortest within `radius` of a point, into `kept`. Returns the nearest
  /// there.
  Nearest prune(const Active& active, const Eigen::Vector2d& point, double radius, Active& kept) const;

  /// The arrivals of `active` from one site that may be its shortest within `radius` of a point, into `kept`. Returns
  /// how many images besides the first they come from, images nearer than `tolerance` being one.
  int prune_site(const Active& active, std::int32_t site, const Eigen::Vector2d& point, double radius, double tolerance,
                 Active& kept) const;

  Nearest nearest(const Active& active, const Eigen::Vector2d& point) const;
  /// The distance from one site, infinite where none of its arrivals is active.
  Slope from_site(const Active& active, std::int32_t site, const Eigen::Vector2d& point) const;
  /// Whether the distance from one site is this length, but for `tolerance`: quicker than finding it.
  bool is_distance(const Active& active, std::int32_t site, const Eigen::Vector2d& point, double length,
                   double tolerance) const;
  /// Counts steps of some nanoseconds of work that somebody does between such questions. Throws what the token does.
  void charge(std::size_t steps) const {
    steps_ += steps;
    if (steps_ < steps_between_looks) return;
    steps_ = 0;
    cancellation_->throw_if_requested();
  }

  /// Whether all are of one site.
  bool of_one_site(const Active& active) const;

 private:
  /// Whether all paths of an arrival to places within a radius are straight.
  static bool straight_within(const surface::FaceArrival& arrival, const Eigen::Vector2d& point, double radius);

  static constexpr std::size_t steps_between_looks = 1 << 16;

  const CancellationToken* cancellation_;
  mutable std::size_t steps_ = 0;
  std::vector<surface::FaceArrival> arrivals_;
};

}  // namespace supple::voronoi
