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

/// Deviations that count less the larger they are: Cauchy's function c sqrt(log(1 + (d/c)^2)) of d, with its sign, and
/// its derivative. Next to c it is d.
struct Lessened {
  double value = 0;
  double slope = 1;
};
Lessened lessened(double deviation, double c);

/// What is added to a model's values to have those of something else, such as of simulations: offset + slope (x - at)
/// at the free parameters x. An entry or row for each sample of all targets, one target after the other.
struct Correction {
  Eigen::VectorXd offset;
  Eigen::MatrixXd slope;
  Eigen::VectorXd at;
};

/// The outer problem of inverse design as residuals of the parameters that are free: r = sqrt(w) deviation / scale over
/// all samples of all targets, so that |r| is the relative root mean square deviation.
class TargetResiduals : public numerics::ResidualFunction {
 public:
  /// `held` has the values of all parameters that are fixed, at their places, as in FreeParameters. Samples are of the
  /// orientation 0, which is among the parameters. Where `outlier` is positive, deviations of
  /// more than this share of the scale count less and less: where a profile jumps from one direction to the next, a
  /// design that is nearly right deviates much at a few samples.
  TargetResiduals(const neural::Evaluator& evaluator, const std::vector<SampledTarget>& targets,
                  const std::vector<double>& target_weights, Eigen::VectorXd held, std::vector<Eigen::Index> free,
                  double equilibrium_tolerance, Buildable buildable = {}, double outlier = 0);

  /// From now on it is the corrected values that are compared with the targets.
  void correct(Correction correction) { correction_ = std::move(correction); }
  /// From now on values are multiplied with the best modulus before they are compared. `moduli` outlives this.
  void choose_among(const ModulusChoice& moduli) { moduli_ = &moduli; }
  /// From now on there are rows for the limits after those of the samples. `limits` outlives this.
  void keep_within(const LimitRows& limits) { limits_ = limits.are_needed() ? &limits : nullptr; }

  bool residuals(const Eigen::VectorXd& x, Eigen::VectorXd& r) override;
  void jacobian(Eigen::MatrixXd& jacobian) override;

  const Eigen::VectorXd& last_parameters() const { return last_; }
  /// The values of one target's samples at the last parameters with the modulus chosen there, without a correction;
  /// NaN where there is no equilibrium.
  Eigen::VectorXd values(std::size_t target) const;
  /// The modulus at the last parameters.
  const ModulusChoice::Chosen& chosen() const { return chosen_; }
  /// How far each sample of a target is to be trusted, at the last parameters.
  ProfileTrust trust(const neural::Model& model, std::size_t target, neural::Origin origin) const;
  double largest_residual() const;  ///< of the equilibria at the last parameters
  std::int64_t evaluations() const { return equilibria_.evaluations() + derivative_evaluations_; }
  std::int64_t restarts() const { return equilibria_.restarts(); }

 private:
  Eigen::VectorXd model_values(std::size_t target) const;
  /// The values at all samples, with the modulus of the model.
  Eigen::VectorXd corrected_values() const;

  const neural::Evaluator& evaluator_;
  const std::vector<SampledTarget>& targets_;
  std::vector<double> target_weights_;
  std::optional<Correction> correction_;
  const ModulusChoice* moduli_ = nullptr;
  const LimitRows* limits_ = nullptr;
  Eigen::Vector2d limit_rows_ = Eigen::Vector2d::Zero();  ///< at the last parameters
  ModulusChoice::Chosen chosen_;                          ///< at the last parameters
  std::vector<std::size_t> first_;                        ///< sample of each target
  std::vector<Sample> samples_;
  Eigen::VectorXd factors_;   ///< of each sample's deviation
  Eigen::VectorXd outliers_;  ///< deviations from which on a sample counts less; empty where all count
  Eigen::VectorXd slopes_;    ///< by how much less, at the last parameters; 1 where all count
  Eigen::VectorXd held_;
  std::vector<Eigen::Index> free_;
  Buildable buildable_;
  Equilibria<double> equilibria_;
  ValueDerivatives<double> derivatives_;
  Eigen::VectorXd last_;                             ///< all parameters of the last call
  std::optional<neural::Evaluator::Design> design_;  ///< of the last call
  std::optional<Eigen::VectorXd> known_;             ///< of the states that are kept
  std::int64_t derivative_evaluations_ = 0;
};

}  // namespace supple::design
