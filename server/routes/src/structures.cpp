#include <optional>

#include "endpoint.h"
#include "handlers.h"
#include "immediate_answer.h"
#include "results.h"
#include "structure_query.h"
#include "structure_spec.h"
#include "supple/json/structure_answers.h"
#include "supple/tiling/export.h"
#include "supple/tiling/tiling_error.h"

namespace supple::routes {
namespace {

/// Clients may cache a file behind a link for an hour: it changes only with the version of the server. The file of an
/// added family is its owner's, and changes where another family is added under its name.
constexpr const char* link_cache_control = "public, max-age=3600";
constexpr const char* link_cache_control_of_added = "private, no-cache";

store::Result write_file(const tiling::ExportOptions& files, const tiling::Structure& structure,
                         const StructureFormat& format, const Execution& outer) {
  std::string body;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const StageTimer timer(execution.cost, "export");
    body = format.write(structure, files, execution);
  });
  return file_result(format.media_type, std::move(body), bill);
}

store::Result describe(const json::StructureRequest& request, const tiling::Structure& structure,
                       const Execution& outer) {
  std::optional<json::MeshedCell> mesh;
  std::optional<std::string> svg;
  const auto bill = billed(outer, [&](const Execution& execution) {
    if (request.mesh) {
      execution.checkpoint(0, "meshing");
      const StageTimer timer(execution.cost, "meshing");
      mesh = {*request.mesh, with_pointers<tiling::MeshOptionError>(PointerMap("/mesh"), [&] {
                return tiling::statistics(tiling::mesh_structure(structure, *request.mesh, execution));
              })};
    }
    if (request.svg) {
      execution.checkpoint(0.9, "export");
      const StageTimer timer(execution.cost, "export");
      svg = tiling::write_svg(structure, request.files, execution);
    }
    bill_requested(execution, "mesh", request.mesh.has_value());
    bill_requested(execution, "svg", request.svg);
    execution.checkpoint(1, "");
  });
  return json_result(json::write_structure(structure, mesh ? &*mesh : nullptr, svg ? &*svg : nullptr, bill));
}

http::Response link(Services& services, const http::Request& http_request) {
  require_ready(services);
  const auto begin = Loader::Clock::now();
  const auto& family = http_request.path_parameters.at("family");
  const Loader loader(services, http_request, begin);
  loader.family(family);  // in the path: whatever the query says, an unknown one is not found
  const auto query = read_structure_query(http_request, services.limits.json);
  const PointerMap pointers("", {{.field = "parameters", .pointer = "query parameters"}});
  const auto structure = tiling::scaled(make_structure({family, query.parameters}, loader, pointers), query.beam_width);
  const jobs::Computation computation{
      .kind = "structures",
      .mesh = {},
      .deadline = services.limits.json.default_deadline,
      .run = [&](const Execution& execution) { return write_file(query.files, structure, query.format, execution); },
      .client = http_request.client};
  auto response = answer_immediately(services, http_request, computation, seconds_since(begin));
  response.set_header("Cache-Control", tiling::find_family(family) ? link_cache_control : link_cache_control_of_added);
  return response;
}

PreparedComputation prepare_structure(const EndpointRequest& asked, const Loader& loader) {
  auto request = json::parse_structure(asked.body, loader.limits(), loader.cancellation());
  auto structure = tiling::scaled(make_structure(request.structure, loader, PointerMap("")), request.beam_width);
  return {.deadline = request.deadline,
          .run = [request = std::move(request), structure = std::move(structure),
                  format = file_of(structure_formats, asked.format)](const Execution& execution) {
            return format ? write_file(request.files, structure, *format, execution)
                          : describe(request, structure, execution);
          }};
}

}  // namespace

void add_structure_routes(http::Router& router, Services& services) {
  router.add({"GET",
              "/v1/families/{family}/structure",
              [&services](const http::Request& request) { return link(services, request); },
              {}});
  add_endpoint(router, services,
               {.kind = "structures",
                .sends = "A structure is sent as",
                .formats = json_or(structure_formats),
                .prepare = prepare_structure});
}

}  // namespace supple::routes
