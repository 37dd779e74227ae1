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

/// What a profile shows, under a uniaxial load along a direction d of the material (lateral strain and shear free).
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
  double direction = 0;                          ///< rad; of stress_strain
  double strain = 0.05;                          ///< of the measure; of stiffness and poisson
  StrainMeasure measure = StrainMeasure::green;  ///< of strains, and of stresses in stress_strain
  std::vector<double> x;                         ///< strains of the measure, or directions in rad
};

/// Lowest and highest strain of a measure that a sample may have: a length above 0, and far beyond any model.
std::pair<double, double> strain_limits(StrainMeasure measure);
/// Green strain of a strain of the measure.
double green_strain(double strain, StrainMeasure measure);

/// A profile by a network, an entry for each sample.
struct Profile {
  Eigen::VectorXd y;                   ///< MPa or dimensionless; NaN where no equilibrium was found
  std::vector<std::uint8_t> in_range;  ///< as neural::Trust
  /// Which the simulated value differs from y by no more, with the share neural::Calibration::level; in the unit of y,
  /// NaN where nobody can say. Empty where the model has no calibration.
  Eigen::VectorXd error_bar;
  double residual = 0;  ///< largest of the equilibria found
};

/// Evaluates a profile; each sample from rest. Throws "model.parameter_count", "model.invalid_load" for strains beyond
/// strain_limits. About 5 network evaluations with tangents for each sample and 0.1 of strain; error bars cost
/// one more and 2 microseconds a sample. Bills the stage
/// "equilibria" and the quantity "evaluations".
Profile evaluate_profile(const neural::Model& model, const neural::Evaluator& evaluator,
                         std::span<const double> parameters, const ProfileSamples& samples,
                         double equilibrium_tolerance = 1e-10, const Execution& execution = {});

/// The value of a profile at one state of equilibrium with its stress (S_xx, S_yy, S_xy) and tangent, both MPa, under a
/// load along `direction` whose Green strain is `strain`; the formulas of Task and StrainMeasure. Also for states of
/// simulations.
double profile_value(Task task, StrainMeasure measure, double direction, double strain, const Eigen::Vector3d& stress,
                     const Eigen::Matrix3d& tangent);

/// A profile of the structure with these parameters at its native scale, an entry for each sample, NaN where the
/// simulation did not get there. An Error of a tiling or a simulation refuses the parameters.
using SimulateProfile = std::function<Eigen::VectorXd(const Eigen::VectorXd& parameters, const ProfileSamples& samples,
                                                      const Execution& execution)>;

}  // namespace supple::design
