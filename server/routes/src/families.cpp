#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "handlers.h"
#include "immediate_answer.h"
#include "loader.h"
#include "ownership.h"
#include "request_pointers.h"
#include "results.h"
#include "supple/json/answers.h"
#include "supple/json/family_checks.h"
#include "supple/json/family_definitions.h"
#include "supple/json/requests.h"
#include "supple/json/structure_answers.h"
#include "supple/outlines/drawing.h"
#include "supple/store/clock.h"
#include "supple/tiling/definition_text.h"
#include "supple/tiling/structure.h"
#include "supple/tiling/tiling_error.h"

namespace supple::routes {
namespace {

/// What designs take for the families of all models.
constexpr std::string_view any_family = "any";
/// JSON pointers to fields of a definition in an upload begin with it.
constexpr std::string_view definition_prefix = "/definition/";

const std::string& family_parameter(const http::Request& request) { return request.path_parameters.at("family"); }

/// The owner of the families that a request means: its key, or the one that an administrator names in the query. Throws
/// "access.scope", and "request.invalid_parameter" for another query parameter.
std::string owner_of_families(const http::Request& request) {
  std::string owner = request.key;
  for (const auto& [name, value] : request.query) {
    if (name != "owner") throw Error("request.invalid_parameter", "There is no query parameter " + name + " here.");
    if (value != request.key && !request.is_admin)
      throw Error("access.scope", "The families of another owner need a key with the scope admin.");
    owner = value;
  }
  return owner;
}

/// The answer about a family that nobody has added.
std::string answer_about(const tiling::Family& family) {
  return json::write_family(family, tiling::make_structure(family, tiling::presets(family)), {});
}

/// The answers about the families that come with the server, in their order. Made once.
const std::vector<std::string>& shipped_answers() {
  static const auto answers = [] {
    std::vector<std::string> result;
    for (const auto& family : tiling::families()) result.push_back(answer_about(family));
    return result;
  }();
  return answers;
}

std::string place_of(const tiling::DefinitionFinding& finding) {
  std::string place;
  for (const double parameter : finding.parameters)
    place += (place.empty() ? "at the parameters " : ", ") + plain_number(parameter);
  if (finding.point) {
    place += (place.empty() ? "" : ", ") + std::string("near the point (") + plain_number(finding.point->x()) + ", " +
             plain_number(finding.point->y()) + ")";
  }
  return place.empty() ? place : " (" + place + ")";
}

[[noreturn]] void throw_faulty(const std::vector<tiling::DefinitionFinding>& faults) {
  std::vector<Error::Detail> details;
  details.reserve(faults.size());
  for (const auto& fault : faults) details.push_back({"/definition/" + fault.where, fault.message + place_of(fault)});
  const std::string sentence =
      "The definition is not one of a family: " + details.front().where + " " + details.front().message + ".";
  throw Error("family.faulty", sentence, std::move(details));
}

/// Throws "family.exists" for the names of families that come with the server, and for what designs call all families.
void require_free_name(const std::string& name) {
  const auto refuse = [&](const std::string& text) { throw Error("family.exists", text, {{"/definition/id", text}}); };
  const auto lower = http::lower_case(name);
  if (lower == any_family) refuse("The id \"any\" means all families in requests for designs.");
  for (const auto& family : tiling::families()) {
    if (http::lower_case(family.id) == lower)
      refuse("The family " + family.id + " comes with the server; capital and small letters count as equal here.");
  }
}

/// The family's structure at the default parameters. Throws "family.faulty" where the beams are too wide for it.
tiling::Structure preset_structure(const tiling::Family& family) {
  try {
    return tiling::make_structure(family, tiling::presets(family));
  } catch (const tiling::TilingError& error) {
    const std::string text = std::string("does not give a structure at the default parameters: ") + error.what();
    throw Error("family.faulty", "The definition " + text, {{"/definition/beam_width", text}});
  }
}

/// The family of the tile that a drawing shows. Throws "tiling.drawing", and the errors of outlines::read_drawing.
tiling::FamilyDefinition drawn_definition(const json::FamilyUpload& upload, const Execution& execution) {
  try {
    outlines::DrawingOptions options;
    options.format = outlines::DrawingFormat::svg;
    // The size of the drawing tells how fine its curves have to be.
    const auto coarse = outlines::read_drawing(upload.svg, options, execution);
    constexpr double relative_tolerance = 2e-5;
    options.tolerance = relative_tolerance * (coarse.upper - coarse.lower).norm();
    auto drawing = outlines::read_drawing(upload.svg, options, execution);
    if (drawing.outlines.size() != 1) {
      const std::string text =
          "The drawing has " + std::to_string(drawing.outlines.size()) + " closed curves; a tile is one.";
      throw Error("tiling.drawing", text, {{"svg", text}});
    }
    auto tile = upload.drawing;
    tile.outline = std::move(drawing.outlines.front().corners);
    return tiling::definition_of_drawing(tile, execution);
  } catch (const Error& error) {
    if (error.details().empty()) throw;  // a stop request
    throw PointerMap("", {{.field = "text", .pointer = "/svg"}})(error);
  }
}

http::Response store_upload(Services& services, const http::Request& request, const json::FamilyUpload& upload,
                            const Execution& execution) {
  require_free_name(upload.definition ? upload.definition->id : upload.drawing.id);
  const auto definition = upload.definition ? *upload.definition : drawn_definition(upload, execution);
  const auto report = tiling::check_definition(definition, execution);
  if (!report.good()) throw_faulty(report.faults);
  const auto family = tiling::make_family(definition);
  store::FamilyRecord record{.id = store::random_id(),
                             .owner = request.key,
                             .name = family.id,
                             .created = store::now_milliseconds(),
                             .definition = json::write_family_definition(definition),
                             .description = {}};
  record.description = json::write_family(family, preset_structure(family), record.created);
  const auto [stored, is_new] = services.store->families().add_family(std::move(record));
  auto response = json_response(json::write_added_family(stored.description, report.warnings), is_new ? 201 : 200);
  response.set_header("Location", "/v1/families/" + stored.name);
  return response;
}

/// A fault of a definition that was made from a drawing, with the field of the request that it comes from.
Error fault_of_drawing(const Error& fault) {
  auto details = fault.details();
  for (auto& detail : details) {
    if (!detail.where.starts_with(definition_prefix)) continue;
    const auto field = detail.where.substr(definition_prefix.size());
    detail.where = field == "id" || field == "beam_width" ? "/" + field : "/svg";
  }
  return {fault.code(), fault.what(), std::move(details)};
}

http::Response store_family(Services& services, const http::Request& request, const Execution& execution) {
  const auto upload = json::parse_family_upload(request.body, services.limits.json, execution.cancellation);
  try {
    return store_upload(services, request, upload, execution);
  } catch (const Error& error) {
    const auto& details = error.details();
    const bool is_of_definition = !details.empty() && details.front().where.starts_with(definition_prefix);
    if (upload.definition || !is_of_definition) throw;
    throw fault_of_drawing(error);
  }
}

http::Response add_family(Services& services, const http::Request& request) {
  require_ready(services);
  require_json(request);
  http::Response response;
  jobs::Computation adding{
      .kind = "families", .mesh = {}, .deadline = json::peek_deadline(request.body, services.limits.json), .run = {}};
  adding.priority = priority_of_preparation(request.body);
  work_now(services, request, std::move(adding),
           [&](const Execution& execution) { response = store_family(services, request, execution); });
  return response;
}

http::Response list_families(const Services& services, const http::Request& request) {
  require_ready(services);
  auto answers = shipped_answers();
  const auto owner = owner_of_families(request);
  std::set<std::string> listed;
  for (auto& family : services.store->families().families(owner)) {
    listed.insert(family.name);
    answers.push_back(std::move(family.description));
  }
  for (const auto& model : services.models->models(owner)) {
    const bool is_published = !model->model.definition.empty();
    if (is_published && listed.insert(model->model.family).second) answers.push_back(answer_about(*model->family));
  }
  return json_response(json::write_families(answers));
}

/// The definition of a family as text, which supple-lab reads.
http::Response show_definition(const Services& services, const http::Request& request) {
  require_ready(services);
  const auto& name = family_parameter(request);
  const auto family = Loader(services, request, Loader::Clock::now()).family(name);
  if (!family->definition)
    throw Error("family.no_definition", "The family " + name + " is a part of the program and has no definition.");
  http::Response response;
  response.content_type = "text/plain; charset=utf-8";
  response.body = tiling::to_text(*family->definition);
  return response;
}

http::Response show_family(const Services& services, const http::Request& request) {
  const auto& name = family_parameter(request);
  if (const auto* const family = tiling::find_family(name))
    return json_response(shipped_answers()[static_cast<std::size_t>(family - tiling::families().data())]);
  require_ready(services);
  const auto owner = owner_of_families(request);
  if (auto record = services.store->families().family(owner, name))
    return json_response(std::move(record->description));
  if (const auto published = published_family(services, owner, name)) return json_response(answer_about(*published));
  throw_family_not_found(services, owner, name);
}

http::Response remove_family(Services& services, const http::Request& request) {
  require_ready(services);
  const auto& name = family_parameter(request);
  if (tiling::find_family(name))
    throw Error("family.shipped", "The family " + name + " comes with the server and cannot be removed.");
  const auto owner = owner_of_families(request);
  const auto record = services.store->families().family(owner, name);
  if (!record) throw_family_not_found(services, owner, name);
  const auto definition =
      tiling::to_text(json::parse_family_definition(record->definition, services.limits.json, CancellationToken()));
  for (const auto& model : services.models->models(owner)) {
    if (model->model.family == name && model->model.definition == definition)
      throw Error("family.in_use", "The model " + model->model.id + " is one of the family " + name + ".");
  }
  if (!services.store->families().remove_family(owner, name)) throw_family_not_found(services, owner, name);
  http::Response response;
  response.status = 204;
  return response;
}

}  // namespace

void add_family_routes(http::Router& router, Services& services) {
  router.add({"POST", "/v1/families", handler_with(services, add_family), {services.limits.max_json, "--max-json"}});
  router.add({"GET", "/v1/families", handler_with<const Services>(services, list_families), {}});
  router.add({"GET", "/v1/families/{family}", handler_with<const Services>(services, show_family), {}});
  router.add({"GET", "/v1/families/{family}/definition", handler_with<const Services>(services, show_definition), {}});
  router.add({"DELETE", "/v1/families/{family}", handler_with(services, remove_family), {}});
}

}  // namespace supple::routes
