#include <functional>
#include <optional>

#include "entity_tag.h"
#include "handlers.h"
#include "immediate_answer.h"
#include "ownership.h"
#include "repair_query.h"
#include "supple/json/answers.h"
#include "supple/json/requests.h"
#include "supple/store/store_error.h"
#include "supple/surface/mesh_report.h"

namespace supple::routes {
namespace {

constexpr auto mesh_types = json::names_of<surface::MeshFormat>({{surface::MeshFormat::obj, "model/obj"},
                                                                 {surface::MeshFormat::off, "model/off"},
                                                                 {surface::MeshFormat::ply, "model/ply"},
                                                                 {surface::MeshFormat::stl, "model/stl"}});

const std::string& mesh_parameter(const http::Request& request) { return request.path_parameters.at("mesh"); }

json::MeshUpload read_upload(const http::Request& request, const RouteLimits& limits, const Execution& execution) {
  auto asked = read_repair_query(request);
  const auto type = http::media_type(request.header("Content-Type"));
  if (type.empty()) {
    // A page of another site may send such a request without asking.
    throw Error("http.unsupported_media_type",
                "A mesh takes a Content-Type: application/json, model/obj, model/off, model/ply, model/stl, or "
                "application/octet-stream for a file whose format is to be found out.");
  }
  if (type == "application/json") {
    if (request.body.size() > limits.max_json) {
      problem::throw_limit("request.body_too_large", "The length of the JSON body in bytes",
                           static_cast<double>(limits.max_json), static_cast<double>(request.body.size()),
                           "--max-json");
    }
    auto upload = json::parse_mesh_arrays(request.body, limits.json, limits.mesh, execution.cancellation);
    if (asked && upload.repair) {
      throw Error("request.invalid_parameter",
                  "Repairs are asked for in the query and in the body; ask for all of them in one place.",
                  {{"query repair", "is in the body too"}});
    }
    if (asked) upload.repair = asked;
    return upload;
  }
  const auto format = mesh_types.find(type).value_or(surface::detect_format(request.body));
  return {surface::read_mesh(request.body, format, limits.mesh, execution), asked};
}

http::Response store_mesh(Services& services, const http::Request& request, const Execution& execution) {
  auto [soup, asked] = read_upload(request, services.limits, execution);
  std::optional<surface::RepairOutcome> repair;
  const auto& limits = services.limits.mesh;
  if (asked)
    repair = asked->automatic ? surface::repair_automatically(soup, limits, execution)
                              : surface::repair_mesh(soup, *asked, limits, execution);
  const auto mesh = std::make_shared<const surface::TriangleMesh>(surface::build_with_advice(soup, limits, execution));
  soup = {};  // the mesh and its file need the memory
  auto report = surface::report(*mesh, execution);
  const auto cracks = surface::crack_warnings(*mesh, execution);
  report.warnings.insert(report.warnings.end(), cracks.begin(), cracks.end());
  const auto [record, is_new] = services.store->meshes().add_mesh(
      surface::write_ply(*mesh, execution),
      [&](const std::string& id, std::int64_t created) { return json::write_mesh(id, created, report); }, request.key);
  services.meshes->put(record.id, std::make_shared<const store::LoadedMesh>(mesh));
  // If the mesh had been stored before, the stored warnings are those of that upload.
  auto response = json_response(json::write_mesh(record.id, record.created, report, repair ? &*repair : nullptr),
                                is_new ? 201 : 200);
  response.set_header("Location", "/v1/meshes/" + record.id);
  response.set_header("ETag", quoted(record.id));
  return response;
}

/// What clients wait for while a mesh is read or written, which may take as long as a computation.
jobs::Computation mesh_work(const Services& services, const std::string& mesh, bool takes_slot) {
  return {.kind = "meshes",
          .mesh = mesh,
          .deadline = services.limits.json.default_deadline,
          .run = {},
          .takes_slot = takes_slot};
}

http::Response create(Services& services, const http::Request& request) {
  require_ready(services);
  http::Response response;
  work_now(services, request, mesh_work(services, {}, true),
           [&](const Execution& execution) { response = store_mesh(services, request, execution); });
  return response;
}

http::Response list(const Services& services, const http::Request& request) {
  require_ready(services);
  const auto page = read_page(request);
  return page_response(
      "meshes", services.store->meshes().meshes(page.limit + 1, page.after, owner_filter(request)), page,
      [](const auto& record) { return record.description; }, [](const auto& record) { return record.id; });
}

http::Response show_mesh(const Services& services, const http::Request& request) {
  require_ready(services);
  require_mesh(services, request, mesh_parameter(request));
  const auto record = services.store->meshes().mesh(mesh_parameter(request));
  if (!record) throw store::MeshNotFound(mesh_parameter(request));
  if (matches(request.header("If-None-Match"), record->id)) return not_modified(record->id);
  auto response = json_response(record->description);
  response.set_header("ETag", quoted(record->id));
  return response;
}

http::Response content(const Services& services, const http::Request& request) {
  require_ready(services);
  const auto& id = mesh_parameter(request);
  const auto type = http::negotiate(request.header("Accept"), {"model/ply", "model/obj"});
  if (!type) throw Error("http.not_acceptable", "A mesh's content is sent as model/ply or model/obj.");
  require_mesh(services, request, id);
  if (!services.store->meshes().mesh(id)) throw store::MeshNotFound(id);
  const bool as_obj = *type == "model/obj";
  // One tag for each representation: the bytes differ.
  const std::string tag = as_obj ? id + "-obj" : id;
  if (matches(request.header("If-None-Match"), tag)) return not_modified(tag);
  http::Response response;
  response.content_type = *type;
  work_now(services, request, mesh_work(services, id, as_obj), [&](const Execution& execution) {
    if (as_obj)
      response.body = surface::write_obj(services.meshes->get(id, execution)->mesh(), execution);
    else
      response.piecewise_body = body_of(services.store->meshes().open_mesh_content(id, execution.cancellation));
  });
  response.set_header("ETag", quoted(tag));
  response.set_header("Vary", "Accept");
  return response;
}

http::Response remove_mesh(Services& services, const http::Request& request) {
  require_ready(services);
  const auto& id = mesh_parameter(request);
  const auto& owner = owner_filter(request);
  require_mesh(services, request, id);
  const bool goes = owner.empty() || services.store->meshes().is_last_owner_of_mesh(id, owner);
  if (goes && services.jobs->mesh_in_use(id)) throw Error("mesh.in_use", "Unfinished jobs use the mesh " + id + ".");
  if (!services.store->meshes().remove_mesh(id, owner)) throw store::MeshNotFound(id);
  if (goes) services.meshes->forget(id);
  http::Response response;
  response.status = 204;
  return response;
}

}  // namespace

void add_mesh_routes(http::Router& router, Services& services) {
  router.add({"POST", "/v1/meshes", handler_with(services, create), {services.limits.max_body, "--max-body"}});
  router.add({"GET", "/v1/meshes", handler_with<const Services>(services, list), {}});
  router.add({"GET", "/v1/meshes/{mesh}", handler_with(services, show_mesh), {}});
  router.add({"DELETE", "/v1/meshes/{mesh}", handler_with(services, remove_mesh), {}});
  router.add({"GET", "/v1/meshes/{mesh}/content", handler_with(services, content), {}});
}

}  // namespace supple::routes
