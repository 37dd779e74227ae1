#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"
#include "supple/voronoi/diagram.h"

namespace supple::voronoi {

/// How a diagram was made.
struct DiagramRebuild {
  /// Whether only the surroundings of sites that are elsewhere now were made anew.
  bool local = false;
  std::int32_t moved_sites = 0;  ///< all where it was not
  std::int32_t cut_faces = 0;    ///< faces that were looked at anew
};

/// The Voronoi diagram of sites that move, for a site that is dragged or sites of which most stay.
///
/// Where few sites have moved since the last diagram, only faces are cut again that have a part of a moved site's old
/// or new cell. These are found by a propagation from the new places, which ends where other sites are nearer by the
/// distances that vertices have; what reaches them comes from the sites that have a part of one of them, because a
/// shortest path stays in its cell, and where a site has left it stays within the old cells of that site and its
/// neighbours. The diagram is the same as one made anew but for rounding and, where regions are equally near to two
/// sites, the choice between them.
///
/// Memory: about 1 KB for each cut face. For one thread at a time.
class MovingDiagram {
 public:
  /// `solver` outlives it. Distances with an allowed error or along edges are always made anew.
  explicit MovingDiagram(const surface::GeodesicSolver& solver, const DiagramOptions& options = {});
  ~MovingDiagram();
  MovingDiagram(MovingDiagram&&) noexcept;
  MovingDiagram& operator=(MovingDiagram&&) noexcept;

  /// The diagram of these sites, of any number; valid until the next call. Throws and bills what `diagram` does, and
  /// bills the quantity "local_rebuilds". After an exception the next diagram is made anew. Cost: that of the faces
  /// that are cut again, and a tenth of a whole diagram for putting it together.
  const Diagram& move_to(std::span<const surface::SurfacePoint> sites, const Execution& execution = {});

  /// The last one; that of no sites before the first.
  const Diagram& diagram() const;
  /// Hands it over. The next one is made from what is kept all the same.
  Diagram take_diagram();
  /// How the last one was made.
  const DiagramRebuild& last_rebuild() const;
  /// Whether a diagram of these sites would be made locally. Throws what surface::checked_point throws.
  bool is_near(std::span<const surface::SurfacePoint> sites) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace supple::voronoi
