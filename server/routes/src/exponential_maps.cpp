#include "computation_route.h"
#include "handlers.h"
#include "points.h"

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
    tell_asked(execution, "trace", request.trace);
  });
  const Eigen::Vector2d within_face = surface::tangent_frame(mesh.mesh(), start.face).transpose() * tangent;
  return json_result(json::write_exponential_map(request, mesh.mesh(), map, within_face.stableNorm(), bill));
}

}  // namespace

void add_exponential_map_route(http::Router& router, Services& services) {
  const auto handler = [&services](const http::Request& http_request) {
    require_ready(services);
    auto request = json::parse_exponential_map(json_body(http_request), services.limits.json);
    auto mesh = load_mesh(services, http_request, request.mesh, request.deadline);
    const auto start = PointResolver(services, http_request, *mesh, request).resolve(request.start, "/start");
    jobs::Computation computation{"exponential-maps", request.mesh, request.deadline, {}};
    computation.run = [request = std::move(request), mesh = std::move(mesh), start](const Execution& execution) {
      return compute(request, *mesh, start, execution);
    };
    return answer_computation(services, http_request, std::move(computation));
  };
  router.add({"POST", "/v1/exponential-maps", handler, {services.limits.max_json, "--max-json"}});
}

}  // namespace supple::routes
