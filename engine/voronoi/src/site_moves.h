#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "objectives.h"
#include "supple/base/random.h"

namespace supple::voronoi {

/// The result of a pass of SiteMoves.
struct SiteMovesPass {
  std::int64_t tried = 0;  ///< single-site moves whose energy was computed
  std::int64_t taken = 0;  ///< single-site moves that lowered the energy and were accepted
  /// Whether every site was tried with all lengths. A pass that has lowered the energy enough leaves the rest to the
  /// minimizer.
  bool complete = true;
  double gain = 0;         ///< fraction of the energy by which the pass lowered it
  double step_length = 0;  ///< root of the sum of the sites' squared displacements, mesh units
};

/// A search for single-site moves that lower the energy, where a line search along one direction for all sites finds
/// none. This is common, because the energy has kinks, where corners of cells cross edges of the mesh, and jumps, where
/// a border passes a saddle vertex. The gradients on one side tell nothing about the other side.
///
/// This is a pattern search for each site [Kolda2003], in directions all around it that are turned at random for each
/// length, so that many passes try all directions [Audet2006]. A move of a site changes only the energies of its own
/// cell and of the cells next to it. Therefore sites whose neighbourhoods have no cell in common move at the same time,
/// and a pass costs a few hundred diagrams, for any number of sites.
class SiteMoves {
 public:
  /// `evaluator` must compute the quantities that the terms' values need. `fixed` has two entries for each site. `unit`
  /// is the mean cell size.
  SiteMoves(std::shared_ptr<const DiagramEvaluator> evaluator, std::vector<std::shared_ptr<DiagramTerm>> terms,
            std::vector<bool> fixed, double unit);

  /// Moves sites of the state. If one was moved, the state has no diagram afterwards. Throws what diagrams throw, and
  /// checks for a stop request before each of them.
  SiteMovesPass pass(SitesState& state, const Execution& execution);

 private:
  /// Sites with their diagram and the energy of each cell.
  struct EvaluatedSites {
    SitesState state;
    Eigen::VectorXd energies;
    double energy = 0;
  };
  struct Move {
    double length;
    double angle;
  };

  EvaluatedSites evaluate(SitesState state);
  EvaluatedSites evaluate_move(const std::vector<std::int32_t>& sites, const Move& move);
  /// Classes of sites that may move at the same time.
  std::vector<std::vector<std::int32_t>> independent_classes() const;
  /// Tries the move for each of these sites, and returns those for which it was accepted.
  std::vector<std::int32_t> try_move(const std::vector<std::int32_t>& sites, const Move& move);
  void accept(EvaluatedSites trial, const std::vector<std::int32_t>& sites, double length);
  /// Visits the cells whose energy changes if the site moves from the current state to the trial state.
  template <class Visit>
  void visit_changed(const EvaluatedSites& trial, std::int32_t site, const Visit& visit) const;

  std::shared_ptr<const DiagramEvaluator> evaluator_;
  std::vector<std::shared_ptr<DiagramTerm>> terms_;
  std::vector<bool> fixed_;
  double unit_;
  RandomStream random_;

  // State of the present pass.
  Execution execution_;
  std::unique_ptr<EvaluatedSites> current_;
  SiteMovesPass pass_;
  std::vector<double> moved_lengths_;  ///< length that each site has moved, mesh units
  double min_gain_ = 0;                ///< minimum decrease of the energy for a move to be accepted
};

}  // namespace supple::voronoi
