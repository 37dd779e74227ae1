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

/// The deviation of what is not known.
inline constexpr double infinite = std::numeric_limits<double>::infinity();

/// The network of a problem as polish sees it: designs are free parameters as shares of the bounds' widths,
/// "parameters" are all as in FreeParameters, the orientation the last of them. Values are those of all samples of all
/// targets, one target after the other. `space` outlives it.
class CorrectedModel {
 public:
  /// `tolerance` of equilibria, where simulations are compared; searches do with 1e-8.
  CorrectedModel(const DesignSpace& space, const DesignProblem& problem, double tolerance);

  const std::vector<SampledTarget>& targets() const { return targets_; }
  const Eigen::VectorXd& width() const { return width_; }  ///< of the free parameters' bounds
  Eigen::Index samples() const;
  double search_tolerance() const { return search_tolerance_; }

  Eigen::VectorXd shares(const Eigen::VectorXd& parameters) const;
  Eigen::VectorXd free_parameters(const Eigen::VectorXd& x) const;
  Eigen::VectorXd parameters_at(const Eigen::VectorXd& x) const;

  /// The targets' scale at each sample; with the least modulus there is, as values are of the model's.
  Eigen::VectorXd scales() const;
  std::vector<Eigen::VectorXd> parts_of(const Eigen::VectorXd& values) const;  ///< for each target; NaN for no values
  /// The relative root mean square deviation of values; infinite where one is missing. Values are of the model's
  /// modulus, here as everywhere, and are compared with the best modulus there is.
  double deviation(const Eigen::VectorXd& values) const;
  /// The best modulus for values.
  ModulusChoice::Chosen modulus_for(const Eigen::VectorXd& values) const;
  /// What is beyond the limits, as a sentence; empty if nothing is.
  std::string excess_at(const Eigen::VectorXd& parameters) const {
    return excess(space_, limits_asked_, family_part(parameters));
  }

  struct Values {
    Eigen::VectorXd values;  ///< of the network alone; NaN where an equilibrium is missing
    double bar = 0;          ///< relative root mean square of their error bars, as deviations
  };
  Values at(const Eigen::VectorXd& parameters) const { return values_at(parameters, tolerance_); }
  /// Roughly, as searches do; nothing where there is no structure, or no equilibrium at every sample.
  std::optional<Values> find(const Eigen::VectorXd& x) const;

  /// Deviations of the network with a correction, everything of which is by shares of the widths; a function of
  /// free_parameters.
  TargetResiduals residuals(const Correction& correction) const;
  struct Step {
    Eigen::VectorXd x;
    double promised = infinite;  ///< deviation
  };
  /// The best design of the corrected network within so much of the correction's place.
  Step step_within(const Correction& correction, double radius, const CancellationToken& cancellation) const;

 private:
  Values values_at(const Eigen::VectorXd& parameters, double equilibrium_tolerance) const;

  DesignSpace space_;
  FreeParameters bounds_;
  Eigen::VectorXd lower_;  ///< of the free parameters
  Eigen::VectorXd width_;
  std::vector<SampledTarget> targets_;
  std::vector<double> weights_;
  ModulusChoice moduli_;
  StructureLimits limits_asked_;
  LimitRows limits_;
  double tolerance_;
  double search_tolerance_;
};

/// The samples for a structure with these parameters, in its orientation.
ProfileSamples turned(ProfileSamples samples, const Eigen::VectorXd& parameters);

/// The largest difference of a parameter from the nearest of other designs; infinite without any.
double distance_to_nearest(const Eigen::VectorXd& x, const std::vector<Eigen::VectorXd>& others);

}  // namespace supple::design
