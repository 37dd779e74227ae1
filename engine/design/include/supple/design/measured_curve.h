#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/effect_switch.h"
#include "supple/base/execution.h"
#include "supple/design/profile.h"
#include "supple/numerics/interpolant.h"

namespace supple::design {

/// Dimensions of a test specimen, with which displacements and forces become strains and stresses.
struct Specimen {
  std::optional<double> gauge_length;  ///< mm
  std::optional<double> area;          ///< area of the undeformed cross-section, mm^2
};

/// Conversion of a number into the profile's own unit: value * factor + offset.
struct UnitConversion {
  double factor = 1;
  double offset = 0;
};

/// Convert numbers of a unit into strain or rad (x) and into MPa or a dimensionless number (y).
///
/// Units of x: "1", "%", "permille", "microstrain" and "stretch" (length / rest length) for strains; "mm", "cm", "m",
/// "um" and "in" for displacements, which need a gauge length; "rad" and "deg" for directions. Units of y: "Pa", "kPa",
/// "MPa", "GPa", "N/mm^2", "N/cm^2", "N/m^2", "kgf/cm^2", "psi", "ksi" and "bar" for stresses; "N", "mN", "kN", "lbf",
/// "kgf" and "gf" for forces, which need an area; "1" and "%" for Poisson's ratio. Other spellings (N/mm², °, mm/mm,
/// KN, kpa, lbs) count as the same unit, unless the case of a letter decides (mPa, MN). Throws
/// "design.invalid_measurement" that lists the units, with the place "units/x", "units/y", "specimen/gauge_length" or
/// "specimen/area".
UnitConversion conversion_of_x(Task task, const std::string& unit, const Specimen& specimen);
UnitConversion conversion_of_y(Task task, const std::string& unit, const Specimen& specimen);
/// The name that the functions above use for a unit; empty if the unit is unknown.
std::string canonical_unit(const std::string& written);

/// Measured points in the order in which they were taken, in the profile's units: strain (dimensionless) or direction
/// (rad); MPa, or dimensionless for Poisson's ratio.
struct MeasuredCurve {
  Task task = Task::stress_strain;
  std::vector<Eigen::Vector2d> points;
};

struct ReductionOptions {
  int max_control_points = 12;  ///< 2 to 64
  numerics::Interpolation interpolation = numerics::Interpolation::cubic;
  double tolerance = 0.005;  ///< relative root mean square deviation below which no control point is added
  /// Whether the curve passes through (0, 0). Automatic: if the task is stress over strain, and the interval of the
  /// strains contains 0 or is at most 5 % of its length away from 0.
  Switch origin = Switch::automatic;
  /// Whether only first loadings count: points whose strain exceeds all strains before the last reversal. Automatic: if
  /// the strain reverses by more than 5 % of its range.
  Switch loading = Switch::automatic;
  /// Whether points after a rupture are left out. At a rupture the stress falls within four points below a fifth of its
  /// maximum, and it stays below half of the maximum. On and automatic are the same.
  Switch rupture = Switch::automatic;
  std::optional<double> lower, upper;  ///< limits of x, in the profile's unit; points beyond them do not count
};

/// Numbers of points that do not count, by reason.
struct SetAside {
  std::size_t no_number = 0;          ///< not finite
  std::size_t out_of_range = 0;       ///< beyond ReductionOptions::lower or upper
  std::size_t not_first_loading = 0;  ///< unloading, or a strain that an earlier loading has reached
  std::size_t after_rupture = 0;
  std::size_t total() const { return no_number + out_of_range + not_first_loading + after_rupture; }
};

/// A measured curve, reduced to the few control points of a target.
struct ReducedCurve {
  std::vector<Eigen::Vector2d> control_points;  ///< x increases; all are finite
  numerics::Interpolation interpolation = numerics::Interpolation::cubic;
  std::vector<Eigen::Vector2d> points;  ///< the points that count, ordered by x; points of equal x are averaged
  /// Root mean square deviation of the curve from `points`, divided by the root mean square of their y.
  double relative_rms = 0;
  double max_deviation = 0;  ///< largest deviation, in the unit of y
  double max_at = 0;         ///< x of the largest deviation
  /// Estimated standard deviation of the points' noise, divided by the root mean square of their y.
  double noise = 0;
  double offset = 0;  ///< measured y at x = 0 if the curve passes through the origin instead, and 0 otherwise
  SetAside set_aside;
  std::optional<double> rupture_at;  ///< last strain before a rupture
  bool through_origin = false;
  bool first_loading = false;
};

/// Fits a curve through few control points to the measured points by least squares. Knots are added in the interval
/// with the largest sum of squared deviations. This ends when the deviation is within the tolerance, or when one more
/// knot would only fit noise. Then knots are moved to better positions, and those that are not needed are removed. If
/// there are many points, averages of neighbours are fitted: 400, or 16 for each control point if that is more. The
/// reported deviations are those of all points. Directions are taken modulo pi. Bills the effects "origin", "loading"
/// and "rupture". Throws "design.invalid_measurement" if fewer than two points of different x remain. Takes some 20 ms
/// for 500 points and 12 control points, and seconds for 64 control points or a million points.
ReducedCurve reduce(const MeasuredCurve& curve, const ReductionOptions& options, const Execution& execution = {});

}  // namespace supple::design
