#pragma once

#include <Eigen/Core>
#include <string>

#include "supple/design/inverse_design.h"

namespace supple::design {

/// Quadratic penalties for violated limits as two residuals of a search: relative density and cell size. A residual is
/// zero within the limits. Beyond them it is a large multiple of the relative excess, so that no smaller deviation from
/// the targets outweighs it. The penalized limits are narrower than the requested ones by more than the excess that
/// remains at a minimum. Designs at which a search ends therefore satisfy the requested limits.
class LimitResiduals {
 public:
  /// `space` must outlive this object.
  LimitResiduals(const DesignSpace& space, const StructureLimits& limits) : space_(space), limits_(limits) {}

  bool are_needed() const { return limits_.any(); }
  static constexpr Eigen::Index count = 2;

  /// The residuals at parameters that can be built.
  Eigen::Vector2d at(const Eigen::VectorXd& parameters) const;
  /// The derivatives of the residuals by the parameters `free`, one column for each; the orientation may be among them.
  /// `residuals` are those at `parameters`. They are finite differences: one measurement for each parameter, which
  /// takes up to some milliseconds, and none if no limit is exceeded.
  Eigen::Matrix2Xd derivatives(const Eigen::VectorXd& parameters, const std::vector<Eigen::Index>& free,
                               const Eigen::Vector2d& residuals) const;

 private:
  const DesignSpace& space_;
  StructureLimits limits_;
};

/// The violated limits at parameters that can be built, as sentences; empty if no limit is violated.
std::string excess(const DesignSpace& space, const StructureLimits& limits, const Eigen::VectorXd& parameters);

}  // namespace supple::design
