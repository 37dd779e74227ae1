#include "supple/json/voronoi_requests.h"

#include "request_parts.h"
#include "supple/problem/problem.h"

namespace supple::json {
namespace {

constexpr double max_panel_scale = 1e6;
constexpr double max_diagram_error = 1;

void read_sites(Fields& fields, const Limits& limits, SitesSpec& sites) {
  if (!is_builder(fields, "sites"))
    return fields.points("sites", sites.emplace<0>(), 1, limits.max_points, "--max-points");
  Fields random(*fields.required("sites"), fields.at("sites"), fields.faults());
  random.required("count");
  int count = 1;
  int seed = 1;
  random.integer("count", count, 1, max_index);
  random.integer("seed", seed, 0, max_index);
  random.finish();
  if (static_cast<std::size_t>(count) > limits.max_points) {
    problem::throw_limit("request.limit_exceeded", "The number of sites", static_cast<double>(limits.max_points), count,
                         "--max-points", random.at("count"));
  }
  sites = RandomSites{count, static_cast<std::uint64_t>(seed)};
}

void read_include(Fields& fields, DiagramInclude& include, double& panel_scale) {
  fields.boolean("points", include.points);
  fields.boolean("pieces", include.pieces);
  fields.number("panel_scale", panel_scale, 0, max_panel_scale, true);
}

void read_border_deviation(Fields& accuracy, double& deviation) {
  accuracy.number("border_deviation", deviation, voronoi::min_border_deviation, 1);
}

void read_objectives(Fields& fields, voronoi::ObjectiveWeights& weights) {
  const auto* value = fields.required("objectives");
  if (!value) return;
  if (value->is_object() && value->empty()) fields.faults().add(fields.at("objectives"), "must name an objective");
  Fields objectives(*value, fields.at("objectives"), fields.faults());
  objectives.number("edge_length", weights.edge_length, 0, max_factor);
  objectives.number("planarity", weights.planarity, 0, max_factor);
  objectives.number("regularity", weights.regularity, 0, max_factor);
  objectives.number("centroidal", weights.centroidal, 0, max_factor);
  objectives.number("equal_area", weights.equal_area, 0, max_factor);
  objectives.finish();
}

}  // namespace

VoronoiDiagramRequest parse_voronoi_diagram(std::string_view body, const Limits& limits,
                                            const CancellationToken& cancellation) {
  return read_request<VoronoiDiagramRequest>(
      body, limits, cancellation, [&](Fields& fields, VoronoiDiagramRequest& request) {
        fields.mesh_id(request.mesh);
        read_sites(fields, limits, request.sites);
        nested(fields, "accuracy", [&](Fields& accuracy) {
          accuracy.choice("method", request.options.method, diagram_method_names);
          accuracy.number("relative_error", request.options.relative_error, 0, max_diagram_error, true);
          if (accuracy.present("relative_error") && request.options.method != voronoi::DiagramMethod::bounded)
            fields.faults().add(accuracy.at("relative_error"), "takes effect with the method \"bounded\" only");
          read_border_deviation(accuracy, request.options.border_deviation);
        });
        fields.boolean("statistics", request.statistics);
        fields.boolean("keep", request.keep);
        read_include(fields, request.include, request.panel_scale);
      });
}

VoronoiOptimizationRequest parse_voronoi_optimization(std::string_view body, const Limits& limits,
                                                      const CancellationToken& cancellation) {
  return read_request<VoronoiOptimizationRequest>(
      body, limits, cancellation, [&](Fields& fields, VoronoiOptimizationRequest& request) {
        fields.mesh_id(request.mesh);
        read_sites(fields, limits, request.sites);
        auto& options = request.options;
        read_objectives(fields, options.weights);
        fields.number("target_length", options.edge_length, min_length, max_length);
        read_indices(fields, "fixed_sites", limits, options.fixed_sites);
        fields.choice("method", options.method, optimization_method_names);
        nested(fields, "accuracy", [&](Fields& accuracy) {
          accuracy.number("tolerance", options.tolerance, 0, 1, true);
          read_border_deviation(accuracy, options.border_deviation);
        });
        fields.integer("max_iterations", options.max_iterations, 1, voronoi::max_optimization_iterations);
        read_include(fields, request.include, request.panel_scale);
      });
}

}  // namespace supple::json
