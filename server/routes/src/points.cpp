#include "points.h"

#include <algorithm>

#include "request_pointers.h"
#include "results.h"

namespace supple::routes {

surface::NearestPoint PointResolver::nearest(const Eigen::Vector3d& position) {
  if (search_ == nullptr) search_ = &loader_.nearest_search(id_, mesh_, deadline_);
  return search_->find(position);
}

surface::SurfacePoint PointResolver::resolve(const json::PointSpec& point, const std::string& pointer) {
  if (point.position) placed_.push_back({pointer, nearest(*point.position)});
  return fault_of_field<surface::PointError>(pointer, [&] {
    if (point.position) return surface::checked_point(mesh(), placed_.back().nearest.point, pointer);
    if (point.by_vertex) return surface::vertex_point(mesh(), VertexId{point.index});
    return surface::checked_point(mesh(), {FaceId{point.index}, point.barycentric}, pointer);
  });
}

std::vector<surface::SurfacePoint> PointResolver::resolve(const std::vector<json::PointSpec>& points,
                                                          const std::string& pointer) {
  std::vector<surface::SurfacePoint> resolved;
  resolved.reserve(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    resolved.push_back(resolve(points[i], pointer + "/" + std::to_string(i)));
  }
  return resolved;
}

void add_largest_distance(store::Result& result, const std::vector<json::PlacedPoint>& placed) {
  double largest = 0;
  for (const auto& point : placed) largest = std::max(largest, point.nearest.distance);
  if (!placed.empty()) result.headers.emplace_back("Supple-Largest-Distance", plain_number(largest));
}

}  // namespace supple::routes
