#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/design/inverse_design.h"

namespace supple::design {

/// What a problem leaves free, and within which bounds. "All" are the family's parameters, and after them the
/// orientation of the tiling in rad.
struct FreeParameters {
  /// Throws "design.parameter_count" and "design.parameter_out_of_bounds".
  FreeParameters(const DesignSpace& space, const DesignProblem& problem);

  /// The free ones of all.
  Eigen::VectorXd free_part(const Eigen::VectorXd& all) const;
  /// Whether the orientation is free, which is then the last of the free ones.
  bool orientation_is_free() const { return lower[lower.size() - 1] < upper[upper.size() - 1]; }
  /// The places of the family's parameters that are free.
  std::vector<Eigen::Index> free_of_family() const;
  /// The parameters with an orientation.
  static Eigen::VectorXd all_of(const Eigen::VectorXd& parameters, double orientation);

  Eigen::VectorXd lower;           ///< of all parameters; equal to `upper` where they are held
  Eigen::VectorXd upper;           ///< of all
  Eigen::VectorXd held;            ///< of all; where they are free the middle of the bounds
  std::vector<Eigen::Index> free;  ///< ascending
};

/// The family's parameters among all, and the orientation.
inline auto family_part(const Eigen::VectorXd& all) { return all.head(all.size() - 1); }
inline double orientation_in(const Eigen::VectorXd& all) { return all[all.size() - 1]; }

/// All parameters: the held ones, with `part` in the places `free`.
Eigen::VectorXd all_parameters(Eigen::VectorXd held, const std::vector<Eigen::Index>& free,
                               const Eigen::VectorXd& part);

}  // namespace supple::design
