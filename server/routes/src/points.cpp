#include "points.h"

#include "supple/base/error.h"

namespace supple::routes {

surface::SurfacePoint resolve(const surface::TriangleMesh& mesh, const json::PointSpec& point,
                              const std::string& pointer) {
  try {
    if (point.by_vertex) return surface::vertex_point(mesh, VertexId{point.index});
    return surface::checked_point(mesh, {FaceId{point.index}, point.barycentric}, pointer);
  } catch (const Error& error) {
    // The engine names the point as it sees fit; a client is pointed to the field of its own request.
    throw Error(error.code(), error.what(), {{pointer, error.what()}});
  }
}

std::vector<surface::SurfacePoint> resolve(const surface::TriangleMesh& mesh,
                                           const std::vector<json::PointSpec>& points, const std::string& pointer) {
  std::vector<surface::SurfacePoint> resolved;
  resolved.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    resolved.push_back(resolve(mesh, points[i], pointer + "/" + std::to_string(i)));
  }
  return resolved;
}

}  // namespace supple::routes
