#pragma once

#include <optional>
#include <span>

#include "edge_frames.h"
#include "supple/surface/geodesic.h"
#include "supple/surface/tangent_geodesic.h"

namespace supple::surface {

/// The strip between the faces of two points that moved a little since `known` led between them: shortened or prolonged
/// by a face at either end, or the common edge of two neighbours where nothing is known. Without a strip where that is
/// not enough.
Strip adjusted_strip(const TriangleMesh& mesh, const Strip& known, std::int32_t from_face, std::int32_t to_face);

/// What turns coordinates in the frame of the face across `h`, unfolded, into those of the face of h; radians.
double turn_across(const SearchMesh& mesh, std::int32_t h);

/// The strip of a path that passes no vertex; none for others.
Strip strip_of(const TriangleMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
               std::span<const PathPoint> path);

/// The geodesic between two points of one face. O(1).
TangentGeodesic within_face(const SearchMesh& mesh, const SurfacePoint& from, const SurfacePoint& to);

/// The straight path through the unfolded strip, if it stays in it and is certainly the shortest of all.
///
/// The certificate. Every other path leaves the strip across one of its sides, at x, and is at least |p - x| + |x - q|
/// long in space, whose least value along an edge has a closed form. A side for which that is too little is replaced by
/// the two others of the face behind it: a path that comes back the way it went is no shorter. Rounding is allowed
/// for; paths shorter than 1e-5 mean edges are left to the search, which counts from the nearest vertex.
/// O(edges crossed).
std::optional<TangentGeodesic> within_strip(const SearchMesh& mesh, const SurfacePoint& from, const SurfacePoint& to,
                                            const Strip& strip);

}  // namespace supple::surface
