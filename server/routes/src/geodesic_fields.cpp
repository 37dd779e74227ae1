#include <bit>
#include <cmath>
#include <cstring>

#include "endpoint.h"
#include "handlers.h"
#include "points.h"
#include "results.h"

namespace supple::routes {
namespace {

static_assert(std::endian::native == std::endian::little, "the binary answer is the memory of the doubles");

constexpr const char* binary_type = "application/octet-stream";
constexpr double unreached_in_binary = -1;

store::Result binary_result(const json::GeodesicFieldRequest& request, const surface::GeodesicField& field,
                            const json::Bill& bill) {
  auto distances = field.vertex_distances();
  std::size_t unreached = 0;
  for (double& distance : distances) {
    if (std::isfinite(distance)) continue;
    distance = unreached_in_binary;
    ++unreached;
  }
  std::string body(distances.size() * sizeof(double), '\0');
  std::memcpy(body.data(), distances.data(), body.size());
  auto result = file_result(binary_type, std::move(body), bill);
  result.headers.emplace_back("Supple-Vertices", std::to_string(distances.size()));
  result.headers.emplace_back("Supple-Unreached", std::to_string(unreached));
  result.headers.emplace_back("Supple-Method", json::field_method_names.name_of(request.method));
  if (const double bound = field.relative_error_bound(); std::isfinite(bound)) {
    result.headers.emplace_back("Supple-Relative-Error-Bound", plain_number(bound));
  }
  add_largest_distance(result, request.points_in_space);
  return result;
}

void bill_effects(const json::GeodesicFieldRequest& request, CostLedger* cost) {
  if (!cost) return;
  const bool graph = request.method == surface::FieldMethod::edge_graph;
  cost->add_effect("approximation", graph || request.relative_error > 0,
                   graph                        ? "the request asks for distances along edges"
                   : request.relative_error > 0 ? "the request allows a relative error"
                                                : "the request asks for exact distances");
  const bool bounded = std::isfinite(request.max_distance);
  cost->add_effect("distance_limit", bounded,
                   bounded ? "the request gives the greatest distance" : "the request asks for all distances");
}

store::Result compute(const json::GeodesicFieldRequest& request, const store::LoadedMesh& mesh,
                      const std::vector<surface::SurfacePoint>& sources, bool binary, const Execution& outer) {
  std::optional<surface::GeodesicField> field;
  const auto bill = billed(outer, [&](const Execution& execution) {
    surface::FieldOptions options;
    options.method = request.method;
    options.relative_error = request.relative_error;
    options.max_distance = request.max_distance;
    field = mesh.solver(execution).field(sources, options, execution);
    bill_effects(request, execution.cost);
  });
  if (binary) return binary_result(request, *field, bill);
  return json_result(json::write_geodesic_field(request, *field, bill));
}

PreparedComputation prepare_geodesic_field(const EndpointRequest& asked, const Loader& loader) {
  auto request = json::parse_geodesic_field(asked.body, loader.limits(), loader.cancellation());
  auto mesh = loader.mesh(request.mesh, request.deadline);
  auto sources = PointResolver(loader, *mesh, request).resolve(request.sources, "/sources");
  return {.mesh = request.mesh,
          .deadline = request.deadline,
          .run = [request = std::move(request), mesh = std::move(mesh), sources = std::move(sources),
                  binary = asked.format == binary_type](const Execution& execution) {
            return compute(request, *mesh, sources, binary, execution);
          }};
}

}  // namespace

void add_geodesic_field_route(http::Router& router, Services& services) {
  add_endpoint(router, services,
               {.kind = "geodesic-fields",
                .sends = "A field is sent as",
                .formats = {"application/json", binary_type},
                .prepare = prepare_geodesic_field});
}

}  // namespace supple::routes
