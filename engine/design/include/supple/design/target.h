#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <vector>

#include "supple/design/profile.h"
#include "supple/numerics/interpolant.h"

namespace supple::design {

/// The largest magnitude of a control point's coordinates, in the units of Target.
inline constexpr double largest_coordinate = 1e6;
/// Minimum distance of two neighbouring x, as a fraction of the range of all x.
inline constexpr double min_fraction_of_range = 1e-9;
/// A sample counts as reached if its deviation beyond the band is at most this fraction of the target's scale.
inline constexpr double reached_fraction = 0.01;
/// A sample of Poisson's ratio counts as reached up to this deviation, too: near 0 relative deviations say nothing.
inline constexpr double reached_poisson_deviation = 0.02;

/// One target profile: a curve through control points, at which the solver takes samples.
struct Target {
  Task task = Task::stress_strain;
  double direction = 0;                          ///< rad; used by stress_strain only
  double strain = 0.05;                          ///< in the measure; used by stiffness and poisson only
  StrainMeasure measure = StrainMeasure::green;  ///< measure of strains, and of the stresses of stress_strain
  /// x: strains of the measure, or directions in rad with period pi. y: MPa, or dimensionless for poisson.
  std::vector<Eigen::Vector2d> control_points;
  numerics::Interpolation interpolation = numerics::Interpolation::cubic;
  std::vector<double> weights;  ///< one for each control point, linear between them; empty means 1
  /// Tolerated deviations at the control points in the unit of y, linear between them; empty means 0.
  std::vector<double> bands;
  int samples = 0;    ///< number of evenly spaced samples; 0 means 10 over strain and 50 over directions
  double weight = 1;  ///< weight of this target among several
};

/// A target at its samples. The vectors have one entry for each sample.
struct SampledTarget {
  ProfileSamples samples;
  Eigen::VectorXd y;
  Eigen::VectorXd weights;  ///< their sum is 1; a sample without weight says nothing about a profile
  Eigen::VectorXd bands;
  double scale = 1;  ///< weighted root mean square of y, or min_scale of the task if that is larger
  /// Signed deviations of a profile beyond the bands, in the unit of y; 0 within a band.
  Eigen::VectorXd deviations(const Eigen::VectorXd& profile) const;
  /// Weighted root mean square of these deviations, divided by the scale. None if a value of the profile is missing
  /// (NaN) at a sample that has weight.
  std::optional<double> relative_rms(const Eigen::VectorXd& profile) const;
  /// Largest deviation beyond the band of a sample that counts as reached, in the unit of y: 1 % of the scale, and for
  /// Poisson's ratios at least 0.02.
  double tolerance() const;
  /// Whether each value of a profile is within its band, or within the tolerance beyond it.
  std::vector<std::uint8_t> reached(const Eigen::VectorXd& profile) const;
  /// Whether the profile is so at each sample that has weight.
  bool is_reached(const Eigen::VectorXd& profile) const;
  bool has_weight(std::size_t sample) const { return weights[static_cast<Eigen::Index>(sample)] > 0; }
  /// The index of the largest deviation among the samples that have weight.
  Eigen::Index worst_sample(const Eigen::VectorXd& profile) const;
};

/// The minimum of SampledTarget::scale: 0.1 for Poisson's ratio, 1e-6 MPa for stresses and stiffnesses.
double min_scale(Task task);

/// Samples the curve through the control points. Throws "design.invalid_target" if a coordinate exceeds
/// `largest_coordinate`, if x does not increase by `min_fraction_of_range`, if directions span half a turn or more, if
/// a strain is beyond strain_limits, or if a list of weights or bands is not as long as the list of control points.
/// Each detail names the place as the contract does, e.g. "target/control_points/3/0".
SampledTarget sample_target(const Target& target);

/// The same target at only a few of its samples (at least 2), for the comparison of many designs.
SampledTarget coarsened(const SampledTarget& target, int samples);

}  // namespace supple::design
