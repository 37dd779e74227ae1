#pragma once

#include <vector>

#include "sites_state.h"
#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"
#include "supple/voronoi/moving_diagram.h"

namespace supple::voronoi {

/// Which of what a state can know the terms need.
struct Needs {
  bool edge_lengths = false;
  bool motions = false;
  bool border_pulls = false;
  bool cell_moments = false;
  double border_deviation = DiagramOptions{}.border_deviation;
};

/// Finds what terms ask for at a state, once. Diagrams are made anew only round sites that have moved where most are
/// held. For one thread at a time.
class DiagramFinder {
 public:
  /// `solver` outlives the finder.
  DiagramFinder(const surface::GeodesicSolver& solver, Needs needs)
      : solver_(solver),
        needs_(needs),
        moving_(solver, {.border_deviation = needs.border_deviation,
                         .vertex_pulls = needs.motions,
                         .border_samples = needs.border_pulls,
                         .cell_moments = needs.cell_moments}) {}

  /// Order 0: the diagram, and what values need; 1: motions of vertices too.
  void find(SitesState& state, int order, const Execution& execution) const;

  const surface::GeodesicSolver& solver() const { return solver_; }

 private:
  const surface::GeodesicSolver& solver_;
  Needs needs_;
  mutable MovingDiagram moving_;  ///< never changes what is found
};

/// The geodesics between the vertices of all edges that have two: `edges` receives their indices.
std::vector<surface::TangentGeodesic> measure_edges(const surface::GeodesicSolver& solver, const Diagram& diagram,
                                                    std::vector<std::int32_t>& edges, const Execution& execution);

}  // namespace supple::voronoi
