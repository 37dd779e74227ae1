#pragma once

#include <limits>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "modulus_choice.h"
#include "profile_trust.h"
#include "structure_limits.h"
#include "supple/design/inverse_design.h"

namespace supple::design {

/// The signed square root of the Cauchy loss of a deviation d, c sqrt(log(1 + (d/c)^2)) with the sign of d, and its
/// derivative. It approaches d for |d| << c, and grows ever more slowly for larger deviations (outliers).
struct RobustDeviation {
  double value = 0;
  double slope = 1;
};
RobustDeviation robust_deviation(double deviation, double c);

/// Values that are added to a model's values, for example to approximate a simulation: offset + slope (x - at) at the
/// free parameters x. There is one entry or row for each sample of all targets, one target after the other.
struct Correction {
  Eigen::VectorXd offset;
  Eigen::MatrixXd slope;
  Eigen::VectorXd at;
};

/// The outer problem of inverse design as a function of the free parameters. The residuals are r = sqrt(w) deviation /
/// scale over all samples of all targets, so that |r| is the relative root mean square deviation.
class TargetResiduals : public numerics::ResidualFunction {
 public:
  /// `fixed_values` is that of FreeParameters. The orientation comes from the parameters; `targets` have orientation 0.
  /// If `outlier_threshold` is positive, the Cauchy loss reduces the influence of deviations that exceed this fraction
  /// of the target's scale. It serves profiles that jump from one direction to the next, where a design that is nearly
  /// right has large deviations at a few samples.
  TargetResiduals(const neural::Evaluator& evaluator, const std::vector<SampledTarget>& targets,
                  const std::vector<double>& target_weights, Eigen::VectorXd fixed_values,
                  std::vector<Eigen::Index> free, double equilibrium_tolerance, Buildable buildable = {},
                  double outlier_threshold = 0);

  /// From now on, values with this correction are compared with the targets.
  void correct(Correction correction) { correction_ = std::move(correction); }
  /// From now on, values are compared with the targets at the modulus that fits best. `moduli` must outlive this
  /// object.
  void choose_among(const ModulusChoice& moduli) { moduli_ = &moduli; }
  /// From now on, residuals for the limits follow those of the samples. `limits` must outlive this object.
  void add_limits(const LimitResiduals& limits) { limits_ = limits.are_needed() ? &limits : nullptr; }

  bool residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) override;
  void jacobian(Eigen::MatrixXd& jacobian) override;

  const Eigen::VectorXd& last_parameters() const { return last_; }
  /// The values of one target's samples at the last parameters, at the modulus chosen there, and without a correction.
  /// NaN where there is no equilibrium.
  Eigen::VectorXd values(std::size_t target) const;
  /// The modulus chosen at the last parameters.
  const ModulusChoice::Chosen& chosen() const { return chosen_; }
  /// The trust in each sample of a target at the last parameters.
  ProfileTrust trust(const neural::Model& model, std::size_t target, neural::Origin origin) const;
  double largest_residual() const;  ///< largest residual of the equilibria at the last parameters
  std::int64_t evaluations() const { return equilibria_.evaluations() + derivative_evaluations_; }
  std::int64_t restarts() const { return equilibria_.restarts(); }

 private:
  Eigen::VectorXd model_values(std::size_t target) const;
  /// The values at all samples with the correction, at the modulus of the model's data.
  Eigen::VectorXd corrected_values() const;

  const neural::Evaluator& evaluator_;
  const std::vector<SampledTarget>& targets_;
  std::vector<double> target_weights_;
  std::optional<Correction> correction_;
  const ModulusChoice* moduli_ = nullptr;
  const LimitResiduals* limits_ = nullptr;
  /// Penalty residuals of the limits at the last parameters.
  Eigen::Vector2d limit_residuals_ = Eigen::Vector2d::Zero();
  ModulusChoice::Chosen chosen_;            ///< modulus at the last parameters
  std::vector<std::size_t> first_samples_;  ///< index of each target's first sample
  std::vector<Sample> samples_;
  Eigen::VectorXd factors_;  ///< factor of each sample's deviation in its residual
  /// Threshold c of the Cauchy loss for each sample, in the unit of y; empty without robust deviations.
  Eigen::VectorXd outlier_thresholds_;
  /// Derivative of each robust deviation by the deviation at the last parameters; 1 without robust deviations.
  Eigen::VectorXd robust_slopes_;
  Eigen::VectorXd fixed_values_;
  std::vector<Eigen::Index> free_;
  Buildable buildable_;
  Equilibria<double> equilibria_;
  ValueDerivatives<double> derivatives_;
  Eigen::VectorXd last_;                             ///< all parameters of the last call
  std::optional<neural::Evaluator::Design> design_;  ///< design of the last call
  std::optional<Eigen::VectorXd> saved_parameters_;  ///< all parameters of the saved equilibria
  std::int64_t derivative_evaluations_ = 0;
};

}  // namespace supple::design
