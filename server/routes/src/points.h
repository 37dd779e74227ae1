#pragma once

#include <string>
#include <vector>

#include "loader.h"
#include "supple/json/requests.h"
#include "supple/store/mesh_cache.h"
#include "supple/surface/nearest_point.h"
#include "supple/surface/surface_point.h"

namespace supple::routes {

/// Makes points of a surface of the points of a request, and notes where those in space lie.
class PointResolver {
 public:
  /// The parsed request names the mesh and the deadline, and its `points_in_space` receives the points in space in the
  /// order in which they are resolved. All arguments must outlive the resolver.
  template <class Request>
  PointResolver(const Loader& loader, const store::LoadedMesh& mesh, Request& request)
      : loader_(loader),
        mesh_(mesh),
        id_(request.mesh),
        deadline_(request.deadline),
        placed_(request.points_in_space) {}

  const surface::TriangleMesh& mesh() const { return mesh_.mesh(); }

  /// A point as the engine takes it. The first one in space may have to wait until the search has been made.
  /// Throws "point.*" with `pointer` to the field at fault, and what ends a computation.
  surface::SurfacePoint resolve(const json::PointSpec& point, const std::string& pointer);
  /// The points of the array at `pointer`.
  std::vector<surface::SurfacePoint> resolve(const std::vector<json::PointSpec>& points, const std::string& pointer);

 private:
  surface::NearestPoint nearest(const Eigen::Vector3d& position);

  const Loader& loader_;
  const store::LoadedMesh& mesh_;
  const std::string& id_;
  double deadline_;
  std::vector<json::PlacedPoint>& placed_;
  const surface::NearestPointSearch* search_ = nullptr;
};

/// Adds the header Supple-Largest-Distance to a file, which has no other place for it: how far from the surface the
/// points in space lie at most. Adds none where there are no such points.
void add_largest_distance(store::Result& result, const std::vector<json::PlacedPoint>& placed);

}  // namespace supple::routes
