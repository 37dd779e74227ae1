#pragma once

#include <vector>

#include "sites_state.h"
#include "supple/base/execution.h"
#include "supple/surface/geodesic_solver.h"
#include "supple/voronoi/moving_diagram.h"

namespace supple::voronoi {

/// The quantities of a state that the terms need, besides the diagram.
struct RequiredQuantities {
  bool edge_lengths = false;
  bool motions = false;
  bool border_gradients = false;
  bool cell_moments = false;
  double border_deviation = DiagramOptions{}.border_deviation;
};

/// Evaluates the diagram of a state and the quantities that the terms need, once for each state. If most sites are
/// fixed, it recomputes only the faces around the others. One thread at a time may use it.
class DiagramEvaluator {
 public:
  /// `solver` must outlive this.
  DiagramEvaluator(const surface::GeodesicSolver& solver, RequiredQuantities required)
      : solver_(solver),
        required_(required),
        moving_(solver, {.border_deviation = required.border_deviation,
                         .vertex_gradients = required.motions,
                         .border_samples = required.border_gradients,
                         .cell_moments = required.cell_moments}) {}

  /// Evaluates a state. Order 0: the diagram and what values need. Order 1: also the motions of the Voronoi vertices.
  void evaluate(SitesState& state, int order, const Execution& execution) const;

  const surface::GeodesicSolver& solver() const { return solver_; }

 private:
  const surface::GeodesicSolver& solver_;
  RequiredQuantities required_;
  mutable MovingDiagram moving_;  ///< a cache that does not affect the results
};

/// The geodesics between the vertices of all edges that have two; `edges` gets the indices of these edges.
std::vector<surface::TangentGeodesic> measure_edges(const surface::GeodesicSolver& solver, const Diagram& diagram,
                                                    std::vector<std::int32_t>& edges, const Execution& execution);

}  // namespace supple::voronoi
