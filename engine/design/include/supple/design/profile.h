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

/// What a profile shows. The load is uniaxial along a direction d of the material; lateral strain and shear are free.
enum class Task {
  stress_strain,  ///< d^T S d over strain in one direction, MPa (thesis 4.9)
  /// d(d^T S d) / d(d^T E d) along the loading path, over directions, MPa: 1 / (dd : C^-1 : dd), the directional
  /// stiffness of thesis 4.10
  stiffness,
  poisson,  ///< -d(n^T E n) / d(d^T E d) along the loading path, over directions: thesis 4.12
};
std::string_view to_string(Task task);

/// What strains and stresses mean.
enum class StrainMeasure {
  green,        ///< Green strain and second Piola-Kirchhoff stress
  engineering,  ///< stretch - 1 and first Piola-Kirchhoff stress (force over rest width)
};
std::string_view to_string(StrainMeasure measure);

/// Where a profile is taken.
struct ProfileSamples {
  Task task = Task::stress_strain;
  double direction = 0;                          ///< rad; used by stress_strain only
  double strain = 0.05;                          ///< in the measure; used by stiffness and poisson only
  StrainMeasure measure = StrainMeasure::green;  ///< how strains, and stresses in stress_strain, are measured
  std::vector<double> x;                         ///< strains in the measure, or directions in rad
  /// By which the structure is turned counterclockwise, rad. Directions are those of space, in which it is turned.
  double orientation = 0;
};

/// The lowest and the highest strain that a sample may have in a measure. At the lowest a length is still above 0, and
/// the highest is far beyond what any model was trained on.
std::pair<double, double> strain_limits(StrainMeasure measure);
/// The Green strain that belongs to a strain in the measure.
double green_strain(double strain, StrainMeasure measure);

/// A profile that a network computed. The vectors have one entry for each sample.
struct Profile {
  Eigen::VectorXd y;                   ///< MPa or dimensionless; NaN where no equilibrium was found
  std::vector<std::uint8_t> in_range;  ///< as neural::Trust
  /// The simulated value differs from y by no more than this in the share neural::Calibration::level of all cases. In
  /// the unit of y; NaN where nothing is known about the error. Empty if the model has no calibration.
  Eigen::VectorXd error_bar;
  double residual = 0;  ///< largest of the equilibria found
};

/// Evaluates a profile. Each sample is followed from rest. Throws "model.parameter_count", and "model.invalid_load" for
/// strains beyond strain_limits. This costs about 5 network evaluations with tangents for each sample and each 0.1 of
/// strain. Error bars cost one more evaluation, and 2 microseconds for each sample. Bills the stage "equilibria" and
/// the quantity "evaluations".
Profile evaluate_profile(const neural::Model& model, const neural::Evaluator& evaluator,
                         std::span<const double> parameters, const ProfileSamples& samples,
                         double equilibrium_tolerance = 1e-10, const Execution& execution = {});

/// The same profile of a structure with `factor` times Young's modulus: stresses and stiffnesses are proportional to
/// it, Poisson's ratios do not depend on it.
Profile scaled(Profile profile, Task task, double factor);

/// The value of a profile at one state of equilibrium, by the formulas of Task and StrainMeasure. The state has the
/// stress (S_xx, S_yy, S_xy) and the tangent, both in MPa, under a load along `direction` whose Green strain is
/// `strain`. It may come from a network or from a simulation.
double profile_value(Task task, StrainMeasure measure, double direction, double strain, const Eigen::Vector3d& stress,
                     const Eigen::Matrix3d& tangent);

/// Simulates the structure with these parameters at its native scale and returns its profile, with one entry for each
/// sample and NaN where the simulation did not get there. If it throws an Error of a tiling or of a simulation, the
/// parameters are refused.
using SimulateProfile = std::function<Eigen::VectorXd(const Eigen::VectorXd& parameters, const ProfileSamples& samples,
                                                      const Execution& execution)>;

}  // namespace supple::design
