#pragma once

#include <string>
#include <vector>

#include "supple/json/requests.h"
#include "supple/surface/surface_point.h"

namespace supple::routes {

/// A point as the engine takes it. Throws "point.*" with `pointer` to the field at fault.
surface::SurfacePoint resolve(const surface::TriangleMesh& mesh, const json::PointSpec& point,
                              const std::string& pointer);

/// The points of the array at `pointer`.
std::vector<surface::SurfacePoint> resolve(const surface::TriangleMesh& mesh,
                                           const std::vector<json::PointSpec>& points, const std::string& pointer);

}  // namespace supple::routes
