#pragma once

#include <Eigen/Core>

#include "supple/surface/exponential_map.h"
#include "supple/surface/triangle_mesh.h"
#include "supple/surface/vertex_cone.h"

namespace supple::surface {

/// Coordinates of directions at a vertex that is no point of a flat face: polar ones, the angle around the cone
/// stretched to a full turn, or, at a vertex of the boundary, to half a turn: the other half leads out of the surface.
Eigen::Vector2d cone_coordinates(const VertexCone& cone, double angle);
/// The factor that stretches angles around the cone to these coordinates.
double cone_stretch(const VertexCone& cone);

/// Whether the point is exactly at a vertex whose total angle is not 2 pi, or at one of the boundary.
bool on_cone_tip(const TriangleMesh& mesh, const SurfacePoint& point);

/// A point moved along a tangent vector.
struct Retraction {
  SurfacePoint end;
  Eigen::Vector2d travelled;  ///< the part of the step that was travelled, in the coordinates of the start
  double turn = 0;            ///< radians by which transport along the way turns the coordinates
  bool isometric = true;      ///< false where the way begins or ends on a tip or bends along the boundary: no transport
};

/// Moves a point by a step of two tangent coordinates: of tangent_frame of its face, or, on a tip, of cone_coordinates.
/// It walks the straightest path. A step out of the surface at a boundary slides along it to the next vertex at most; a
/// path that meets the boundary ends there. O(edges crossed). Throws what exponential_map throws.
Retraction retract(const TriangleMesh& mesh, const SurfacePoint& point, const Eigen::Vector2d& step,
                   const CancellationToken& cancellation);

}  // namespace supple::surface
