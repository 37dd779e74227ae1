#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/surface/geodesic.h"

namespace supple::surface {

/// Where a straightest path leads, and what it passes.
struct ExponentialMap {
  SurfacePoint end;
  std::vector<PathPoint> trace;   ///< start, every edge crossing and vertex passed, end
  Eigen::Vector3d end_direction;  ///< unit tangent of the path at its end, in the end's face; zero for a zero vector
  double length = 0;              ///< travelled length; less than asked for only if the path met the boundary
  bool reached_boundary = false;
  /// The angle (radians) by which transport along the path turns tangent_frame coordinates at the start into
  /// coordinates at the end.
  double transport_angle = 0;
};

/// Walks from `start` along the straightest geodesic (Polthier and Schmies 1998). `tangent` gives its direction and
/// length. It is a vector in space, of which only the part within the start's face counts. Across an edge the faces are
/// unfolded. The path leaves a vertex with equal angles on both sides. At a boundary it stops and says so. A start on
/// an edge or a vertex first finds the face that the direction points into. Throws "exponential_map.non_finite" and
/// "exponential_map.too_long" (more than `max_crossings` edges), and what the token does. O(edges crossed).
ExponentialMap exponential_map(const TriangleMesh& mesh, const SurfacePoint& start, const Eigen::Vector3d& tangent,
                               const CancellationToken& cancellation, bool record_trace = true,
                               std::int64_t max_crossings = 10'000'000);

}  // namespace supple::surface
