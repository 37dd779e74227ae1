#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "supple/design/profile.h"
#include "supple/numerics/interpolant.h"

namespace supple::design {

/// One profile that is wanted: a curve through control points, sampled by the solver.
struct Target {
  Task task = Task::stress_strain;
  double direction = 0;                          ///< rad; of stress_strain
  double strain = 0.05;                          ///< of the measure; of stiffness and poisson
  StrainMeasure measure = StrainMeasure::green;  ///< of strains, and of stresses in stress_strain
  /// x: strains of the measure, or directions in rad with period pi. y: MPa, or dimensionless for poisson.
  std::vector<Eigen::Vector2d> control_points;
  numerics::Interpolation interpolation = numerics::Interpolation::cubic;
  std::vector<double> weights;  ///< of deviations, one for each control point, linear between them; none: 1
  std::vector<double> bands;    ///< deviations that count as none, likewise in the unit of y; none: 0
  int samples = 0;              ///< evenly spaced; 0: 10, and 50 over directions
  double weight = 1;            ///< of this target beside others
};

/// What the solver compares with; the vectors have an entry for each sample.
struct SampledTarget {
  ProfileSamples samples;
  Eigen::VectorXd y;
  Eigen::VectorXd weights;  ///< of sum 1
  Eigen::VectorXd bands;
  double scale = 1;  ///< weighted root mean square of y, at least least_scale of the task
  /// Deviations of a profile beyond the bands, signed, in the unit of y.
  Eigen::VectorXd deviations(const Eigen::VectorXd& profile) const;
  /// Their weighted root mean square over the scale; none where a value of the profile is missing (NaN).
  std::optional<double> relative_rms(const Eigen::VectorXd& profile) const;
  /// For each sample whether a profile is within its band, or within 1 % of the scale beyond it.
  std::vector<std::uint8_t> reached(const Eigen::VectorXd& profile) const;
};

/// What deviations are measured against at least, where a target is small: of Poisson's ratio 0.1, of stresses and
/// stiffnesses 1e-6 MPa.
double least_scale(Task task);

/// Throws "design.invalid_target": x does not increase strictly, spans a period of directions, a strain
/// is beyond strain_limits, or a list of weights or bands is not as long as the control points; each with its place as
/// the contract names it, e.g. "target/control_points/3/0".
SampledTarget sample_target(const Target& target);

/// The same target where only a few samples (at least 2) are compared; for choosing among many designs.
SampledTarget coarsened(const SampledTarget& target, int samples);

}  // namespace supple::design
