#pragma once

#include <Eigen/Core>
#include <complex>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "supple/design/material_bound.h"
#include "supple/design/profile.h"

namespace supple::design {

/// What a compliance is apart from its size and its orientation: the tensor's invariant parts under rotation
/// [Verchery1982], of which the norm is 1.
class RestShape {
 public:
  explicit RestShape(const Compliance& compliance);

  /// Norm of the difference from another compliance of norm 1, which is turned so that the difference is least. It is 0
  /// for two materials that differ by a rotation and a factor, and at most 2. Mirror images count as different.
  double distance(const RestShape& other) const;
  /// A lower bound of this distance, which takes no search for the angle.
  double min_distance(const RestShape& other) const;

 private:
  Eigen::Vector2d isotropic_;      ///< does not change when the material turns
  std::complex<double> twofold_;   ///< turns by twice the angle
  std::complex<double> fourfold_;  ///< turns by four times the angle
};

/// A profile that a person may ask for: a stiffness over direction, of any size, or a Poisson's ratio over direction.
/// Some material has it at rest.
struct ReferenceProfile {
  std::string_view name;  ///< such as "poisson_-0.5"
  Task task = Task::stiffness;
  Eigen::VectorXd y;  ///< at `reference_directions()`; a stiffness has the root mean square 1
};

/// Evenly spaced directions in half a turn, rad.
const std::vector<double>& reference_directions();

/// Isotropic Poisson's ratios from -0.9 to 0.8, and stiffnesses that are isotropic, elliptic, cubic, or high in one
/// direction.
const std::vector<ReferenceProfile>& reference_profiles();

/// Deviation up to which a profile counts as met, relative to the target, and that of Poisson's ratio near 0.
inline constexpr double met_deviation = 0.02;

/// How near a material comes to a reference profile if it may be turned, and if the modulus of its solid is free.
struct ProfileDistance {
  double deviation = 0;    ///< root mean square over directions, relative to the profile's, or to 0.1 if that is larger
  double orientation = 0;  ///< angle by which the material is turned counterclockwise, rad, from 0 to pi
  bool is_met = false;     ///< the deviation is at most 0.02, or that of Poisson's ratio at most 0.02 in itself
};

/// The distance of a compliance from a reference profile, with the best orientation. Searches all angles in steps of
/// 2.5 degrees, then the two best ones finely: about 0.2 ms. A deviation that is surely above `limit` is only that of
/// the best step: 0.02 ms.
ProfileDistance distance(const Compliance& compliance, const ReferenceProfile& reference,
                         double limit = std::numeric_limits<double>::infinity());

/// The lowest and the highest value of a profile at rest over all directions.
struct ProfileRange {
  double lowest = 0;
  double highest = 0;
};
ProfileRange range_over_directions(const Compliance& compliance, Task task);

}  // namespace supple::design
