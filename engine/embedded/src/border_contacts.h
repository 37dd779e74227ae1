#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "elastic_network.h"
#include "network_state.h"

namespace supple::embedded {

/// A point on an edge of the boundary that its elements push outwards. It rests against the edge and can only slide
/// along it.
struct BorderContact {
  std::int32_t point;
  Eigen::Vector2d outward;  ///< unit normal of the edge in the point's tangent coordinates
};

/// The active set of the constraints that points do not leave a surface with a boundary.
class BorderContacts {
 public:
  BorderContacts() = default;
  /// All free points on edges of the boundary, whatever pushes them. O(free points).
  BorderContacts(const ElasticNetwork& network, const NetworkState& state);

  bool empty() const { return contacts_.empty(); }
  /// Drops the points that the energy does not push outwards; `gradient` holds its derivatives by all tangent
  /// coordinates as if no point touched the boundary.
  void keep_pushed(const Eigen::VectorXd& gradient);
  /// The contact of a point, or null.
  const BorderContact* of(std::int32_t point) const;
  const std::vector<BorderContact>& all() const { return contacts_; }

 private:
  std::vector<BorderContact> contacts_;  ///< by ascending points
};

}  // namespace supple::embedded
