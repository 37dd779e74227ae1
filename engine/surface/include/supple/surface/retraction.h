#pragma once

#include <Eigen/Core>

#include "supple/surface/exponential_map.h"
#include "supple/surface/triangle_mesh.h"
#include "supple/surface/vertex_cone.h"

namespace supple::surface {

/// Coordinates of a direction at a vertex that is not flat. They are polar, with the angle around the cone scaled to a
/// full turn. At a boundary vertex it is scaled to half a turn, and the other half points out of the surface.
Eigen::Vector2d cone_coordinates(const VertexCone& cone, double angle);
/// The factor that scales angles around the cone for these coordinates.
double cone_angle_scale(const VertexCone& cone);

/// Whether the point is exactly at a boundary vertex, or at a vertex whose total angle is not 2 pi.
bool on_cone_tip(const TriangleMesh& mesh, const SurfacePoint& point);

/// The result of moving a point along a tangent vector.
struct Retraction {
  SurfacePoint end;
  Eigen::Vector2d travelled;  ///< the part of the step that was travelled, in the coordinates of the start
  double turn = 0;            ///< angle (radians) by which transport along the path turns the coordinates
  /// False if the path begins or ends at a tip, or slides along the boundary: then there is no transport.
  bool isometric = true;
};

/// Moves a point along the straightest geodesic by a step of two tangent coordinates. They refer to tangent_frame of
/// its face or, at a tip, to cone_coordinates. If the point is on a boundary edge and the step points out of the
/// surface, the point slides along the boundary, at most to the next vertex. A path that meets the boundary ends there.
/// O(edges crossed). Throws what exponential_map throws.
Retraction retract(const TriangleMesh& mesh, const SurfacePoint& point, const Eigen::Vector2d& step,
                   const CancellationToken& cancellation);

}  // namespace supple::surface
