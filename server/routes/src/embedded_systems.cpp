#include <algorithm>
#include <array>
#include <optional>
#include <variant>

#include "computation_route.h"
#include "handlers.h"
#include "points.h"
#include "state_pace.h"
#include "supple/base/part_of_execution.h"
#include "supple/embedded/export.h"
#include "supple/embedded/network_plan.h"
#include "supple/json/embedded_system_answers.h"

namespace supple::routes {
namespace {

using json::EmbeddedSystemRequest;

/// What builders take of the whole computation, as far as progress is concerned.
constexpr double building_share = 0.2;

enum class NetworkFile { none, obj, vtu, svg };
constexpr std::array<std::string_view, 4> media_types{"application/json", "model/obj", "application/x-vtu+xml",
                                                      "image/svg+xml"};

/// Throws "http.not_acceptable".
NetworkFile negotiate_network_file(const http::Request& request) {
  const auto type = http::negotiate(request.header("Accept"), {media_types.begin(), media_types.end()});
  if (!type) {
    throw Error("http.not_acceptable",
                "A network is sent as application/json, model/obj, application/x-vtu+xml or image/svg+xml.");
  }
  return static_cast<NetworkFile>(std::find(media_types.begin(), media_types.end(), *type) - media_types.begin());
}

/// The limits of what rules make, as refusals name them.
embedded::NetworkLimits network_limits(const json::Limits& limits) {
  const auto refuse = [limits](std::string_view field, std::size_t count) {
    const bool points = field == "points";
    problem::throw_limit("request.limit_exceeded", "The number of " + std::string(field) + " that a rule makes",
                         static_cast<double>(points ? limits.max_points : limits.max_springs),
                         static_cast<double>(count), points ? "--max-points" : "--max-springs",
                         "/" + std::string(field));
  };
  return {limits.max_points, limits.max_springs, limits.max_springs, refuse};
}

embedded::NetworkPlan plan_of(const Services& services, const http::Request& http_request,
                              EmbeddedSystemRequest& request, const store::LoadedMesh& mesh) {
  embedded::NetworkPlan plan;
  plan.springs = request.springs;
  plan.fixed_points = request.fixed_points;
  plan.triangles = request.triangles;
  plan.rest_scale = request.rest_scale;
  plan.material = request.material;
  if (const auto* given = std::get_if<std::vector<json::PointSpec>>(&request.points)) {
    plan.points = PointResolver(services, http_request, mesh, request).resolve(*given, "/points");
  } else if (const auto* in_faces = std::get_if<embedded::PointsInFaces>(&request.points)) {
    plan.points = *in_faces;
  } else {
    plan.points = std::get<embedded::PoissonDiskPoints>(request.points);
  }
  return plan;
}

/// Publishes the states on the way, as often as anyone can see them.
class StatePublisher {
 public:
  StatePublisher(ProgressSink& sink, bool host_moves) : sink_(sink), host_moves_(host_moves) {}

  void operator()(const embedded::RelaxationStep& step, std::span<const surface::SurfacePoint> points,
                  const surface::TriangleMesh& surface) {
    const int iteration = iteration_++;
    if (!pace_.is_due()) return;
    sink_.publish(json::write_partial_relaxation(iteration, step, surface, points, host_moves_));
  }

 private:
  ProgressSink& sink_;
  bool host_moves_;
  int iteration_ = 0;
  StatePace pace_;
};

std::string write_network_file(NetworkFile file, const surface::TriangleMesh& mesh, const embedded::Network& network,
                               const embedded::Relaxation& relaxation) {
  if (file == NetworkFile::obj) return embedded::write_obj(mesh, network, relaxation);
  if (file == NetworkFile::vtu) return embedded::write_vtu(mesh, network, relaxation);
  return embedded::write_convergence_svg(relaxation.history);
}

store::Result compute(const EmbeddedSystemRequest& request, const store::LoadedMesh& mesh,
                      const embedded::NetworkPlan& plan, NetworkFile file, const json::Limits& limits,
                      const Execution& outer) {
  embedded::BuiltNetwork built;
  embedded::Relaxation relaxation;
  store::Result result;
  const bool gives_way = !std::holds_alternative<embedded::RigidHost>(request.options.host);
  std::optional<surface::TriangleMesh> moved;
  const auto surface = [&]() -> const surface::TriangleMesh& { return moved ? *moved : mesh.mesh(); };
  const auto bill = billed(outer, [&](const Execution& execution) {
    const double first = plan.builds() ? building_share : 0;
    const PartOfExecution building(execution, 0, first);
    built = embedded::build_network(mesh.solver(outer), plan, network_limits(limits), building.execution());
    auto options = request.options;
    options.paths = options.paths || file == NetworkFile::obj || file == NetworkFile::vtu;
    if (execution.progress) options.observer = StatePublisher(*execution.progress, gives_way);
    const PartOfExecution relaxing(execution, first, 1 - first);
    relaxation = embedded::relax(mesh.solver(outer), built.network, options, relaxing.execution());
    if (gives_way) moved = mesh.mesh().with_positions(relaxation.host.vertices);
    if (file != NetworkFile::none) {
      execution.checkpoint(1, "export");
      const StageTimer timer(execution.cost, "export");
      result.body = write_network_file(file, surface(), built.network, relaxation);
    }
  });
  if (file == NetworkFile::none) {
    const auto* triangles = built.triangles ? &*built.triangles : nullptr;
    return json_result(json::write_embedded_system(request, surface(), built.network, relaxation, triangles, bill));
  }
  result.content_type = media_types.at(static_cast<std::size_t>(file));
  result.headers = {{"Supple-Seconds", plain_number(bill.seconds)}, {"Supple-Stopped", relaxation.stopped}};
  tell_largest_distance(result, request.points_in_space);
  return result;
}

}  // namespace

void add_embedded_system_route(http::Router& router, Services& services) {
  const auto handler = [&services](const http::Request& http_request) {
    require_ready(services);
    const auto file = negotiate_network_file(http_request);
    auto request = json::parse_embedded_system(json_body(http_request), services.limits.json);
    auto mesh = load_mesh(services, http_request, request.mesh, request.deadline);
    auto plan = plan_of(services, http_request, request, *mesh);
    jobs::Computation computation{"embedded-systems", request.mesh, request.deadline, {}};
    computation.run = [request = std::move(request), mesh = std::move(mesh), plan = std::move(plan), file,
                       limits = services.limits.json](const Execution& execution) {
      return compute(request, *mesh, plan, file, limits, execution);
    };
    return answer_computation(services, http_request, std::move(computation));
  };
  router.add({"POST", "/v1/embedded-systems", handler, {services.limits.max_json, "--max-json"}});
}

}  // namespace supple::routes
