#include "supple/store/mesh_cache.h"

#include <limits>

#include "supple/surface/mesh_io.h"

namespace supple::store {
namespace {

/// Mesh (150), solver (250), two pooled searches (60 each) and the search for nearest points (30), see their headers;
/// with room for the vectors' slack.
constexpr std::int64_t bytes_per_face = 700;

}  // namespace

void LoadedMesh::make_solver(const Execution& execution) const {
  const auto lock = lock_stoppably(making_, execution.cancellation);
  if (solver_) return;
  solver_.emplace(mesh_, execution);
  is_made_.store(true, std::memory_order_release);
}

const surface::NearestPointSearch& LoadedMesh::nearest(const Execution& execution) const {
  if (has_nearest()) return *nearest_;
  const auto lock = lock_stoppably(making_nearest_, execution.cancellation);
  if (!nearest_) nearest_.emplace(*mesh_, execution);
  has_nearest_.store(true, std::memory_order_release);
  return *nearest_;
}

surface::TriangleMesh load_stored_mesh(std::string_view ply, const Execution& execution) {
  constexpr auto most = std::numeric_limits<std::int64_t>::max();
  return surface::load_mesh(ply, {most, most}, execution);
}

std::shared_ptr<const LoadedMesh> MeshCache::use(const std::string& id, Entry& entry) {
  if (!entry.mesh) return nullptr;
  store_.use_mesh(id);
  recent_.splice(recent_.begin(), recent_, entry.place);
  return entry.mesh;
}

std::shared_ptr<const LoadedMesh> MeshCache::find(const std::string& id) {
  if (!store_.still_has_mesh(id)) forget(id);
  const std::lock_guard lock(mutex_);
  const auto slot = entries_.find(id);
  return slot == entries_.end() ? nullptr : use(id, *slot->second);
}

std::shared_ptr<const LoadedMesh> MeshCache::get(const std::string& id, const Execution& execution) {
  if (!store_.still_has_mesh(id)) forget(id);
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    auto& slot = entries_[id];
    if (!slot) slot = std::make_shared<Entry>();
    entry = slot;
    if (auto mesh = use(id, *entry)) return mesh;
  }
  std::shared_ptr<const LoadedMesh> mesh;
  try {
    const auto loading = lock_stoppably(entry->loading, execution.cancellation);
    {
      const std::lock_guard lock(mutex_);
      if (entry->mesh) return entry->mesh;
    }
    execution.cancellation.throw_if_requested();
    mesh = std::make_shared<const LoadedMesh>(std::make_shared<const surface::TriangleMesh>(
        load_stored_mesh(store_.mesh_content(id, execution.cancellation), execution)));
    store_.use_mesh(id);
    const std::lock_guard lock(mutex_);
    // Whoever forgot the mesh meanwhile has deleted it: it serves those who asked before and is not held.
    const auto slot = entries_.find(id);
    if (slot != entries_.end() && slot->second == entry && !entry->mesh) keep(id, *entry, mesh);
  } catch (...) {
    const std::lock_guard lock(mutex_);
    const auto slot = entries_.find(id);
    constexpr long of_the_map_and_this_call = 2;  // further ones wait, and load it in turn
    if (slot != entries_.end() && slot->second == entry && !entry->mesh &&
        entry.use_count() == of_the_map_and_this_call)
      entries_.erase(slot);
    throw;
  }
  return mesh;
}

void MeshCache::put(const std::string& id, std::shared_ptr<const LoadedMesh> mesh) {
  const std::lock_guard lock(mutex_);
  auto& slot = entries_[id];
  if (!slot) slot = std::make_shared<Entry>();
  if (!slot->mesh) keep(id, *slot, std::move(mesh));
}

void MeshCache::keep(const std::string& id, Entry& entry, std::shared_ptr<const LoadedMesh> mesh) {
  entry.bytes = bytes_per_face * mesh->mesh().face_count();
  entry.mesh = std::move(mesh);
  recent_.push_front(id);
  entry.place = recent_.begin();
  bytes_ += entry.bytes;
  while (bytes_ > max_bytes_ && recent_.size() > 1) {
    const auto oldest = entries_.find(recent_.back());
    bytes_ -= oldest->second->bytes;
    entries_.erase(oldest);
    recent_.pop_back();
  }
}

void MeshCache::forget(const std::string& id) {
  const std::lock_guard lock(mutex_);
  const auto slot = entries_.find(id);
  if (slot == entries_.end()) return;
  if (slot->second->mesh) {
    bytes_ -= slot->second->bytes;
    recent_.erase(slot->second->place);
  }
  entries_.erase(slot);
}

std::size_t MeshCache::remove_unused(Store& store, double seconds) {
  const auto ids = store.remove_unused_meshes(now_milliseconds() - static_cast<std::int64_t>(1000 * seconds));
  for (const auto& id : ids) forget(id);
  return ids.size();
}

MeshCache::Size MeshCache::size() const {
  const std::lock_guard lock(mutex_);
  return {recent_.size(), bytes_};
}

}  // namespace supple::store
