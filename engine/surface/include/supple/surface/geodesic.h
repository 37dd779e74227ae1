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
/// Barycentric: the variables are the three barycentric coordinates w of the first end, then those of the second, each
/// in its own face, with dc/dw_i = v_i - c (thesis eq. 3.7 up to the part along which the sum of w changes); only
/// variations that sum to zero at either end stay on the surface, and for them these are the derivatives. Tangent: two
/// coordinates at each end, in tangent_frame of the end's face. Units: mesh units per coordinate; 1 for the tangent
/// gradient; 1 / mesh unit for the tangent Hessian.
struct GeodesicDerivatives {
  Eigen::Matrix<double, 6, 1> gradient = Eigen::Matrix<double, 6, 1>::Zero();
  Eigen::Matrix<double, 6, 6> hessian = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Vector4d tangent_gradient = Eigen::Vector4d::Zero();
  Eigen::Matrix4d tangent_hessian = Eigen::Matrix4d::Zero();
};

/// A shortest path between two points of the surface and what is known of it.
struct Geodesic {
  double distance = std::numeric_limits<double>::infinity();
  bool unreachable = true;  ///< the ends lie on different components
  /// Whether no other shortest path was found: none of a different direction at the second end whose length is within
  /// 1e-9 relative.
  bool unique = true;
  /// Length by which the best competing path (one that arrives from another direction) exceeds the distance: near 0 at
  /// the cut locus, where the distance has no derivative. Infinity where no competitor was met.
  double competing_excess = std::numeric_limits<double>::infinity();
  /// Saddle or boundary vertices that pin the path, from the first end to the second.
  std::vector<VertexId> pinned_at;
  std::vector<PathPoint> path;  ///< from the first end to the second; empty unless asked for
  /// Empty unless asked for, and at coincident ends, where the distance has no derivative.
  std::optional<GeodesicDerivatives> derivatives;
  /// The path's length with mollified crossings, whose derivatives `derivatives` are; empty without mollifier.
  std::optional<double> mollified_distance;
};

struct GeodesicOptions {
  int derivatives = 0;  ///< 0 distance, 1 gradient, 2 gradient and Hessian
  bool path = false;
  /// Smoothing length of the mollifier (thesis eq. 3.12) as a fraction of an edge, in (0, 0.5]; 0 leaves it out.
  double mollifier = 0;
  /// Whether the mollifier acts on the ends' barycentric coordinates as well, as the thesis has it: see
  /// mollified_length for why it is left out unless asked for. Without `mollifier` nothing.
  bool mollified_ends = false;
};

}  // namespace supple::surface
