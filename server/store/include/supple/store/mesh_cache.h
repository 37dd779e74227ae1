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

/// The mesh of a stored file, O(its bytes). It is loaded whatever its size: the limits of its upload may have changed
/// since. Throws as surface::load_mesh does.
surface::TriangleMesh load_stored_mesh(std::string_view ply, const Execution& execution = {});

/// A mesh in memory with two search structures, each of which is built when it is first needed. Any thread may call.
class LoadedMesh {
 public:
  explicit LoadedMesh(std::shared_ptr<const surface::TriangleMesh> mesh) : mesh_(std::move(mesh)) {}
  const surface::TriangleMesh& mesh() const { return *mesh_; }
  /// The geodesic solver. The first call builds it, which takes three times the memory of the mesh, and some tenths of
  /// a second for a million faces. Only a computation that needs it should call this; others wait meanwhile. The build
  /// ends within some ten milliseconds of a stop request; then the next caller builds the solver.
  const surface::GeodesicSolver& solver(const Execution& execution = {}) const {
    if (!has_solver_.load(std::memory_order_acquire)) make_solver(execution);
    return *solver_;
  }
  /// Finds the points of the surface that are nearest to points in space. The first call builds it; nearest_point.h
  /// says at what cost.
  const surface::NearestPointSearch& nearest(const Execution& execution = {}) const;
  /// Whether the search of nearest() has been built.
  bool has_nearest() const { return has_nearest_.load(std::memory_order_acquire); }

 private:
  void make_solver(const Execution& execution) const;

  const std::shared_ptr<const surface::TriangleMesh> mesh_;
  mutable StoppableMutex solver_mutex_;
  mutable std::atomic<bool> has_solver_{false};
  mutable std::optional<surface::GeodesicSolver> solver_;
  mutable StoppableMutex nearest_mutex_;
  mutable std::atomic<bool> has_nearest_{false};
  mutable std::optional<surface::NearestPointSearch> nearest_;
};

/// Least-recently-used cache of meshes, up to a limit of memory. A mesh that a computation uses stays in memory until
/// the computation ends, whatever the limit. The mesh that was used last is always cached.
class MeshCache {
 public:
  MeshCache(MeshStore& store, std::int64_t max_bytes) : store_(store), max_bytes_(max_bytes) {}

  /// The mesh if it is cached, otherwise null. Takes microseconds.
  std::shared_ptr<const LoadedMesh> find(const std::string& id);
  /// The mesh, which is loaded if it is not cached. Of several requests for one mesh, one loads it and the others wait.
  /// Loading and waiting end within some ten milliseconds of a stop request; if the request that loads is stopped,
  /// another one loads the mesh. Throws "mesh.not_found", "store.corrupted". A stored mesh is loaded whatever the
  /// limits of meshes are now.
  std::shared_ptr<const LoadedMesh> get(const std::string& id, const Execution& execution = {});
  /// Caches a mesh that is in memory already.
  void put(const std::string& id, std::shared_ptr<const LoadedMesh> mesh);
  void forget(const std::string& id);
  /// Removes the meshes that nobody has used for so many seconds from the store and from the cache. Returns their
  /// number.
  std::size_t remove_unused(double seconds);

  struct Size {
    std::size_t meshes = 0;
    std::int64_t bytes = 0;
    std::size_t loading = 0;  ///< meshes that are being loaded
  };
  Size size() const;

 private:
  struct Entry {
    StoppableMutex loading;
    int calls = 0;  ///< calls of get() that load the mesh or wait for it
    std::shared_ptr<const LoadedMesh> mesh;
    std::int64_t bytes = 0;
    std::list<std::string>::iterator position;
  };
  /// Loads the mesh of an entry, unless another call has loaded it.
  std::shared_ptr<const LoadedMesh> load(const std::string& id, const std::shared_ptr<Entry>& entry,
                                         const Execution& execution);
  // The caller of the following functions holds the mutex.
  /// The entry's mesh, which is marked as used now; null where it is not loaded.
  std::shared_ptr<const LoadedMesh> touch(const std::string& id, Entry& entry);
  /// A call of get() ends. The last one removes an entry for which no call has loaded a mesh.
  void leave(const std::string& id, const std::shared_ptr<Entry>& entry);
  void insert(const std::string& id, Entry& entry, std::shared_ptr<const LoadedMesh> mesh);

  MeshStore& store_;
  const std::int64_t max_bytes_;
  mutable std::mutex mutex_;
  std::map<std::string, std::shared_ptr<Entry>> entries_;
  std::list<std::string> recent_;  // ids of the loaded meshes, the last used first
  std::int64_t bytes_ = 0;
};

}  // namespace supple::store
