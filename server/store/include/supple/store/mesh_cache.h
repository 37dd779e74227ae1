#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <list>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <shared_mutex>
#include <string>
#include <string_view>

#include "supple/base/execution.h"
#include "supple/store/stoppable_mutex.h"
#include "supple/store/store.h"
#include "supple/surface/geodesic_solver.h"
#include "supple/surface/nearest_point.h"

namespace supple::store {

/// The mesh of a stored file, O(its bytes). No limit of meshes applies: the one under which it was accepted did, and
/// may have been changed since. Throws as surface::load_mesh.
surface::TriangleMesh load_stored_mesh(std::string_view ply, const Execution& execution = {});

/// A mesh in memory, with what its geodesics need from when they are asked for on. Any thread may call.
class LoadedMesh {
 public:
  explicit LoadedMesh(std::shared_ptr<const surface::TriangleMesh> mesh) : mesh_(std::move(mesh)) {}
  const surface::TriangleMesh& mesh() const { return *mesh_; }
  /// The first call makes it, which takes three times the memory of the mesh and some tenths of a second for a million
  /// faces: within the computation that needs it, not where a mesh is only stored or looked at. Others wait for that.
  /// A stop is heard within some ten milliseconds, then another one makes it.
  const surface::GeodesicSolver& solver(const Execution& execution = {}) const {
    if (!is_made_.load(std::memory_order_acquire)) make_solver(execution);
    return *solver_;
  }
  /// Finds the points of the surface that are nearest to points in space. The first call makes it, see its header.
  const surface::NearestPointSearch& nearest(const Execution& execution = {}) const;
  /// Whether nearest() answers at once.
  bool has_nearest() const { return has_nearest_.load(std::memory_order_acquire); }

 private:
  void make_solver(const Execution& execution) const;

  const std::shared_ptr<const surface::TriangleMesh> mesh_;
  mutable StoppableMutex making_;
  mutable std::atomic<bool> is_made_{false};
  mutable std::optional<surface::GeodesicSolver> solver_;
  mutable StoppableMutex making_nearest_;
  mutable std::atomic<bool> has_nearest_{false};
  mutable std::optional<surface::NearestPointSearch> nearest_;
};

/// Holds the meshes that were used last, up to a limit of memory. A mesh that a computation uses stays until the
/// computation ends, whatever the limit; the one used last is always held.
class MeshCache {
 public:
  MeshCache(const Store& store, std::int64_t max_bytes) : store_(store), max_bytes_(max_bytes) {}

  /// The mesh if it is held, otherwise null. Takes microseconds.
  std::shared_ptr<const LoadedMesh> find(const std::string& id);
  /// Loads the mesh if it is not held; of several requests for one mesh, one loads it and the others wait. A stop is
  /// heard within some ten milliseconds, while it waits too; where the one that loads is stopped, another one loads.
  /// Throws "mesh.not_found", "store.corrupted". A stored mesh loads whatever the limits of meshes are now.
  std::shared_ptr<const LoadedMesh> get(const std::string& id, const Execution& execution = {});
  /// Holds a mesh that is in memory already.
  void put(const std::string& id, std::shared_ptr<const LoadedMesh> mesh);
  void forget(const std::string& id);
  /// Removes from `store`, and forgets, what nobody has used for so many seconds. Returns their number.
  std::size_t remove_unused(Store& store, double seconds);

  struct Size {
    std::size_t meshes = 0;
    std::int64_t bytes = 0;
  };
  Size size() const;

 private:
  struct Entry {
    StoppableMutex loading;
    std::shared_ptr<const LoadedMesh> mesh;
    std::int64_t bytes = 0;
    std::list<std::string>::iterator place;
  };
  /// Under the mutex: the entry's mesh, which counts as used now; null where it has none.
  std::shared_ptr<const LoadedMesh> use(const std::string& id, Entry& entry);
  void keep(const std::string& id, Entry& entry, std::shared_ptr<const LoadedMesh> mesh);

  const Store& store_;
  const std::int64_t max_bytes_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Entry>> entries_;
  std::list<std::string> recent_;  // of the loaded ones, the last used first
  std::int64_t bytes_ = 0;
};

}  // namespace supple::store
