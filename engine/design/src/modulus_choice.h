#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/design/inverse_design.h"

namespace supple::design {

/// The Young's modulus of a design. Stresses and stiffnesses are proportional to it as long as the rest of the
/// material's law stays the same, so that the modulus that serves the targets best follows from the model's values:
/// the search has no unknown for it (variable projection, Golub and Pereyra 1973).
///
/// Values are in this order: all samples of all targets, one target after the other.
class ModulusChoice {
 public:
  /// Moduli in MPa, or none for that of the model. Throws "design.invalid_modulus" if a range is empty or not positive.
  ModulusChoice(const std::vector<Range>& moduli, double of_model);

  struct Chosen {
    std::size_t material = 0;  ///< index into the moduli
    double modulus = 0;        ///< MPa
    double factor = 1;         ///< by which stresses of the model are multiplied
    bool is_inside = false;    ///< strictly between the limits of its range, where it follows the values
  };
  /// The modulus for which the weighted squares of the deviations beyond the bands are least. It is the least modulus
  /// if no target depends on it. O(samples) for each of about ten steps and each range.
  Chosen best(const std::vector<SampledTarget>& targets, const std::vector<double>& target_weights,
              const Eigen::VectorXd& values) const;
  /// The derivatives of the best factor by the parameters, of which `derivatives` are those of the values (a row for
  /// each sample).
  Eigen::RowVectorXd slope(const std::vector<SampledTarget>& targets, const std::vector<double>& target_weights,
                           const Eigen::VectorXd& values, const Eigen::MatrixXd& derivatives,
                           const Chosen& chosen) const;
  /// The least and the greatest of all factors.
  std::pair<double, double> limits() const;
  /// The only factor there is, or none.
  std::optional<double> single() const;

 private:
  std::vector<Range> moduli_;
  double of_model_;
};

/// What the values of a task are multiplied with: Poisson's ratio does not depend on the modulus.
inline double factor_for(Task task, double factor) { return task == Task::poisson ? 1 : factor; }

/// Multiplies the values of all samples by the factor of their targets' tasks.
Eigen::VectorXd scaled(const std::vector<SampledTarget>& targets, Eigen::VectorXd values, double factor);

}  // namespace supple::design
