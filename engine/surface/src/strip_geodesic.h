#pragma once

#include <optional>
#include <span>

#include "edge_frames.h"
#include "supple/surface/geodesic.h"
#include "supple/surface/tangent_geodesic.h"

namespace supple::surface {

/// The strip between the faces of two points that have moved a little since `known` was their strip. It is shortened,
/// or extended by one face at either end. If nothing is known, it is the common edge of two neighbouring faces. Returns
/// no strip if none of this leads from one face to the other.
Strip adjusted_strip(const TriangleMesh& mesh, const Strip& known, std::int32_t from_face, std::int32_t to_face);

/// The angle in radians that rotates coordinates in the frame of the face across `h`, unfolded, into those in the frame
/// of the face of h.
double turn_across(const SearchMesh& mesh, std::int32_t h);

/// The strip of a path that passes no vertex; no strip for other paths.
Strip strip_of(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
               std::span<const PathPoint> path);

/// The geodesic between two points of one face. O(1).
TangentGeodesic within_face(const SearchMesh& mesh, const SurfacePoint& from, const SurfacePoint& to);

/// The straight path through the unfolded strip, if it stays within the strip and is certainly the shortest of all
/// paths.
///
/// The certificate: every other path between p and q leaves the strip across one of its sides, at a point x, and its
/// length is at least |p - x| + |x - q| in space. The minimum of this sum along an edge has a closed form. If it does
/// not exceed the length of the straight path, the two other sides of the face behind that edge are tested instead,
/// because a path that returns across the same edge is no shorter. Rounding is taken into account. Paths shorter than
/// 1e-5 mean edges are left to the search, whose coordinates are relative to the nearest vertex. O(edges crossed).
std::optional<TangentGeodesic> within_strip(const SearchMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                            const Strip& strip);

}  // namespace supple::surface
