#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/design/inverse_design.h"

namespace supple::design {

/// Which of a family's parameters a problem leaves free, and within which bounds.
struct FreeParameters {
  /// Throws "design.parameter_count" and "design.parameter_out_of_bounds".
  FreeParameters(const DesignSpace& space, const DesignProblem& problem);

  /// The free ones of all.
  Eigen::VectorXd free_part(const Eigen::VectorXd& all) const;

  Eigen::VectorXd lower;           ///< of all parameters; equal to `upper` where they are held
  Eigen::VectorXd upper;           ///< of all
  Eigen::VectorXd held;            ///< of all; where they are free the middle of the bounds
  std::vector<Eigen::Index> free;  ///< ascending
};

/// All parameters: the held ones, with `part` in the places `free`.
Eigen::VectorXd all_parameters(Eigen::VectorXd held, const std::vector<Eigen::Index>& free,
                               const Eigen::VectorXd& part);

}  // namespace supple::design
