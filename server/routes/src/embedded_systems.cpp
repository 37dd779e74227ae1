#include <optional>
#include <variant>

#include "endpoint.h"
#include "handlers.h"
#include "points.h"
#include "results.h"
#include "state_pace.h"
#include "supple/base/part_of_execution.h"
#include "supple/embedded/export.h"
#include "supple/embedded/network_plan.h"
#include "supple/json/embedded_system_answers.h"

namespace supple::routes {
namespace {

using json::EmbeddedSystemRequest;

/// Fraction of the progress of a computation that the building of the network takes.
constexpr double building_fraction = 0.2;

/// A kind of file of a network: its media type, what writes it, and whether that needs the springs' paths.
struct NetworkFormat {
  std::string_view media_type;
  bool needs_paths;
  std::string (*write)(const surface::TriangleMesh&, const embedded::Network&, const embedded::Relaxation&);
};
constexpr NetworkFormat network_formats[] = {
    {"model/obj", true, embedded::write_obj},
    {"application/x-vtu+xml", true, embedded::write_vtu},
    {"image/svg+xml", false, [](const auto&, const auto&, const auto& relaxation) {
       return embedded::write_convergence_svg(relaxation.history);
     }}};

/// The limits of networks that rules make, as refusals name them.
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

embedded::NetworkPlan plan_of(const Loader& loader, EmbeddedSystemRequest& request, const store::LoadedMesh& mesh) {
  embedded::NetworkPlan plan;
  plan.springs = request.springs;
  plan.fixed_points = request.fixed_points;
  plan.triangles = request.triangles;
  plan.rest_scale = request.rest_scale;
  plan.material = request.material;
  if (const auto* given = std::get_if<std::vector<json::PointSpec>>(&request.points)) {
    plan.points = PointResolver(loader, mesh, request).resolve(*given, "/points");
  } else if (const auto* in_faces = std::get_if<embedded::PointsInFaces>(&request.points)) {
    plan.points = *in_faces;
  } else {
    plan.points = std::get<embedded::PoissonDiskPoints>(request.points);
  }
  return plan;
}

/// Publishes intermediate states, as often as clients can see one.
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

store::Result compute(const EmbeddedSystemRequest& request, const store::LoadedMesh& mesh,
                      const embedded::NetworkPlan& plan, const NetworkFormat* format, const json::Limits& limits,
                      const Execution& outer) {
  embedded::BuiltNetwork built;
  embedded::Relaxation relaxation;
  std::string body;
  const bool is_deformable = !std::holds_alternative<embedded::RigidHost>(request.options.host);
  std::optional<surface::TriangleMesh> moved;
  const auto surface = [&]() -> const surface::TriangleMesh& { return moved ? *moved : mesh.mesh(); };
  const auto bill = billed(outer, [&](const Execution& execution) {
    const double first = plan.builds() ? building_fraction : 0;
    const PartOfExecution building(execution, 0, first);
    built = embedded::build_network(mesh.solver(outer), plan, network_limits(limits), building.execution());
    auto options = request.options;
    options.paths = options.paths || (format && format->needs_paths);
    if (execution.progress) options.observer = StatePublisher(*execution.progress, is_deformable);
    const PartOfExecution relaxing(execution, first, 1 - first);
    relaxation = embedded::relax(mesh.solver(outer), built.network, options, relaxing.execution());
    if (is_deformable) moved = mesh.mesh().with_positions(relaxation.host.vertices);
    if (format) {
      execution.checkpoint(1, "export");
      const StageTimer timer(execution.cost, "export");
      body = format->write(surface(), built.network, relaxation);
    }
  });
  if (!format) {
    const auto* triangles = built.triangles ? &*built.triangles : nullptr;
    return json_result(json::write_embedded_system(request, surface(), built.network, relaxation, triangles, bill));
  }
  auto result = file_result(format->media_type, std::move(body), bill);
  result.headers.emplace_back("Supple-Stopped", embedded::to_string(relaxation.stopped));
  add_largest_distance(result, request.points_in_space);
  return result;
}

PreparedComputation prepare_embedded_system(const EndpointRequest& asked, const Loader& loader) {
  auto request = json::parse_embedded_system(asked.body, loader.limits(), loader.cancellation());
  auto mesh = loader.mesh(request.mesh, request.deadline);
  auto plan = plan_of(loader, request, *mesh);
  return {.mesh = request.mesh,
          .deadline = request.deadline,
          .run = [request = std::move(request), mesh = std::move(mesh), plan = std::move(plan),
                  format = file_of(network_formats, asked.format), limits = loader.limits()](
                     const Execution& execution) { return compute(request, *mesh, plan, format, limits, execution); }};
}

}  // namespace

void add_embedded_system_route(http::Router& router, Services& services) {
  add_endpoint(router, services,
               {.kind = "embedded-systems",
                .sends = "A network is sent as",
                .formats = json_or(network_formats),
                .prepare = prepare_embedded_system});
}

}  // namespace supple::routes
