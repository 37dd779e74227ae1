#include "supple/store/mesh_cache.h"

#include <limits>

#include "supple/surface/mesh_io.h"

namespace supple::store {
namespace {

/// Bytes of a mesh (150), its solver (270), two pooled searches (100 each) and the search for nearest points (52 at
/// most), as their headers say. The rest is spare capacity of vectors.
constexpr std::int64_t bytes_per_face = 700;

}  // namespace

void LoadedMesh::make_solver(const Execution& execution) const {
  const auto lock = lock_stoppably(solver_mutex_, execution.cancellation);
  if (solver_) return;
  solver_.emplace(mesh_, execution);
  has_solver_.store(true, std::memory_order_release);
}

const surface::NearestPointSearch& LoadedMesh::nearest(const Execution& execution) const {
  if (has_nearest()) return *nearest_;
  const auto lock = lock_stoppably(nearest_mutex_, execution.cancellation);
  if (!nearest_) nearest_.emplace(*mesh_, execution);
  has_nearest_.store(true, std::memory_order_release);
  return *nearest_;
}

surface::TriangleMesh load_stored_mesh(std::string_view ply, const Execution& execution) {
  constexpr auto unlimited = std::numeric_limits<std::int64_t>::max();
  return surface::load_mesh(ply, {unlimited, unlimited}, execution);
}

std::shared_ptr<const LoadedMesh> MeshCache::touch(const std::string& id, Entry& entry) {
  if (!entry.mesh) return nullptr;
  store_.note_mesh_use(id);
  recent_.splice(recent_.begin(), recent_, entry.position);
  return entry.mesh;
}

std::shared_ptr<const LoadedMesh> MeshCache::find(const std::string& id) {
  if (!store_.may_have_mesh(id)) forget(id);
  const std::lock_guard lock(mutex_);
  const auto slot = entries_.find(id);
  return slot == entries_.end() ? nullptr : touch(id, *slot->second);
}

std::shared_ptr<const LoadedMesh> MeshCache::get(const std::string& id, const Execution& execution) {
  if (!store_.may_have_mesh(id)) forget(id);
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    auto& slot = entries_[id];
    if (!slot) slot = std::make_shared<Entry>();
    entry = slot;
    if (auto mesh = touch(id, *entry)) return mesh;
    ++entry->calls;
  }
  struct Leave {
    MeshCache& cache;
    const std::string& id;
    const std::shared_ptr<Entry>& entry;
    ~Leave() {
      const std::lock_guard lock(cache.mutex_);
      cache.leave(id, entry);
    }
  } const leaving{*this, id, entry};
  return load(id, entry, execution);
}

std::shared_ptr<const LoadedMesh> MeshCache::load(const std::string& id, const std::shared_ptr<Entry>& entry,
                                                  const Execution& execution) {
  const auto loading = lock_stoppably(entry->loading, execution.cancellation);
  {
    const std::lock_guard lock(mutex_);
    if (entry->mesh) return entry->mesh;
  }
  execution.cancellation.throw_if_requested();
  auto mesh = std::make_shared<const LoadedMesh>(std::make_shared<const surface::TriangleMesh>(
      load_stored_mesh(store_.mesh_content(id, execution.cancellation), execution)));
  store_.note_mesh_use(id);
  const std::lock_guard lock(mutex_);
  // If the mesh was forgotten meanwhile, it has been removed. It then serves the requests that asked before, and is not
  // cached.
  const auto slot = entries_.find(id);
  if (slot != entries_.end() && slot->second == entry && !entry->mesh) insert(id, *entry, mesh);
  return mesh;
}

void MeshCache::leave(const std::string& id, const std::shared_ptr<Entry>& entry) {
  if (--entry->calls > 0 || entry->mesh) return;
  const auto slot = entries_.find(id);
  if (slot != entries_.end() && slot->second == entry) entries_.erase(slot);
}

void MeshCache::put(const std::string& id, std::shared_ptr<const LoadedMesh> mesh) {
  const std::lock_guard lock(mutex_);
  auto& slot = entries_[id];
  if (!slot) slot = std::make_shared<Entry>();
  if (!slot->mesh) insert(id, *slot, std::move(mesh));
}

void MeshCache::insert(const std::string& id, Entry& entry, std::shared_ptr<const LoadedMesh> mesh) {
  entry.bytes = bytes_per_face * mesh->mesh().face_count();
  entry.mesh = std::move(mesh);
  recent_.push_front(id);
  entry.position = recent_.begin();
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
    recent_.erase(slot->second->position);
  }
  entries_.erase(slot);
}

std::size_t MeshCache::remove_unused(double seconds) {
  const auto ids = store_.remove_unused_meshes(now_milliseconds() - static_cast<std::int64_t>(1000 * seconds));
  for (const auto& id : ids) forget(id);
  return ids.size();
}

MeshCache::Size MeshCache::size() const {
  const std::lock_guard lock(mutex_);
  return {recent_.size(), bytes_, entries_.size() - recent_.size()};
}

}  // namespace supple::store
