#include "loader.h"

#include <algorithm>
#include <utility>

#include "immediate_answer.h"
#include "ownership.h"
#include "request_pointers.h"
#include "supple/json/family_definitions.h"
#include "supple/json/requests.h"
#include "supple/store/store_error.h"
#include "supple/tiling/definition_text.h"
#include "supple/tiling/family_definition.h"

namespace supple::routes {

Priority priority_of_preparation(std::string_view body) {
  return std::min(json::peek_priority(body).value_or(Priority::normal), Priority::normal);
}

std::shared_ptr<const store::LoadedMesh> Loader::mesh(const std::string& id, double deadline) const {
  return fault_of_field<store::MeshNotFound>("/mesh", [&] {
    require_mesh(services_, request_, id);
    auto mesh = services_.meshes->find(id);
    if (!mesh) run(id, deadline, [&](const Execution& execution) { mesh = services_.meshes->get(id, execution); });
    return mesh;
  });
}

std::shared_ptr<const tiling::Family> Loader::family(const std::string& name) const {
  if (const auto* const shipped = tiling::find_family(name)) return {std::shared_ptr<void>(), shipped};
  const auto record = services_.store->families().family(request_.key, name);
  if (!record) {
    if (auto published = published_family(services_, request_.key, name)) return published;
    throw_family_not_found(services_, request_.key, name);
  }
  if (added_families_.find(record->id) == std::string::npos)
    added_families_ += (added_families_.empty() ? "" : ",") + record->id;
  return std::make_shared<const tiling::Family>(
      tiling::make_family(json::parse_family_definition(record->definition, limits(), cancellation())));
}

std::string Loader::definition_of_added(const std::string& name) const {
  if (tiling::find_family(name)) return {};  // whose names nobody gives to a family, so that no database is asked
  const auto record = services_.store->families().family(request_.key, name);
  if (!record) return {};
  return tiling::to_text(json::parse_family_definition(record->definition, limits(), cancellation()));
}

const surface::NearestPointSearch& Loader::nearest_search(const std::string& id, const store::LoadedMesh& mesh,
                                                          double deadline) const {
  // A search of up to this size is made within some milliseconds, for which no request waits until others have
  // computed.
  constexpr std::int64_t max_faces_at_once = 20'000;
  const bool waits = execution_ || mesh.mesh().face_count() > max_faces_at_once;
  if (waits && !mesh.has_nearest()) run(id, deadline, [&](const Execution& execution) { mesh.nearest(execution); });
  return mesh.nearest();
}

void Loader::run(const std::string& mesh, double deadline, const std::function<void(const Execution&)>& work) const {
  if (execution_) return work(*execution_);
  const double left = remaining_seconds(deadline, begin_);
  jobs::Computation loading{.kind = "meshes", .mesh = mesh, .deadline = left, .run = {}};
  loading.priority = priority_of_preparation(request_.body);
  work_now(services_, request_, std::move(loading), work);
}

}  // namespace supple::routes
