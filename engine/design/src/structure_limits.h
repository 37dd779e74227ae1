#pragma once

#include <Eigen/Core>
#include <string>

#include "supple/design/inverse_design.h"

namespace supple::design {

/// The limits of what a design may be as residuals of a search, two rows: relative density and cell size. A row is
/// zero within its limits, and beyond them a multiple of the relative excess so large that nothing gained by the
/// targets outweighs it (a quadratic penalty). The limits that the rows have are narrower than those that were asked
/// for by more than what an excess remains in a minimum, so that designs that a search ends with keep what was asked
/// for.
class LimitRows {
 public:
  /// `space` outlives it.
  LimitRows(const DesignSpace& space, const StructureLimits& limits) : space_(space), limits_(limits) {}

  bool are_needed() const { return limits_.any(); }
  static constexpr Eigen::Index count = 2;

  /// The rows at parameters that can be built.
  Eigen::Vector2d at(const Eigen::VectorXd& parameters) const;
  /// Their derivatives, a column for each of the parameters `free`, which may include the orientation; `rows` are the
  /// rows there. By differences: a measurement for each parameter, which takes up to some milliseconds, and none where
  /// nothing exceeds its limit.
  Eigen::Matrix2Xd derivatives(const Eigen::VectorXd& parameters, const std::vector<Eigen::Index>& free,
                               const Eigen::Vector2d& rows) const;

 private:
  const DesignSpace& space_;
  StructureLimits limits_;
};

/// What is beyond the limits at parameters that can be built, as a sentence; empty if nothing is.
std::string excess(const DesignSpace& space, const StructureLimits& limits, const Eigen::VectorXd& parameters);

}  // namespace supple::design
