#pragma once

#include <cstdint>
#include <vector>

namespace supple::numerics {

/// A state that a line search reaches only by chance: a place where the energy is not differentiable and may have its
/// minimum, or a trial state in which only the parts beside such a place have moved less than the others.
template <class S>
struct NonsmoothCandidate {
  S state;
  std::int64_t id = 0;     ///< the same for the same place
  double distance = 0;     ///< distance from the current state
  bool coincides = false;  ///< whether the current state differs from `state` by rounding only
};

/// Proposes states where an energy is not differentiable. A system that has a search tries them where a step had to be
/// shortened, and takes the best one if it lowers the energy.
template <class S>
class NonsmoothSearch {
 public:
  virtual ~NonsmoothSearch() = default;

  /// Candidates near the current state. `trials` are the trial states since it became the current one, the first one
  /// first; the terms of the energy have prepared all of them. `reach` is the length of the longest of those steps.
  virtual std::vector<NonsmoothCandidate<S>> candidates(const S& current, const std::vector<S>& trials,
                                                        double reach) const = 0;
};

}  // namespace supple::numerics
