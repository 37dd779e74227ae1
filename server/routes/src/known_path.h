#pragma once

#include <string>
#include <vector>

#include "points.h"
#include "supple/json/requests.h"
#include "supple/surface/geodesic.h"

namespace supple::routes {

/// A client's path as an upper bound of a search from `from` to `to`. A bound that is too short would make the search
/// miss the shortest path. The path is therefore checked to lie on the surface: neighbouring points have a common face,
/// and the ends are those of the pair within 1e-9 of the mesh's diagonal, by which they are replaced. Throws
/// "geodesic.known_path" or "point.*" with a pointer to the point at fault. O(points).
std::vector<surface::PathPoint> checked_path(PointResolver& points_of, const std::vector<json::PointSpec>& path,
                                             const surface::SurfacePoint& from, const surface::SurfacePoint& to,
                                             const std::string& pointer);

}  // namespace supple::routes
