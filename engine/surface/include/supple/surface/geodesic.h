#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <vector>

#include "supple/surface/surface_point.h"

namespace supple::surface {

/// A point where a geodesic path starts, crosses an edge, passes a vertex, or ends.
struct PathPoint {
  SurfacePoint point;
  Eigen::Vector3d position;
  VertexId vertex = VertexId::none;  ///< set where the path passes exactly through a vertex
};

/// First and second derivatives of a distance with respect to its two ends.
///
/// The variables of `gradient` and `hessian` are the three barycentric coordinates w of the first end, then those of
/// the second end, each in its own face, with dc/dw_i = v_i - c for the end's position c and the corners v_i. This is
/// [Thesis, eq. 3.7] up to the part along which the sum of w changes. Only variations that sum to zero at either end
/// stay on the surface, and for them these are the derivatives. The variables of the tangent derivatives are two
/// coordinates at each end, in tangent_frame of the end's face. Units: mesh units per coordinate; 1 for the tangent
/// gradient; 1 / mesh unit for the tangent Hessian.
struct GeodesicDerivatives {
  Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Vector4d tangent_gradient = Eigen::Vector4d::Zero();
  Eigen::Matrix4d tangent_hessian = Eigen::Matrix4d::Zero();
};

/// A shortest path between two points of the surface, and what is known about it.
struct Geodesic {
  double distance = std::numeric_limits<double>::infinity();
  bool unreachable = true;  ///< the ends lie on different components
  /// Whether no other shortest path was found. Another one arrives from a different direction at the second end, or at
  /// a vertex that pins the path, and its relative difference in length is at most 1e-9.
  bool unique = true;
  /// The length by which the best competing path (one that arrives from another direction) exceeds the distance. It is
  /// near 0 at the cut locus, where the distance has no derivative. Infinity if the search met no competitor.
  double competing_excess = std::numeric_limits<double>::infinity();
  /// Saddle or boundary vertices that pin the path, from the first end to the second.
  std::vector<VertexId> pinned_at;
  std::vector<PathPoint> path;  ///< from the first end to the second; empty unless asked for
  /// Empty unless asked for, and at coincident ends, where the distance has no derivative.
  std::optional<GeodesicDerivatives> derivatives;
  /// The length of the path with mollified crossings. `derivatives` are those of this length. Empty without a
  /// mollifier.
  std::optional<double> mollified_distance;
};

struct GeodesicOptions {
  int derivatives = 0;  ///< 0 distance, 1 gradient, 2 gradient and Hessian
  bool path = false;
  /// The smoothing length of the mollifier [Thesis, eq. 3.12] as a fraction of an edge, in (0, 0.5]. 0 leaves it out.
  double mollifier = 0;
  /// Whether the mollifier also acts on the barycentric coordinates of the ends, as in [Thesis]. mollified_length
  /// explains why this is off by default. It has no effect without `mollifier`.
  bool mollified_ends = false;
};

}  // namespace supple::surface
