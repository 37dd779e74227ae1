#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "free_parameters.h"
#include "modulus_choice.h"
#include "structure_limits.h"
#include "supple/design/inverse_design.h"
#include "target_residuals.h"

namespace supple::design {

/// Relative root mean square deviation up to which a reached target needs no further starting points. A larger
/// deviation may be a local minimum.
inline constexpr double good_deviation = 1e-3;

/// Number of samples of each target at which candidates are compared. It is not a multiple of two or three. If it were,
/// evenly spaced directions would give only a few different values for a structure with rotational symmetry by a
/// quarter or a sixth of a turn.
inline constexpr int coarse_samples = 11;

/// Maximum tolerance of equilibria during a search.
inline constexpr double search_tolerance = 1e-6;

/// Minimum distance of starting points, as a fraction of the bounds' widths.
inline constexpr double min_start_distance = 0.035;

/// The problem of a search for one material: targets, free parameters and limits, and the residuals that compare
/// designs with them.
class SearchProblem {
 public:
  /// `problem` has at most one range of moduli; `materials` are the ranges of all materials. The arguments must outlive
  /// the object.
  SearchProblem(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options,
                const ModulusChoice& materials);
  SearchProblem(const SearchProblem&) = delete;
  SearchProblem& operator=(const SearchProblem&) = delete;

  /// Residuals at the tolerance of the answer. If all parameters are fixed, a design is described even if it cannot be
  /// built.
  TargetResiduals exact_residuals() const;
  /// Residuals that searches minimize. `outlier_threshold` is that of TargetResiduals.
  TargetResiduals search_residuals(const std::vector<SampledTarget>& at_targets, double equilibrium_tolerance,
                                   double outlier_threshold) const;

  /// All parameters of the request's starting point, which there must be.
  Eigen::VectorXd requested_start() const;
  /// Whether one of the points (all parameters) is closer than `distance`, a fraction of the bounds' widths in the
  /// maximum norm.
  bool is_near_any(const std::vector<Eigen::VectorXd>& points, const Eigen::VectorXd& point, double distance) const;
  /// Whether searches with few samples come first.
  bool has_many_samples() const;
  int max_starts() const;
  /// Whether error bars count in the comparison of designs. A request with a starting point asks for a design near it,
  /// so that automatic means off.
  bool weighs_trust() const;

  const DesignSpace& space;
  const DesignProblem& problem;
  const DesignOptions& options;
  const ModulusChoice& materials;
  const FreeParameters bounds;
  const ModulusChoice moduli;
  const LimitResiduals limits;
  std::vector<SampledTarget> targets;
  std::vector<double> weights;
};

/// What a search has done so far.
struct SearchCounts {
  int starts = 0;
  int iterations = 0;
  std::int64_t evaluations = 0;  ///< strains at which the network was evaluated
  std::int64_t restarts = 0;     ///< equilibria that were computed again from rest

  void add(const TargetResiduals& residuals) {
    evaluations += residuals.evaluations();
    restarts += residuals.restarts();
  }
};

}  // namespace supple::design
