#include <optional>
#include <variant>

#include "computation_route.h"
#include "handlers.h"
#include "points.h"
#include "state_pace.h"
#include "supple/base/part_of_execution.h"
#include "supple/json/voronoi_answers.h"

namespace supple::routes {
namespace {

using Sites = std::vector<surface::SurfacePoint>;

/// What the statistics of a diagram and its file take of the whole computation, as far as progress is concerned.
constexpr double statistics_share = 0.3;

/// The sites one by one, or none yet where they are random, which is part of the computation.
std::optional<Sites> given_sites(const surface::TriangleMesh& mesh, const json::SitesSpec& spec) {
  if (const auto* given = std::get_if<std::vector<json::PointSpec>>(&spec)) return resolve(mesh, *given, "/sites");
  return std::nullopt;
}

Sites sites_of(const surface::TriangleMesh& mesh, const json::SitesSpec& spec, const std::optional<Sites>& given,
               CostLedger* cost) {
  if (given) return *given;
  const StageTimer timer(cost, "sites");
  const auto& random = std::get<json::RandomSites>(spec);
  return voronoi::random_sites(mesh, random.count, random.seed);
}

store::Result compute(const json::VoronoiDiagramRequest& request, const store::LoadedMesh& mesh,
                      const std::optional<Sites>& given, const json::Limits& limits, const Execution& outer) {
  voronoi::Diagram diagram;
  std::optional<voronoi::DiagramStatistics> statistics;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const auto sites = sites_of(mesh.mesh(), request.sites, given, execution.cost);
    const bool measured = request.statistics;
    const double first = measured ? 1 - statistics_share : 1;
    const PartOfExecution dividing(execution, 0, first);
    diagram = voronoi::diagram(mesh.solver, sites, request.options, dividing.execution());
    if (measured) {
      const PartOfExecution measuring(execution, first, statistics_share);
      const StageTimer timer(execution.cost, "statistics");
      statistics = voronoi::statistics(mesh.solver, diagram, measuring.execution());
    }
  });
  const auto* numbers = statistics ? &*statistics : nullptr;
  return json_result(json::write_voronoi_diagram(request, mesh.mesh(), diagram, numbers, bill, limits));
}

/// Publishes the diagrams on the way, as often as anyone can see them.
class DiagramPublisher {
 public:
  DiagramPublisher(ProgressSink& sink, const surface::TriangleMesh& mesh) : sink_(sink), mesh_(mesh) {}

  void operator()(const voronoi::OptimizationStep& step, const voronoi::Diagram& diagram) {
    const int iteration = iteration_++;
    if (pace_.is_due()) sink_.publish(json::write_partial_optimization(iteration, step, mesh_, diagram));
  }

 private:
  ProgressSink& sink_;
  const surface::TriangleMesh& mesh_;
  int iteration_ = 0;
  StatePace pace_;
};

store::Result compute(const json::VoronoiOptimizationRequest& request, const store::LoadedMesh& mesh,
                      const std::optional<Sites>& given, const json::Limits& limits, const Execution& outer) {
  voronoi::Optimization optimization;
  const auto bill = billed(outer, [&](const Execution& execution) {
    auto sites = sites_of(mesh.mesh(), request.sites, given, execution.cost);
    auto options = request.options;
    if (execution.progress) options.observer = DiagramPublisher(*execution.progress, mesh.mesh());
    optimization = voronoi::optimize(mesh.solver, std::move(sites), options, execution);
  });
  return json_result(json::write_voronoi_optimization(request, mesh.mesh(), optimization, bill, limits));
}

template <class Request>
void add_voronoi_route(http::Router& router, Services& services, const std::string& kind,
                       Request (*parse)(std::string_view, const json::Limits&)) {
  const auto handler = [&services, kind, parse](const http::Request& http_request) {
    require_ready(services);
    auto request = parse(json_body(http_request), services.limits.json);
    auto mesh = load_mesh(services, request.mesh);
    auto given = given_sites(mesh->mesh(), request.sites);
    jobs::Computation computation{kind, request.mesh, request.deadline, {}};
    computation.run = [request = std::move(request), mesh = std::move(mesh), given = std::move(given),
                       limits = services.limits.json](const Execution& execution) {
      return compute(request, *mesh, given, limits, execution);
    };
    return answer_computation(services, http_request, std::move(computation));
  };
  router.add({"POST", "/v1/" + kind, handler, {services.limits.max_json, "--max-json"}});
}

}  // namespace

void add_voronoi_routes(http::Router& router, Services& services) {
  add_voronoi_route(router, services, "voronoi-diagrams", json::parse_voronoi_diagram);
  add_voronoi_route(router, services, "voronoi-optimizations", json::parse_voronoi_optimization);
}

}  // namespace supple::routes
