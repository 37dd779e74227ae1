#include <algorithm>
#include <optional>

#include "computation_route.h"
#include "handlers.h"
#include "structure_query.h"
#include "structure_spec.h"
#include "supple/json/structure_answers.h"
#include "supple/tiling/export.h"

namespace supple::routes {
namespace {

constexpr StructureFormat file_formats[] = {{"image/svg+xml", tiling::write_svg},
                                            {"image/vnd.dxf", tiling::write_dxf},
                                            {"application/dxf", tiling::write_dxf},
                                            {"model/stl", tiling::write_stl}};
/// How long a file behind a link may be kept: it changes only with the version of the server.
constexpr const char* link_cache_control = "public, max-age=3600";

/// Null for JSON. Throws "http.not_acceptable".
const StructureFormat* negotiate_format(const http::Request& request) {
  std::vector<std::string_view> offered{"application/json"};
  for (const auto& format : file_formats) offered.push_back(format.media_type);
  const auto type = http::negotiate(request.header("Accept"), offered);
  if (!type) {
    throw Error("http.not_acceptable",
                "A structure is sent as application/json, image/svg+xml, image/vnd.dxf, application/dxf or model/stl.");
  }
  const auto* const found = std::find_if(std::begin(file_formats), std::end(file_formats),
                                         [&](const StructureFormat& format) { return format.media_type == *type; });
  return found == std::end(file_formats) ? nullptr : found;
}

store::Result write_file(const tiling::ExportOptions& files, const tiling::Structure& structure,
                         const StructureFormat& format, const Execution& outer) {
  store::Result result;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const StageTimer timer(execution.cost, "export");
    result.body = format.write(structure, files, execution);
  });
  result.content_type = format.media_type;
  result.headers = {{"Supple-Seconds", plain_number(bill.seconds)}};
  return result;
}

store::Result describe(const json::StructureRequest& request, const tiling::Structure& structure,
                       const Execution& outer) {
  std::optional<json::MeshedCell> mesh;
  std::optional<std::string> svg;
  const auto bill = billed(outer, [&](const Execution& execution) {
    if (request.mesh) {
      execution.checkpoint(0, "meshing");
      const StageTimer timer(execution.cost, "meshing");
      mesh = {*request.mesh, with_mesh_pointers("/mesh/", [&] {
                return tiling::statistics(tiling::mesh_structure(structure, *request.mesh, execution));
              })};
    }
    if (request.svg) {
      execution.checkpoint(0.9, "export");
      const StageTimer timer(execution.cost, "export");
      svg = tiling::write_svg(structure, request.files, execution);
    }
    tell_asked(execution, "mesh", request.mesh.has_value());
    tell_asked(execution, "svg", request.svg);
    execution.checkpoint(1, "");
  });
  return json_result(json::write_structure(structure, mesh ? &*mesh : nullptr, svg ? &*svg : nullptr, bill));
}

/// The structure that a link names: what is wrong with its parameters is told of the query's.
tiling::Structure linked_structure(const std::string& family, const std::optional<std::vector<double>>& parameters) {
  try {
    return make_structure({family, parameters});
  } catch (const Error& error) {
    auto details = error.details();
    for (auto& detail : details) detail.where = "query " + detail.where.substr(detail.where.find_first_not_of('/'));
    throw Error(error.code(), error.what(), std::move(details));
  }
}

http::Response link(Services& services, const http::Request& http_request) {
  require_ready(services);
  const auto& family = http_request.path_parameters.at("family");
  tiling::family(family);  // in the path: whatever the query says, an unknown one is not found
  const auto query = read_structure_query(http_request, services.limits.json);
  jobs::Computation computation{"structures", {}, services.limits.json.default_deadline, {}};
  computation.client = http_request.client;
  computation.run = [query, structure = tiling::scaled(linked_structure(family, query.parameters), query.beam_width)](
                        const Execution& execution) {
    return write_file(query.files, structure, query.format, execution);
  };
  auto response = answer_immediately(services, http_request, computation);
  response.set_header("Cache-Control", link_cache_control);
  return response;
}

}  // namespace

void add_structure_routes(http::Router& router, Services& services) {
  router.add({"GET",
              "/v1/families",
              [](const http::Request&) { return json_response(json::write_families(preset_structures())); },
              {}});
  router.add({"GET",
              "/v1/families/{family}",
              [](const http::Request& request) {
                const auto& family = tiling::family(request.path_parameters.at("family"));
                const auto index = static_cast<std::size_t>(&family - tiling::families().data());
                return json_response(json::write_family(preset_structures()[index]));
              },
              {}});
  router.add({"GET",
              "/v1/families/{family}/structure",
              [&services](const http::Request& request) { return link(services, request); },
              {}});
  const auto handler = [&services](const http::Request& http_request) {
    require_ready(services);
    const auto* const format = negotiate_format(http_request);
    auto request = json::parse_structure(json_body(http_request), services.limits.json);
    auto structure = tiling::scaled(make_structure(request.structure), request.beam_width);
    jobs::Computation computation{"structures", {}, request.deadline, {}};
    computation.run = [request = std::move(request), structure = std::move(structure),
                       format](const Execution& execution) {
      return format ? write_file(request.files, structure, *format, execution)
                    : describe(request, structure, execution);
    };
    return answer_computation(services, http_request, std::move(computation));
  };
  router.add({"POST", "/v1/structures", handler, {services.limits.max_json, "--max-json"}});
}

}  // namespace supple::routes
