#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "supple/design/target.h"

namespace supple::design {

/// The largest magnitude of a target's strain, in its measure, at which the bound is said. It is a bound at rest. With
/// strain a structure has another tangent under the load of each direction, which no single compliance explains. In
/// random designs of all families the profiles at a tensile strain of 0.02 are 3 % from every profile at rest in the
/// median, and those at 0.05 are 5 % (stiffness) and 12 % (Poisson's ratio); in compression, where beams buckle, those
/// of stiffness are 30 to 40 %.
inline constexpr double max_bound_strain = 0.05;

/// The compliance S of a material in two dimensions at rest, 1/MPa: strain (e_xx, e_yy, 2 e_xy) = S stress (s_xx, s_yy,
/// s_xy). It is symmetric and positive definite, and positive semidefinite in limits that no material quite attains.
using Compliance = Eigen::Matrix3d;

/// The compliance of a solid under plane strain, as that of the solid under Law::neo_hookean is at rest.
/// `youngs_modulus` in MPa.
Compliance solid_compliance(double youngs_modulus, double poisson_ratio);

/// Stiffness 1 / S11(a) in MPa or Poisson's ratio -S12(a) / S11(a) of a material over directions a in rad. S11 and S12
/// are components in axes that are turned by a counterclockwise.
Eigen::VectorXd rest_profile(const Compliance& compliance, Task task, const std::vector<double>& directions);

/// A profile that a material has at rest, at the samples of a target.
struct RestProfile {
  double deviation = 0;  ///< as SampledTarget::relative_rms
  Eigen::VectorXd y;     ///< MPa or dimensionless
};

/// The nearest that any material comes to a target at rest.
struct MaterialBound {
  RestProfile alone;  ///< profile of the material that is nearest to this target alone
  /// Profile of the material that is nearest to all bounded targets of the design. None if there is no other.
  std::optional<RestProfile> together;
};

struct MaterialBounds {
  /// One entry for each target; none for stresses, and for strains beyond `max_bound_strain`.
  std::vector<std::optional<MaterialBound>> targets;
  /// Least deviation of one material from all bounded targets, as DesignError::relative_rms. None if there are fewer
  /// than two.
  std::optional<double> together;
};

/// Whether a target has a bound: it is of stiffness or Poisson's ratio, near rest.
bool is_bounded(const SampledTarget& target);

/// The profiles of stiffness and Poisson's ratio that come nearest to targets, of all that a material can have at rest.
/// Both follow from one compliance. A structure's compliance is at least that of its solid, `min_compliance` (the
/// difference is positive semidefinite), since voids only add compliance; zero stands for a solid that is as stiff as
/// needed, with which every compliance is possible [Milton1995]. Poisson's ratios alone do not depend on the scale of
/// the stiffness, and have the same bound for every solid.
///
/// The unknowns are the six entries of L in S = min_compliance + L L^T. Newton's method minimizes the mean squared
/// deviation from up to 22 starts: the linear fit, an isotropic material, and the best of 424 random and orthotropic
/// ones. A local minimum is the deviation of a material, but need not be the least one: of 400 random targets one was
/// by 4 % of itself above the least that is known. `weights` are those of the targets, one for each. O(samples) for
/// each of some tens of iterations: 3 ms for 50 directions, and 0.1 ms for profiles that a material has.
MaterialBounds material_bounds(const std::vector<SampledTarget>& targets, const std::vector<double>& weights,
                               const Compliance& min_compliance);

}  // namespace supple::design
