#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/design/inverse_design.h"

namespace supple::design {

/// The free and the fixed parameters of a problem, and their bounds. "All parameters" are those of the family, followed
/// by the orientation of the tiling in rad.
struct FreeParameters {
  /// Throws "design.parameter_count" and "design.parameter_out_of_bounds".
  FreeParameters(const DesignSpace& space, const DesignProblem& problem);

  /// The values of the free parameters among `all`.
  Eigen::VectorXd free_part(const Eigen::VectorXd& all) const;
  /// Whether the orientation is free. It is then the last of the free parameters.
  bool orientation_is_free() const { return lower[lower.size() - 1] < upper[upper.size() - 1]; }
  /// The indices of the family's free parameters.
  std::vector<Eigen::Index> free_of_family() const;
  /// The family's parameters, followed by an orientation.
  static Eigen::VectorXd all_of(const Eigen::VectorXd& parameters, double orientation);

  Eigen::VectorXd lower;           ///< lower bounds of all parameters; equal to `upper` for a fixed parameter
  Eigen::VectorXd upper;           ///< upper bounds of all parameters
  Eigen::VectorXd fixed_values;    ///< values of all parameters; for a free parameter the middle of its bounds
  std::vector<Eigen::Index> free;  ///< indices of the free parameters among all, ascending
};

/// The family's parameters in a vector of all parameters, and the orientation.
inline auto family_part(const Eigen::VectorXd& all) { return all.head(all.size() - 1); }
inline double orientation_in(const Eigen::VectorXd& all) { return all[all.size() - 1]; }

/// All parameters: those at the indices `free` have the values `part`, and the others the fixed values.
Eigen::VectorXd all_parameters(Eigen::VectorXd fixed_values, const std::vector<Eigen::Index>& free,
                               const Eigen::VectorXd& part);

}  // namespace supple::design
