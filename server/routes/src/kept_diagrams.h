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

/// The Voronoi diagrams that were kept last, so that one of almost the same sites is made only where it differs. A
/// diagram that a request goes on from is that request's alone while it computes. Keeps no mesh in memory. All members
/// may be called from several threads at once.
class KeptDiagrams {
 public:
  /// So many diagrams of meshes of so many faces: some 50 MB each at most.
  static constexpr std::size_t most_diagrams = 4;
  static constexpr std::int32_t most_faces = 50'000;

  /// The diagram of these sites, which is kept. Throws and bills what MovingDiagram::move_to does.
  voronoi::Diagram diagram(const std::shared_ptr<const store::LoadedMesh>& mesh, const voronoi::DiagramOptions& options,
                           std::span<const surface::SurfacePoint> sites, const Execution& execution);

 private:
  struct Kept {
    std::weak_ptr<const store::LoadedMesh> mesh;
    double border_deviation;
    voronoi::MovingDiagram moving;
  };

  /// Takes one out that is near and has borders as they are asked for, if there is one.
  std::list<Kept> take(const std::shared_ptr<const store::LoadedMesh>& mesh, double border_deviation,
                       std::span<const surface::SurfacePoint> sites);

  std::mutex mutex_;
  std::list<Kept> kept_;  ///< the one used last first
};

}  // namespace supple::routes
