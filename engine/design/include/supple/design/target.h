#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "supple/design/profile.h"
#include "supple/numerics/interpolant.h"

namespace supple::design {

/// The largest magnitude of a control point's coordinates.
inline constexpr double largest_coordinate = 1e6;
/// How far one x has to be beyond the one before it, as a share of the range of all.
inline constexpr double min_share_of_range = 1e-9;

/// One profile that is wanted: a curve through control points, sampled by the solver.
struct Target {
  Task task = Task::stress_strain;
  double direction = 0;                          ///< rad; used by stress_strain only
  double strain = 0.05;                          ///< in the measure; used by stiffness and poisson only
  StrainMeasure measure = StrainMeasure::green;  ///< how strains, and stresses in stress_strain, are measured
  /// x: strains of the measure, or directions in rad with period pi. y: MPa, or dimensionless for poisson.
  std::vector<Eigen::Vector2d> control_points;
  numerics::Interpolation interpolation = numerics::Interpolation::cubic;
  std::vector<double> weights;  ///< one for each control point, linear between them; an empty list means 1
  std::vector<double> bands;    ///< tolerated deviations in the unit of y, likewise; an empty list means 0
  int samples = 0;              ///< evenly spaced; 0 means 10, or 50 over directions
  double weight = 1;            ///< how much this target counts beside others
};

/// What the solver compares a profile with. The vectors have one entry for each sample.
struct SampledTarget {
  ProfileSamples samples;
  Eigen::VectorXd y;
  Eigen::VectorXd weights;  ///< their sum is 1
  Eigen::VectorXd bands;
  double scale = 1;  ///< weighted root mean square of y, at least least_scale of the task
  /// Deviations of a profile beyond the bands, signed, in the unit of y.
  Eigen::VectorXd deviations(const Eigen::VectorXd& profile) const;
  /// Their weighted root mean square over the scale; none where a value of the profile is missing (NaN).
  std::optional<double> relative_rms(const Eigen::VectorXd& profile) const;
  /// For each sample whether a profile is within its band, or within 1 % of the scale beyond it.
  std::vector<std::uint8_t> reached(const Eigen::VectorXd& profile) const;
};

/// The least scale by which deviations are divided if a target is small: 0.1 for Poisson's ratio, 1e-6 MPa for stresses
/// and stiffnesses.
double least_scale(Task task);

/// Samples the curve through the control points. Throws "design.invalid_target" if a coordinate is beyond
/// `largest_coordinate`, if x does not increase by `min_share_of_range` or spans a period of directions, if a strain
/// is beyond strain_limits, or if a list of weights or bands is not as long as the list of control points. Each detail
/// names the place as the contract does, e.g. "target/control_points/3/0".
SampledTarget sample_target(const Target& target);

/// The same target, compared at only a few samples (at least 2). It serves to choose among many designs.
SampledTarget coarsened(const SampledTarget& target, int samples);

}  // namespace supple::design
