#pragma once

#include <string>
#include <vector>

#include "supple/http/message.h"
#include "supple/json/requests.h"
#include "supple/routes/services.h"
#include "supple/store/mesh_cache.h"
#include "supple/surface/nearest_point.h"
#include "supple/surface/surface_point.h"

namespace supple::routes {

/// Makes points of a surface of the points of a request, and notes where those in space lie.
class PointResolver {
 public:
  /// `request` is what json made of `http_request`: it names the mesh and the deadline, and its `points_in_space`
  /// receives the points in space in the order in which they are resolved. All must outlive the resolver.
  template <class Request>
  PointResolver(const Services& services, const http::Request& http_request, const store::LoadedMesh& mesh,
                Request& request)
      : services_(services),
        http_request_(http_request),
        mesh_(mesh),
        id_(request.mesh),
        deadline_(request.deadline),
        placed_(request.points_in_space) {}

  const surface::TriangleMesh& mesh() const { return mesh_.mesh(); }

  /// A point as the engine takes it. The first one in space may have to wait for the search, see nearest_search().
  /// Throws "point.*" with `pointer` to the field at fault, and what ends a computation.
  surface::SurfacePoint resolve(const json::PointSpec& point, const std::string& pointer);
  /// The points of the array at `pointer`.
  std::vector<surface::SurfacePoint> resolve(const std::vector<json::PointSpec>& points, const std::string& pointer);

 private:
  surface::NearestPoint nearest(const Eigen::Vector3d& position);

  const Services& services_;
  const http::Request& http_request_;
  const store::LoadedMesh& mesh_;
  const std::string& id_;
  double deadline_;
  std::vector<json::PlacedPoint>& placed_;
  const surface::NearestPointSearch* search_ = nullptr;
};

/// Tells in the header Supple-Largest-Distance of a file, which has no other place for it, how far from the surface the
/// points in space lie at most. No header where there are none.
void tell_largest_distance(store::Result& result, const std::vector<json::PlacedPoint>& placed);

}  // namespace supple::routes
