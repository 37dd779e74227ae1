#include <charconv>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>

#include "endpoint.h"
#include "handlers.h"
#include "kept_atlases.h"
#include "request_pointers.h"
#include "results.h"
#include "supple/json/family_atlases.h"
#include "supple/tiling/tiling_error.h"

namespace supple::routes {
namespace {

enum class Keeping { nowhere, by_name, by_definition };

/// What an atlas is of, and how it is kept.
struct AtlasSubject {
  tiling::Family family;
  Keeping keeping = Keeping::nowhere;
  std::string name;             ///< by which it is kept; empty for other ways
  bool is_shipped = false;      ///< whether the family comes with the server, so that networks know its crossings
  std::string definition_at{};  ///< JSON pointer to the definition in the request; empty if it has none
};

/// A family that comes with the server, or one of the request's key. Throws "tiling.family_not_found".
AtlasSubject subject_of_family(const std::string& id, const Loader& loader) {
  const bool is_shipped = tiling::find_family(id) != nullptr;
  if (is_shipped) return {.family = *loader.family(id), .keeping = Keeping::by_name, .name = id, .is_shipped = true};
  return {.family = *loader.family(id), .keeping = Keeping::by_definition, .name = {}};
}

/// Throws "http.not_found" for a number that no type has.
AtlasSubject subject_of_type(int number) {
  const auto* type = tiling::find_isohedral_type(number);
  if (!type) throw Error("http.not_found", "There is no isohedral type of this number.");
  return {.family = tiling::make_family(design::atlas_definition(*type)),
          .keeping = Keeping::by_name,
          .name = "type-" + std::to_string(number)};
}

/// The atlas that is kept of a subject; null if there is none.
KeptAtlases::Record find_kept(KeptAtlases& kept, const AtlasSubject& subject) {
  switch (subject.keeping) {
    case Keeping::by_name:
      return kept.find(subject.name, subject.family.definition);
    case Keeping::by_definition:
      return kept.find_added(subject.family.definition);
    default:
      return nullptr;
  }
}

void keep(KeptAtlases& kept, const AtlasSubject& subject, const KeptAtlases::Record& record) {
  if (subject.keeping == Keeping::by_name) kept.keep(subject.name, record);
  if (subject.keeping == Keeping::by_definition) kept.keep_added(*record);
}

std::string answer(KeptAtlases& kept, const json::AtlasRecord& record, bool is_kept) {
  const auto others = kept.of_families();
  std::vector<const design::FamilyAtlas*> atlases;
  json::ComparedAtlas compared;
  for (const auto& other : others) {
    if (other->atlas.family == record.atlas.family) continue;
    atlases.push_back(&other->atlas);
    compared.families.push_back(other->atlas.family);
  }
  auto comparison = design::compare(record.atlas, atlases);
  if (comparison) compared.comparison = std::move(*comparison);
  return json::write_family_atlas(record, comparison ? &compared : nullptr, is_kept);
}

store::Result compute(KeptAtlases& kept, const AtlasSubject& subject, const design::AtlasOptions& options,
                      const Execution& outer) {
  design::FamilyAtlas atlas;
  const auto bill = billed(outer, [&](const Execution& execution) {
    atlas = with_pointers<Error>(PointerMap(subject.definition_at),
                                 [&] { return design::make_atlas(subject.family, options, execution); });
    execution.checkpoint(1, "");
  });
  const bool is_whole = atlas.stopped == StopReason::none;
  auto record = std::make_shared<const json::AtlasRecord>(
      json::make_atlas_record(std::move(atlas), subject.family.definition, bill));
  if (is_whole) keep(kept, subject, record);
  return json_result(answer(kept, *record, false));
}

/// Options without which an atlas is computed: those of the contract.
design::AtlasOptions default_options(const json::Limits& limits, const AtlasSubject& subject) {
  design::AtlasOptions options;
  options.max_nodes = limits.max_mesh_nodes;
  options.crossings = subject.is_shipped;
  return options;
}

/// Whether an atlas with these options may take the place of the one that is kept.
bool may_be_kept(const design::AtlasOptions& options, const design::AtlasOptions& defaults) {
  return options.samples >= defaults.samples && options.mesh_size <= defaults.mesh_size &&
         options.error_samples >= defaults.error_samples && options.crossings == defaults.crossings;
}

bool is_default(const design::AtlasOptions& options, const design::AtlasOptions& defaults) {
  return options.samples == defaults.samples && options.mesh_size == defaults.mesh_size &&
         options.error_samples == defaults.error_samples && options.crossings == defaults.crossings;
}

AtlasSubject subject_of(const json::FamilyAtlasRequest& request, const Loader& loader) {
  if (request.definition) {
    return {.family = tiling::make_family(*request.definition),
            .keeping = Keeping::nowhere,
            .name = {},
            .definition_at = "/definition"};
  }
  if (request.isohedral_type != 0) return subject_of_type(request.isohedral_type);
  return fault_of_field<tiling::FamilyNotFound>("/family", [&] { return subject_of_family(request.family, loader); });
}

PreparedComputation prepare_atlas(const std::shared_ptr<KeptAtlases>& kept, const EndpointRequest& asked,
                                  const Loader& loader) {
  const auto request = json::parse_family_atlas_request(asked.body, loader.limits(), loader.cancellation());
  auto subject = subject_of(request, loader);
  const auto defaults = default_options(loader.limits(), subject);
  auto options = request.options;
  options.crossings = request.crossings.value_or(defaults.crossings);
  if (!request.recompute && is_default(options, defaults)) {
    if (const auto record = find_kept(*kept, subject)) {
      return {.deadline = request.deadline, .run = [kept, record](const Execution& /*execution*/) {
                return json_result(answer(*kept, *record, true));
              }};
    }
  }
  if (!may_be_kept(options, defaults)) subject.keeping = Keeping::nowhere;
  return {.deadline = request.deadline,
          .run = [kept, subject = std::move(subject), options](const Execution& execution) {
            return compute(*kept, subject, options, execution);
          }};
}

using PathParameters = std::map<std::string, std::string>;
using SubjectOfPath = AtlasSubject (*)(const PathParameters&, const Loader&);

AtlasSubject family_in_path(const PathParameters& path, const Loader& loader) {
  return subject_of_family(path.at("family"), loader);
}

AtlasSubject type_in_path(const PathParameters& path, const Loader& /*loader*/) {
  const std::string& text = path.at("type");
  int number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return subject_of_type(error == std::errc() && end == text.data() + text.size() ? number : 0);
}

void add_kept_endpoint(http::Router& router, Services& services, const std::shared_ptr<KeptAtlases>& kept,
                       std::string path, SubjectOfPath subject_of_path) {
  Endpoint endpoint{.path = std::move(path), .kind = "family-atlases"};
  ReadyAnswer ready = [&services, kept,
                       subject_of_path](const http::Request& request) -> std::optional<http::Response> {
    const Loader loader(services, request, Loader::Clock::now());
    const auto record = find_kept(*kept, subject_of_path(request.path_parameters, loader));
    if (!record) {
      // A key that may only read gets what is kept, and starts no computation.
      if (!request.key.empty()) services.gate->require_scope(request.key, access::Scope::compute);
      return std::nullopt;
    }
    return json_response(answer(*kept, *record, true));
  };
  endpoint.prepare = [kept, subject_of_path](const EndpointRequest& asked, const Loader& loader) {
    auto subject = subject_of_path(asked.path_parameters, loader);
    const auto options = default_options(loader.limits(), subject);
    return PreparedComputation{.deadline = loader.limits().default_deadline,
                               .run = [kept, subject = std::move(subject), options](const Execution& execution) {
                                 return compute(*kept, subject, options, execution);
                               }};
  };
  add_get_endpoint(router, services, std::move(endpoint), std::move(ready));
}

}  // namespace

void add_family_atlas_routes(http::Router& router, Services& services) {
  const std::filesystem::path data = services.data;
  const auto kept = std::make_shared<KeptAtlases>(services.atlases, data / "atlases");
  add_kept_endpoint(router, services, kept, "/v1/families/{family}/atlas", family_in_path);
  add_kept_endpoint(router, services, kept, "/v1/isohedral-types/{type}/atlas", type_in_path);
  add_endpoint(router, services,
               {.kind = "family-atlases", .prepare = [kept](const EndpointRequest& asked, const Loader& loader) {
                  return prepare_atlas(kept, asked, loader);
                }});
}

}  // namespace supple::routes
