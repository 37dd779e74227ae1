#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/model.h"

namespace supple::design {

/// The quantity of a profile. The load is uniaxial along a direction d of the material, and n is orthogonal to d. E is
/// the Green strain, S the second Piola-Kirchhoff stress, C = dS/dE. Lateral strain and shear are free.
enum class Task {
  stress_strain,  ///< d^T S d over strain in one direction, MPa [Thesis, eq. 4.9]
  /// d(d^T S d) / d(d^T E d) along the loading path, over directions, MPa. It equals 1 / (dd : C^-1 : dd), the
  /// directional stiffness of [Thesis, eq. 4.10].
  stiffness,
  poisson,  ///< -d(n^T E n) / d(d^T E d) along the loading path, over directions [Thesis, eq. 4.12]
};
std::string_view to_string(Task task);

/// The measure of strains and stresses.
enum class StrainMeasure {
  green,        ///< Green strain and second Piola-Kirchhoff stress
  engineering,  ///< stretch - 1 and first Piola-Kirchhoff stress (force over rest width)
};
std::string_view to_string(StrainMeasure measure);

/// The points at which a profile is evaluated.
struct ProfileSamples {
  Task task = Task::stress_strain;
  double direction = 0;                          ///< rad; used by stress_strain only
  double strain = 0.05;                          ///< in the measure; used by stiffness and poisson only
  StrainMeasure measure = StrainMeasure::green;  ///< measure of strains, and of the stresses of stress_strain
  std::vector<double> x;                         ///< strains in the measure, or directions in rad
  /// Angle by which the structure is turned counterclockwise, rad. Directions are fixed in space and do not turn with
  /// it.
  double orientation = 0;
};

/// The lowest and the highest strain that a sample may have in a measure. At a Green strain of -0.5 lengths vanish, and
/// that strain itself is excluded. The highest is far beyond the training data of any model.
std::pair<double, double> strain_limits(StrainMeasure measure);
/// Converts a strain in the measure into a Green strain.
double green_strain(double strain, StrainMeasure measure);

/// A profile that a network computed. The vectors have one entry for each sample.
struct Profile {
  Eigen::VectorXd y;                   ///< MPa or dimensionless; NaN where no equilibrium was found
  std::vector<std::uint8_t> in_range;  ///< whether the model is trusted, as neural::Trust::in_range
  /// Bound on the difference between the simulated value and y, in the unit of y. It holds in the fraction
  /// neural::Calibration::level of all cases. NaN outside of the ranges of training. Empty if the model has no
  /// calibration.
  Eigen::VectorXd error_bar;
  double residual = 0;  ///< largest residual of the equilibria found, as neural::uniaxial_residual
};

/// Evaluates a profile. The path to each sample is followed from rest. Throws "model.parameter_count", and
/// "model.invalid_load" for strains beyond strain_limits. This costs about 5 network evaluations with tangents for each
/// sample and each 0.1 of strain. Error bars cost one more evaluation, and 2 microseconds for each sample. Bills the
/// stage "equilibria" and the quantity "evaluations".
Profile evaluate_profile(const neural::Model& model, const neural::Evaluator& evaluator,
                         std::span<const double> parameters, const ProfileSamples& samples,
                         double equilibrium_tolerance = 1e-10, const Execution& execution = {});

/// The same profile of a structure whose Young's modulus is multiplied by `factor`. Stresses and stiffnesses are
/// proportional to it, and Poisson's ratios do not depend on it.
Profile scaled(Profile profile, Task task, double factor);

/// The value of a profile at one equilibrium, by the formulas of Task and StrainMeasure. The state has the stress
/// (S_xx, S_yy, S_xy) and the tangent, both in MPa, under a load along `direction` with the Green strain `strain`. It
/// may come from a network or from a simulation.
double profile_value(Task task, StrainMeasure measure, double direction, double strain, const Eigen::Vector3d& stress,
                     const Eigen::Matrix3d& tangent);

/// Simulates the structure with these parameters at its native scale and returns its profile, with one entry for each
/// sample. Samples that the simulation does not reach are NaN. If it throws an Error of a tiling or of a simulation,
/// the design is refused.
using SimulateProfile = std::function<Eigen::VectorXd(const Eigen::VectorXd& parameters, const ProfileSamples& samples,
                                                      const Execution& execution)>;

}  // namespace supple::design
