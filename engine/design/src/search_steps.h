#pragma once

#include "best_design.h"
#include "local_search.h"
#include "ranked_candidates.h"
#include "search_problem.h"

namespace supple::design {

/// What the steps of a search share.
struct SearchState {
  const SearchProblem& problem;
  RankedCandidates& candidates;
  BestDesign& best;
  SearchCounts& counts;
};

/// Searches from the best candidates, which are far enough from each other, until one search reaches the target.
/// Candidates are taken in turn from the rankings with reduced outliers and with plain squares. Targets with many
/// samples are first optimized with few samples from all starting points; the best minima are then refined with all
/// samples.
void search_from_candidates(const SearchState& state, LocalSearch& local, const Execution& execution);

/// The effort of search_trusted_designs.
struct TrustEffort {
  int evaluations = 0;
  double seconds = 0;
};

/// Looks for designs with a smaller merit, which may have a larger deviation: among the candidates, and then around the
/// best design. Error bars are discontinuous where a sample begins to be trusted, so that no derivatives are used.
TrustEffort search_trusted_designs(const SearchState& state, const Execution& execution);

}  // namespace supple::design
