#include "endpoint.h"
#include "handlers.h"
#include "points.h"
#include "results.h"

namespace supple::routes {
namespace {

Eigen::Vector3d tangent_in_space(const std::vector<double>& tangent, const surface::TriangleMesh& mesh, FaceId face) {
  if (tangent.size() == 3) return {tangent[0], tangent[1], tangent[2]};
  return surface::tangent_frame(mesh, face) * Eigen::Vector2d(tangent[0], tangent[1]);
}

store::Result compute(const json::ExponentialMapRequest& request, const store::LoadedMesh& mesh,
                      const surface::SurfacePoint& start, const Execution& outer) {
  outer.cancellation.throw_if_requested();
  const Eigen::Vector3d tangent = tangent_in_space(request.tangent, mesh.mesh(), start.face);
  surface::ExponentialMap map;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const StageTimer timer(execution.cost, "trace");
    map = surface::exponential_map(mesh.mesh(), start, tangent, execution.cancellation, request.trace);
    bill_requested(execution, "trace", request.trace);
  });
  const Eigen::Vector2d within_face = surface::tangent_frame(mesh.mesh(), start.face).transpose() * tangent;
  return json_result(json::write_exponential_map(request, mesh.mesh(), map, within_face.stableNorm(), bill));
}

PreparedComputation prepare_exponential_map(const EndpointRequest& asked, const Loader& loader) {
  auto request = json::parse_exponential_map(asked.body, loader.limits(), loader.cancellation());
  auto mesh = loader.mesh(request.mesh, request.deadline);
  const auto start = PointResolver(loader, *mesh, request).resolve(request.start, "/start");
  return {.mesh = request.mesh,
          .deadline = request.deadline,
          .run = [request = std::move(request), mesh = std::move(mesh), start](const Execution& execution) {
            return compute(request, *mesh, start, execution);
          }};
}

}  // namespace

void add_exponential_map_route(http::Router& router, Services& services) {
  add_endpoint(router, services, {.kind = "exponential-maps", .prepare = prepare_exponential_map});
}

}  // namespace supple::routes
