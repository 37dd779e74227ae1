#pragma once

#include <vector>

#include "karcher_state.h"
#include "supple/numerics/nonsmooth_search.h"

namespace supple::surface {

/// Proposes vertices where shortest paths bend: squared distances are like the tip of a cone there and may have their
/// minimum. Candidates are the corners of the faces that the current state and the trial states lie in.
class KarcherVertexSearch : public numerics::NonsmoothSearch<KarcherState> {
 public:
  /// `mesh` outlives the search.
  explicit KarcherVertexSearch(const TriangleMesh& mesh) : mesh_(mesh) {}

  std::vector<numerics::NonsmoothCandidate<KarcherState>> candidates(const KarcherState& current,
                                                                     const std::vector<KarcherState>& trials,
                                                                     double reach) const override;

 private:
  const TriangleMesh& mesh_;
};

}  // namespace supple::surface
