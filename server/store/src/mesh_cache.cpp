#include "supple/store/mesh_cache.h"

#include <limits>

#include "supple/surface/mesh_io.h"

namespace supple::store {
namespace {

/// Mesh (150), solver (250) and two pooled searches (60 each), see their headers; with room for the vectors' slack.
constexpr std::int64_t bytes_per_face = 700;

}  // namespace

surface::TriangleMesh load_stored_mesh(std::string_view ply) {
  constexpr auto most = std::numeric_limits<std::int64_t>::max();
  return surface::load_mesh(ply, {most, most});
}

std::shared_ptr<const LoadedMesh> MeshCache::get(const std::string& id) {
  std::shared_ptr<Entry> entry;
  {
    const std::lock_guard lock(mutex_);
    auto& slot = entries_[id];
    if (!slot) slot = std::make_shared<Entry>();
    entry = slot;
    if (entry->mesh) {
      store_.use_mesh(id);
      recent_.splice(recent_.begin(), recent_, entry->place);
      return entry->mesh;
    }
  }
  const std::lock_guard loading(entry->loading);
  {
    const std::lock_guard lock(mutex_);
    if (entry->mesh) return entry->mesh;
  }
  std::shared_ptr<const LoadedMesh> mesh;
  try {
    mesh = std::make_shared<const LoadedMesh>(
        std::make_shared<const surface::TriangleMesh>(load_stored_mesh(store_.mesh_content(id))));
  } catch (...) {
    const std::lock_guard lock(mutex_);
    const auto slot = entries_.find(id);
    if (slot != entries_.end() && slot->second == entry && !entry->mesh) entries_.erase(slot);
    throw;
  }
  store_.use_mesh(id);
  const std::lock_guard lock(mutex_);
  // Whoever forgot the mesh meanwhile has deleted it: it serves those who asked before and is not held.
  const auto slot = entries_.find(id);
  if (slot != entries_.end() && slot->second == entry && !entry->mesh) keep(id, *entry, mesh);
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
