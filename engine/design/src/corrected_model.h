#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "free_parameters.h"
#include "modulus_choice.h"
#include "structure_limits.h"
#include "supple/base/cancellation.h"
#include "target_residuals.h"

namespace supple::design {

/// Deviation of a design for which none can be computed.
inline constexpr double infinite = std::numeric_limits<double>::infinity();

/// The network of a problem, with corrections, as polish uses it. `x` are the free parameters, normalized to [0, 1] by
/// their bounds. `parameters` are all parameters as in FreeParameters, with the orientation last. `values` are those of
/// all samples of all targets, one target after the other. `space` must outlive it.
class CorrectedModel {
 public:
  /// `tolerance` is that of equilibria which are compared with simulations. Searches use it too, but at least 1e-8.
  CorrectedModel(const DesignSpace& space, const DesignProblem& problem, double tolerance);

  const std::vector<SampledTarget>& targets() const { return targets_; }
  const Eigen::VectorXd& width() const { return width_; }  ///< widths of the free parameters' bounds
  Eigen::Index samples() const;
  double search_tolerance() const { return search_tolerance_; }

  Eigen::VectorXd normalized(const Eigen::VectorXd& parameters) const;
  Eigen::VectorXd free_parameters(const Eigen::VectorXd& x) const;
  Eigen::VectorXd parameters_at(const Eigen::VectorXd& x) const;

  /// The targets' scale at each sample, divided by the least stress factor that the moduli allow.
  Eigen::VectorXd scales() const;
  /// One vector for each target; NaN if `values` is empty.
  std::vector<Eigen::VectorXd> split_by_target(const Eigen::VectorXd& values) const;
  /// The relative root mean square deviation of values at the best modulus; infinite if a value is missing. Here as
  /// everywhere, the values themselves are at the modulus of the model's data.
  double deviation(const Eigen::VectorXd& values) const;
  /// The modulus at which the values fit the targets best.
  ModulusChoice::Chosen modulus_for(const Eigen::VectorXd& values) const;
  /// The violated limits as sentences; empty if no limit is violated.
  std::string excess_at(const Eigen::VectorXd& parameters) const {
    return excess(space_, structure_limits_, family_part(parameters));
  }

  struct Values {
    Eigen::VectorXd values;  ///< values of the network without correction; NaN where an equilibrium is missing
    double bar = 0;          ///< root mean square of the error bars, relative to the targets' scales
  };
  Values at(const Eigen::VectorXd& parameters) const { return values_at(parameters, tolerance_); }
  /// The values at the tolerance of searches. None if the design has no structure, violates a limit, or has no
  /// equilibrium at some sample.
  std::optional<Values> feasible_values(const Eigen::VectorXd& x) const;

  /// Residuals of the network with a correction in normalized parameters. They are a function of free_parameters.
  TargetResiduals residuals(const Correction& correction) const;
  struct Step {
    Eigen::VectorXd x;
    double predicted = infinite;  ///< deviation by the corrected network
  };
  /// The design that minimizes the deviation of the corrected network within the distance `radius` (in each normalized
  /// parameter) from the point of the correction.
  Step trust_region_step(const Correction& correction, double radius, const CancellationToken& cancellation) const;

 private:
  Values values_at(const Eigen::VectorXd& parameters, double equilibrium_tolerance) const;

  DesignSpace space_;
  FreeParameters bounds_;
  Eigen::VectorXd lower_;  ///< lower bounds of the free parameters
  Eigen::VectorXd width_;
  std::vector<SampledTarget> targets_;
  std::vector<double> weights_;
  ModulusChoice moduli_;
  StructureLimits structure_limits_;
  LimitResiduals limit_residuals_;
  double tolerance_;
  double search_tolerance_;
};

/// The samples in the orientation of the parameters.
ProfileSamples oriented(ProfileSamples samples, const Eigen::VectorXd& parameters);

/// The distance, in the maximum norm, to the nearest of other designs; infinite if there are none.
double distance_to_nearest(const Eigen::VectorXd& x, const std::vector<Eigen::VectorXd>& others);

}  // namespace supple::design
