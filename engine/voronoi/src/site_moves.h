#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <vector>

#include "objectives.h"
#include "supple/base/random.h"

namespace supple::voronoi {

/// What a pass of SiteMoves has found.
struct SiteMovesPass {
  std::int64_t tried = 0;  ///< moves of single sites whose energy was computed
  std::int64_t taken = 0;  ///< moves that lowered the energy, and were kept
  /// Whether every site was tried with all lengths. A pass that has gained much leaves the rest to the minimizer.
  bool complete = true;
  double gain = 0;         ///< fraction of the energy by which the pass lowered it
  double step_length = 0;  ///< root of the sum of the squares of the distances that sites went, mesh units
};

/// Search for moves of single sites that lower the energy, where a line search along one direction for all sites finds
/// none. Such places are common, because the energy has kinks, where corners of cells cross edges of the mesh, and
/// jumps, where a border passes a saddle vertex: the gradients at one side say nothing about the other one.
///
/// This is a pattern search (Kolda, Lewis and Torczon 2003) for each site, in directions all around that are turned at
/// random for each length, so that many passes try all directions (Audet and Dennis 2006). A move of a site changes
/// only the energies of its own cell and of the cells next to it. Therefore sites whose neighbourhoods have no cell in
/// common move at the same time, and a pass takes some hundred diagrams, for any number of sites.
class SiteMoves {
 public:
  /// `finder` needs to find what values of the terms need. `held` has two entries for each site; `unit` is the mean
  /// cell size.
  SiteMoves(std::shared_ptr<const DiagramFinder> finder, std::vector<std::shared_ptr<DiagramTerm>> terms,
            std::vector<bool> held, double unit);

  /// Moves sites of the state, of which no diagram is known afterwards if one was moved. Throws what diagrams throw,
  /// and looks for a stop request before each of them.
  SiteMovesPass pass(SitesState& state, const Execution& execution);

 private:
  /// Sites, their diagram, and the energy of each cell.
  struct Place {
    SitesState state;
    Eigen::VectorXd energies;
    double energy = 0;
  };
  struct Move {
    double length;
    double angle;
  };

  Place evaluated(SitesState state);
  Place moved(const std::vector<std::int32_t>& sites, const Move& move);
  /// Sites that may move at the same time, class by class.
  std::vector<std::vector<std::int32_t>> independent_classes() const;
  /// Tries the move for each of these sites, and returns those that it was taken for.
  std::vector<std::int32_t> try_move(const std::vector<std::int32_t>& sites, const Move& move);
  void take(Place place, const std::vector<std::int32_t>& sites, double length);
  /// The cells whose energy changes with a move of this site to that place.
  template <class Visit>
  void visit_changed(const Place& beside, std::int32_t site, const Visit& visit) const;

  std::shared_ptr<const DiagramFinder> finder_;
  std::vector<std::shared_ptr<DiagramTerm>> terms_;
  std::vector<bool> held_;
  double unit_;
  RandomStream random_;

  // Of the present pass:
  Execution execution_;
  std::unique_ptr<Place> here_;
  SiteMovesPass pass_;
  std::vector<double> ways_;  ///< of each site the distance that it went
  double least_gain_ = 0;     ///< of a move that is taken
};

}  // namespace supple::voronoi
