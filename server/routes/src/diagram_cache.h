#pragma once

#include <cstddef>
#include <cstdint>
#include <list>
#include <memory>
#include <mutex>
#include <span>

#include "supple/store/mesh_cache.h"
#include "supple/voronoi/moving_diagram.h"

namespace supple::routes {

/// The Voronoi diagrams of the latest requests that asked to keep theirs. A diagram of almost the same sites is then
/// computed only where it differs. A cached diagram belongs to one request alone while that computes. The cache keeps
/// no mesh in memory. Any thread may call.
class DiagramCache {
 public:
  /// Together these limits bound each diagram to some 50 MB.
  static constexpr std::size_t max_diagrams = 4;
  static constexpr std::int32_t max_faces = 50'000;

  /// The diagram of these sites, which is cached. Throws and bills what MovingDiagram::move_to does.
  voronoi::Diagram diagram(const std::shared_ptr<const store::LoadedMesh>& mesh, const voronoi::DiagramOptions& options,
                           std::span<const surface::SurfacePoint> sites, const Execution& execution);

 private:
  struct Entry {
    std::weak_ptr<const store::LoadedMesh> mesh;
    double border_deviation;
    voronoi::MovingDiagram moving;
  };

  /// Takes out an entry whose sites are near these and whose borders deviate as asked for, if there is one.
  std::list<Entry> take(const std::shared_ptr<const store::LoadedMesh>& mesh, double border_deviation,
                        std::span<const surface::SurfacePoint> sites);

  std::mutex mutex_;
  std::list<Entry> entries_;  ///< the one used last comes first; guarded by the mutex
};

}  // namespace supple::routes
