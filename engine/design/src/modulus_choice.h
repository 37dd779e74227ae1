#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/design/inverse_design.h"

namespace supple::design {

/// The Young's modulus of a design. Stresses and stiffnesses are proportional to it if the other constants of the
/// material stay the same. The modulus that fits the targets best therefore follows from the model's values, and the
/// search has no unknown for it (variable projection [Golub1973]).
///
/// Values are those of all samples of all targets, one target after the other.
class ModulusChoice {
 public:
  /// `moduli` are ranges in MPa; empty means the modulus of the model. Throws "design.invalid_modulus" if a range is
  /// empty or not positive.
  ModulusChoice(const std::vector<Range>& moduli, double model_modulus);

  struct Chosen {
    std::size_t material = 0;  ///< index into the moduli
    double modulus = 0;        ///< MPa
    double factor = 1;         ///< factor by which stresses of the model are multiplied
    /// Whether the modulus lies strictly between the limits of its range; then it changes with the values.
    bool is_inside = false;
  };
  /// The modulus for which the weighted sum of the squared deviations beyond the bands is least. It is the lowest
  /// modulus of the first range if no target depends on it. O(samples) for each of about ten steps and each range.
  Chosen best(const std::vector<SampledTarget>& targets, const std::vector<double>& target_weights,
              const Eigen::VectorXd& values) const;
  /// The derivatives of the best factor by the parameters. `derivatives` are those of the values, with one row for each
  /// sample.
  Eigen::RowVectorXd slope(const std::vector<SampledTarget>& targets, const std::vector<double>& target_weights,
                           const Eigen::VectorXd& values, const Eigen::MatrixXd& derivatives,
                           const Chosen& chosen) const;
  /// The least and the greatest factor of all ranges.
  std::pair<double, double> limits() const;
  /// The factor, if the ranges allow only one.
  std::optional<double> single() const;

 private:
  std::vector<Range> moduli_;
  double model_modulus_;
};

/// Factor of a task's values: Poisson's ratio does not depend on the modulus.
inline double factor_for(Task task, double factor) { return task == Task::poisson ? 1 : factor; }

/// The values, each multiplied by factor_for its target's task.
Eigen::VectorXd scaled(const std::vector<SampledTarget>& targets, Eigen::VectorXd values, double factor);

}  // namespace supple::design
