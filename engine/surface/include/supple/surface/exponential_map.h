#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/surface/geodesic.h"

namespace supple::surface {

/// The end of a straightest geodesic, and the points that it passes.
struct ExponentialMap {
  SurfacePoint end;
  std::vector<PathPoint> trace;  ///< start, every edge crossing and vertex passed, and end
  /// Unit tangent of the geodesic at its end, in the end's face; zero for a zero vector.
  Eigen::Vector3d end_direction;
  double length = 0;  ///< travelled length; it is less than requested only if the geodesic met the boundary
  bool reached_boundary = false;
  /// The angle (radians) of parallel transport along the geodesic: it turns tangent_frame coordinates at the start into
  /// those at the end.
  double transport_angle = 0;
};

/// Follows the straightest geodesic [Polthier1998] from `start`. `tangent` gives its direction and length. It is a
/// vector in space, of which only the part within the start's face counts. Faces are unfolded across each edge, and a
/// vertex is left with equal angles on both sides. The geodesic ends at a boundary. If the start is on an edge or a
/// vertex, the face is found into which the direction points. Throws "exponential_map.non_finite" and
/// "exponential_map.too_long" (more than `max_crossings` edges), and what the token throws. O(edges crossed).
ExponentialMap exponential_map(const TriangleMesh& mesh, const SurfacePoint& start, const Eigen::Vector3d& tangent,
                               const CancellationToken& cancellation, bool record_trace = true,
                               std::int64_t max_crossings = 10'000'000);

}  // namespace supple::surface
