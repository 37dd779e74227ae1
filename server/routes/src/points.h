#pragma once

#include <string>
#include <vector>

#include "supple/json/requests.h"
#include "supple/store/mesh_cache.h"
#include "supple/surface/surface_point.h"

namespace supple::routes {

/// Makes points of a surface of the points of a request, and notes where those in space lie.
class PointResolver {
 public:
  /// `mesh` must outlive the resolver; `placed` receives the points in space, in the order in which they are resolved.
  PointResolver(const store::LoadedMesh& mesh, std::vector<json::PlacedPoint>& placed) : mesh_(mesh), placed_(placed) {}

  const surface::TriangleMesh& mesh() const { return mesh_.mesh(); }

  /// A point as the engine takes it. Throws "point.*" with `pointer` to the field at fault.
  surface::SurfacePoint resolve(const json::PointSpec& point, const std::string& pointer);
  /// The points of the array at `pointer`.
  std::vector<surface::SurfacePoint> resolve(const std::vector<json::PointSpec>& points, const std::string& pointer);

 private:
  const store::LoadedMesh& mesh_;
  std::vector<json::PlacedPoint>& placed_;
};

/// Tells in the header Supple-Largest-Distance of a file, which has no other place for it, how far from the surface the
/// points in space lie at most. No header where there are none.
void tell_largest_distance(store::Result& result, const std::vector<json::PlacedPoint>& placed);

}  // namespace supple::routes
