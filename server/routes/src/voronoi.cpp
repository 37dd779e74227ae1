#include <memory>
#include <optional>
#include <variant>

#include "diagram_cache.h"
#include "endpoint.h"
#include "handlers.h"
#include "points.h"
#include "results.h"
#include "state_pace.h"
#include "supple/base/part_of_execution.h"
#include "supple/json/voronoi_answers.h"
#include "supple/voronoi/export.h"

namespace supple::routes {
namespace {

using Sites = std::vector<surface::SurfacePoint>;

/// Fraction of the progress of a computation that the statistics of a diagram take.
constexpr double statistics_fraction = 0.3;

/// A kind of file of a diagram: its media type, and what writes it. The scale is that of the panels, in mm per mesh
/// unit.
struct DiagramFormat {
  std::string_view media_type;
  std::string (*write)(const surface::TriangleMesh&, const voronoi::Diagram&, double panel_scale);
};
constexpr DiagramFormat diagram_formats[] = {
    {"model/obj", [](const auto& mesh, const auto& diagram, double) { return voronoi::write_obj(mesh, diagram); }},
    {"application/x-vtu+xml",
     [](const auto& mesh, const auto& diagram, double) { return voronoi::write_vtu(mesh, diagram); }},
    {"image/svg+xml",
     [](const auto&, const auto& diagram, double scale) { return voronoi::write_panels_svg(diagram, scale); }},
    {"text/csv", [](const auto&, const auto& diagram, double) { return voronoi::write_panels_csv(diagram); }}};

/// The sites of a request that lists them; nullopt if they are random, because drawing them is part of the computation.
template <class Request>
std::optional<Sites> given_sites(const Loader& loader, const store::LoadedMesh& mesh, Request& request) {
  if (const auto* given = std::get_if<std::vector<json::PointSpec>>(&request.sites))
    return PointResolver(loader, mesh, request).resolve(*given, "/sites");
  return std::nullopt;
}

Sites sites_of(const surface::TriangleMesh& mesh, const json::SitesSpec& spec, const std::optional<Sites>& given,
               CostLedger* cost) {
  if (given) return *given;
  const StageTimer timer(cost, "sites");
  const auto& random = std::get<json::RandomSites>(spec);
  return voronoi::random_sites(mesh, random.count, random.seed);
}

std::string write_diagram_file(const DiagramFormat& format, const surface::TriangleMesh& mesh,
                               const voronoi::Diagram& diagram, double panel_scale, const Execution& execution) {
  execution.checkpoint(1, "export");
  const StageTimer timer(execution.cost, "export");
  return format.write(mesh, diagram, panel_scale);
}

store::Result compute(const json::VoronoiDiagramRequest& request,
                      const std::shared_ptr<const store::LoadedMesh>& loaded, const std::optional<Sites>& given,
                      const DiagramFormat* format, const json::Limits& limits, DiagramCache& cache,
                      const Execution& outer) {
  const store::LoadedMesh& mesh = *loaded;
  voronoi::Diagram diagram;
  std::optional<voronoi::DiagramStatistics> statistics;
  std::string body;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const auto sites = sites_of(mesh.mesh(), request.sites, given, execution.cost);
    const bool measured = request.statistics && !format;
    const double first = measured ? 1 - statistics_fraction : 1;
    const PartOfExecution dividing(execution, 0, first);
    diagram = request.keep ? cache.diagram(loaded, request.options, sites, dividing.execution())
                           : voronoi::diagram(mesh.solver(outer), sites, request.options, dividing.execution());
    if (measured) {
      const PartOfExecution measuring(execution, first, statistics_fraction);
      const StageTimer timer(execution.cost, "statistics");
      statistics = voronoi::statistics(mesh.solver(outer), diagram, measuring.execution());
    }
    if (format) body = write_diagram_file(*format, mesh.mesh(), diagram, request.panel_scale, execution);
    const bool bounded = request.options.method == voronoi::DiagramMethod::bounded;
    if (execution.cost)
      execution.cost->add_effect(
          "approximation", bounded,
          bounded ? "the request allows a relative error" : "the request asks for exact borders");
    bill_requested(execution, "statistics", request.statistics);
  });
  if (format) {
    auto result = file_result(format->media_type, std::move(body), bill);
    add_largest_distance(result, request.points_in_space);
    return result;
  }
  const auto* numbers = statistics ? &*statistics : nullptr;
  return json_result(json::write_voronoi_diagram(request, mesh.mesh(), diagram, numbers, bill, limits));
}

/// Publishes intermediate diagrams, as often as clients can see one.
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

store::Result compute(const json::VoronoiOptimizationRequest& request,
                      const std::shared_ptr<const store::LoadedMesh>& loaded, const std::optional<Sites>& given,
                      const DiagramFormat* format, const json::Limits& limits, DiagramCache& /*cache*/,
                      const Execution& outer) {
  const store::LoadedMesh& mesh = *loaded;
  voronoi::Optimization optimization;
  std::string body;
  const auto bill = billed(outer, [&](const Execution& execution) {
    auto sites = sites_of(mesh.mesh(), request.sites, given, execution.cost);
    auto options = request.options;
    if (execution.progress) options.observer = DiagramPublisher(*execution.progress, mesh.mesh());
    optimization = voronoi::optimize(mesh.solver(outer), std::move(sites), options, execution);
    if (format) body = write_diagram_file(*format, mesh.mesh(), optimization.diagram, request.panel_scale, execution);
  });
  if (!format) return json_result(json::write_voronoi_optimization(request, mesh.mesh(), optimization, bill, limits));
  auto result = file_result(format->media_type, std::move(body), bill);
  add_largest_distance(result, request.points_in_space);
  result.headers.emplace_back("Supple-Stopped", voronoi::to_string(optimization.stopped));
  return result;
}

template <class Request>
void add_voronoi_route(http::Router& router, Services& services, const std::string& kind,
                       Request (*parse)(std::string_view, const json::Limits&, const CancellationToken&)) {
  const auto prepare = [parse, cache = std::make_shared<DiagramCache>()](const EndpointRequest& asked,
                                                                         const Loader& loader) -> PreparedComputation {
    auto request = parse(asked.body, loader.limits(), loader.cancellation());
    auto mesh = loader.mesh(request.mesh, request.deadline);
    auto given = given_sites(loader, *mesh, request);
    return {
        .mesh = request.mesh,
        .deadline = request.deadline,
        .run = [request = std::move(request), mesh = std::move(mesh), given = std::move(given), cache,
                format = file_of(diagram_formats, asked.format), limits = loader.limits()](const Execution& execution) {
          return compute(request, mesh, given, format, limits, *cache, execution);
        }};
  };
  add_endpoint(
      router, services,
      {.kind = kind, .sends = "A Voronoi diagram is sent as", .formats = json_or(diagram_formats), .prepare = prepare});
}

}  // namespace

void add_voronoi_routes(http::Router& router, Services& services) {
  add_voronoi_route(router, services, "voronoi-diagrams", json::parse_voronoi_diagram);
  add_voronoi_route(router, services, "voronoi-optimizations", json::parse_voronoi_optimization);
}

}  // namespace supple::routes
