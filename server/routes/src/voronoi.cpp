#include <algorithm>
#include <array>
#include <memory>
#include <optional>
#include <variant>

#include "computation_route.h"
#include "handlers.h"
#include "kept_diagrams.h"
#include "points.h"
#include "state_pace.h"
#include "supple/base/part_of_execution.h"
#include "supple/json/voronoi_answers.h"
#include "supple/voronoi/export.h"

namespace supple::routes {
namespace {

using Sites = std::vector<surface::SurfacePoint>;

/// What the statistics of a diagram and its file take of the whole computation, as far as progress is concerned.
constexpr double statistics_share = 0.3;

enum class DiagramFile { none, obj, vtu, svg, csv };
constexpr std::array<std::string_view, 5> diagram_types{"application/json", "model/obj", "application/x-vtu+xml",
                                                        "image/svg+xml", "text/csv"};

/// Throws "http.not_acceptable".
DiagramFile negotiate_diagram_file(const http::Request& request) {
  const auto type = http::negotiate(request.header("Accept"), {diagram_types.begin(), diagram_types.end()});
  if (!type) {
    throw Error("http.not_acceptable",
                "A Voronoi diagram is sent as application/json, model/obj, application/x-vtu+xml, image/svg+xml or "
                "text/csv.");
  }
  return static_cast<DiagramFile>(std::find(diagram_types.begin(), diagram_types.end(), *type) - diagram_types.begin());
}

/// The sites one by one, or none yet where they are random, which is part of the computation.
template <class Request>
std::optional<Sites> given_sites(const Services& services, const http::Request& http_request,
                                 const store::LoadedMesh& mesh, Request& request) {
  if (const auto* given = std::get_if<std::vector<json::PointSpec>>(&request.sites))
    return PointResolver(services, http_request, mesh, request).resolve(*given, "/sites");
  return std::nullopt;
}

Sites sites_of(const surface::TriangleMesh& mesh, const json::SitesSpec& spec, const std::optional<Sites>& given,
               CostLedger* cost) {
  if (given) return *given;
  const StageTimer timer(cost, "sites");
  const auto& random = std::get<json::RandomSites>(spec);
  return voronoi::random_sites(mesh, random.count, random.seed);
}

std::string write_diagram_file(DiagramFile file, const surface::TriangleMesh& mesh, const voronoi::Diagram& diagram,
                               double panel_scale, const Execution& execution) {
  execution.checkpoint(1, "export");
  const StageTimer timer(execution.cost, "export");
  if (file == DiagramFile::obj) return voronoi::write_obj(mesh, diagram);
  if (file == DiagramFile::vtu) return voronoi::write_vtu(mesh, diagram);
  if (file == DiagramFile::svg) return voronoi::write_panels_svg(diagram, panel_scale);
  return voronoi::write_panels_csv(diagram);
}

store::Result file_result(DiagramFile file, std::string body, const std::vector<json::PlacedPoint>& placed,
                          const json::Bill& bill) {
  store::Result result;
  result.body = std::move(body);
  result.content_type = diagram_types.at(static_cast<std::size_t>(file));
  result.headers = {{"Supple-Seconds", plain_number(bill.seconds)}};
  tell_largest_distance(result, placed);
  return result;
}

store::Result compute(const json::VoronoiDiagramRequest& request,
                      const std::shared_ptr<const store::LoadedMesh>& loaded, const std::optional<Sites>& given,
                      DiagramFile file, const json::Limits& limits, KeptDiagrams& kept, const Execution& outer) {
  const store::LoadedMesh& mesh = *loaded;
  voronoi::Diagram diagram;
  std::optional<voronoi::DiagramStatistics> statistics;
  std::string body;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const auto sites = sites_of(mesh.mesh(), request.sites, given, execution.cost);
    const bool measured = request.statistics && file == DiagramFile::none;
    const double first = measured ? 1 - statistics_share : 1;
    const PartOfExecution dividing(execution, 0, first);
    diagram = request.keep ? kept.diagram(loaded, request.options, sites, dividing.execution())
                           : voronoi::diagram(mesh.solver(outer), sites, request.options, dividing.execution());
    if (measured) {
      const PartOfExecution measuring(execution, first, statistics_share);
      const StageTimer timer(execution.cost, "statistics");
      statistics = voronoi::statistics(mesh.solver(outer), diagram, measuring.execution());
    }
    if (file != DiagramFile::none)
      body = write_diagram_file(file, mesh.mesh(), diagram, request.panel_scale, execution);
    const bool bounded = request.options.method == voronoi::DiagramMethod::bounded;
    if (execution.cost)
      execution.cost->add_effect(
          "approximation", bounded,
          bounded ? "the request allows a relative error" : "the request asks for exact borders");
    tell_asked(execution, "statistics", request.statistics);
  });
  if (file != DiagramFile::none) return file_result(file, std::move(body), request.points_in_space, bill);
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

store::Result compute(const json::VoronoiOptimizationRequest& request,
                      const std::shared_ptr<const store::LoadedMesh>& loaded, const std::optional<Sites>& given,
                      DiagramFile file, const json::Limits& limits, KeptDiagrams& /*kept*/, const Execution& outer) {
  const store::LoadedMesh& mesh = *loaded;
  voronoi::Optimization optimization;
  std::string body;
  const auto bill = billed(outer, [&](const Execution& execution) {
    auto sites = sites_of(mesh.mesh(), request.sites, given, execution.cost);
    auto options = request.options;
    if (execution.progress) options.observer = DiagramPublisher(*execution.progress, mesh.mesh());
    optimization = voronoi::optimize(mesh.solver(outer), std::move(sites), options, execution);
    if (file != DiagramFile::none)
      body = write_diagram_file(file, mesh.mesh(), optimization.diagram, request.panel_scale, execution);
  });
  if (file == DiagramFile::none)
    return json_result(json::write_voronoi_optimization(request, mesh.mesh(), optimization, bill, limits));
  auto result = file_result(file, std::move(body), request.points_in_space, bill);
  result.headers.emplace_back("Supple-Stopped", optimization.stopped);
  return result;
}

template <class Request>
void add_voronoi_route(http::Router& router, Services& services, const std::string& kind,
                       Request (*parse)(std::string_view, const json::Limits&)) {
  const auto kept = std::make_shared<KeptDiagrams>();
  const auto handler = [&services, kind, parse, kept](const http::Request& http_request) {
    require_ready(services);
    const auto file = negotiate_diagram_file(http_request);
    auto request = parse(json_body(http_request), services.limits.json);
    auto mesh = load_mesh(services, http_request, request.mesh, request.deadline);
    auto given = given_sites(services, http_request, *mesh, request);
    jobs::Computation computation{kind, request.mesh, request.deadline, {}};
    computation.run = [request = std::move(request), mesh = std::move(mesh), given = std::move(given), file, kept,
                       limits = services.limits.json](const Execution& execution) {
      return compute(request, mesh, given, file, limits, *kept, execution);
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
