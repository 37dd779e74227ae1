#include <bit>
#include <cmath>
#include <cstring>

#include "computation_route.h"
#include "handlers.h"
#include "points.h"

namespace supple::routes {
namespace {

static_assert(std::endian::native == std::endian::little, "the binary answer is the memory of the doubles");

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
  store::Result result;
  result.content_type = "application/octet-stream";
  result.body.resize(distances.size() * sizeof(double));
  std::memcpy(result.body.data(), distances.data(), result.body.size());
  result.headers = {{"Supple-Vertices", std::to_string(distances.size())},
                    {"Supple-Unreached", std::to_string(unreached)},
                    {"Supple-Method", request.method == surface::FieldMethod::windows ? "windows" : "edge_graph"},
                    {"Supple-Seconds", plain_number(bill.seconds)}};
  if (const double bound = field.relative_error_bound(); std::isfinite(bound)) {
    result.headers.emplace_back("Supple-Relative-Error-Bound", plain_number(bound));
  }
  tell_largest_distance(result, request.points_in_space);
  return result;
}

void tell_effects(const json::GeodesicFieldRequest& request, CostLedger* cost) {
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
    tell_effects(request, execution.cost);
  });
  if (binary) return binary_result(request, *field, bill);
  return json_result(json::write_geodesic_field(request, *field, bill));
}

}  // namespace

void add_geodesic_field_route(http::Router& router, Services& services) {
  const auto handler = [&services](const http::Request& http_request) {
    require_ready(services);
    const auto type = http::negotiate(http_request.header("Accept"), {"application/json", "application/octet-stream"});
    if (!type) throw Error("http.not_acceptable", "A field is sent as application/json or application/octet-stream.");
    auto request = json::parse_geodesic_field(json_body(http_request), services.limits.json);
    auto mesh = load_mesh(services, http_request, request.mesh, request.deadline);
    auto sources = PointResolver(services, http_request, *mesh, request).resolve(request.sources, "/sources");
    jobs::Computation computation{"geodesic-fields", request.mesh, request.deadline, {}};
    computation.run = [request = std::move(request), mesh = std::move(mesh), sources = std::move(sources),
                       binary = *type != "application/json"](const Execution& execution) {
      return compute(request, *mesh, sources, binary, execution);
    };
    return answer_computation(services, http_request, std::move(computation));
  };
  router.add({"POST", "/v1/geodesic-fields", handler, {services.limits.max_json, "--max-json"}});
}

}  // namespace supple::routes
