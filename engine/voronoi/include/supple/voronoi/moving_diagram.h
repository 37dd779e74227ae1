#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"
#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// How the last diagram was computed.
struct DiagramRebuild {
  /// Whether only the faces around moved sites were recomputed.
  bool local = false;
  std::int32_t moved_sites = 0;  ///< number of moved sites; all sites if the rebuild was not local
  std::int32_t cut_faces = 0;    ///< number of recomputed faces
};

/// The Voronoi diagram of sites that move, for a site that is dragged or for sites most of which stay in place.
///
/// If few sites have moved since the last diagram, only the faces in which a moved site's old or new cell has a part
/// are cut again. They are found by a propagation of windows from the new positions, which ends where the cached
/// distances of the vertices show that other sites are nearer. A second propagation starts from all sites that have a
/// part of one of these faces. No other site is needed, because a shortest path stays in its cell. Where a site has
/// moved away, it stays within the old cells of that site and of its neighbours. The result equals that of a full
/// computation up to rounding. Where regions are equally near to two sites, the choice between the two may differ.
///
/// Memory: 54 bytes for each face of the mesh, 95 with cell moments, and for each cut face 0.5 KB and 70 bytes for each
/// face that the paths from it to its sites cross (1.5 KB and 190 bytes with all that derivatives need): what stays
/// follows the borders and not the number of sites. While a diagram is computed, the windows that reach each face are
/// in memory too; they end soon after they have left their site's cell. One thread at a time may use it.
class MovingDiagram {
 public:
  /// `solver` must outlive this. Diagrams of the methods `bounded` and `edges` are always computed in full.
  explicit MovingDiagram(const surface::GeodesicSolver& solver, const DiagramOptions& options = {});
  ~MovingDiagram();
  MovingDiagram(MovingDiagram&&) noexcept;
  MovingDiagram& operator=(MovingDiagram&&) noexcept;

  /// Computes the diagram of these sites, whose number may change; the result is valid until the next call. Throws and
  /// bills what `diagram` does, and bills the quantity "local_rebuilds". After an exception the next diagram is
  /// computed in full. Cost of a local rebuild: cutting the affected faces again, and a tenth of a full diagram for the
  /// assembly.
  const Diagram& move_to(std::span<const surface::SurfacePoint> sites, const Execution& execution = {});

  /// The last diagram; one without sites before the first call of move_to.
  const Diagram& diagram() const;
  /// Moves the last diagram out. The next call of move_to may still be a local rebuild, because the faces stay cached.
  Diagram take_diagram();
  /// How the last diagram was computed.
  const DiagramRebuild& last_rebuild() const;
  /// Bytes that stay between two diagrams, without the diagram itself.
  std::int64_t memory_bytes() const;
  /// Whether move_to would rebuild the diagram of these sites locally. Throws what surface::checked_point throws.
  bool is_near(std::span<const surface::SurfacePoint> sites) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::voronoi
