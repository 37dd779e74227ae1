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

/// What a tensile test measured, which turns lengths and forces into strains and stresses.
struct Specimen {
  std::optional<double> gauge_length;  ///< mm
  std::optional<double> area;          ///< of the cross-section at rest, mm^2
};

/// How a number of a unit becomes one of the profile's own unit: value * factor + offset.
struct UnitConversion {
  double factor = 1;
  double offset = 0;
};

/// Units of x: "1", "%", "permille", "microstrain" and "stretch" (length over rest length) for strains; "mm", "cm",
/// "m", "um" and "in" for displacements, which need a gauge length; "rad" and "deg" for directions. Units of y: "Pa",
/// "kPa", "MPa", "GPa", "N/mm^2", "psi", "ksi" and "bar"; "N", "mN", "kN", "lbf", "kgf" and "gf" for forces, which need
/// an area; "1" and "%" for Poisson's ratio. Other ways to write them (N/mm², °, mm/mm, KN, kpa, lbs) count as the
/// same, unless the case of a letter decides (mPa, MN). Throws "design.invalid_measurement" that lists the units, with
/// the place "units/x", "units/y", "specimen/gauge_length" or "specimen/area".
UnitConversion conversion_of_x(Task task, const std::string& unit, const Specimen& specimen);
UnitConversion conversion_of_y(Task task, const std::string& unit, const Specimen& specimen);
/// The common way to write a unit; empty where nobody knows it.
std::string known_unit(const std::string& written);

/// Measured points in the order in which they were taken, in the profile's units: strain (dimensionless) or direction
/// (rad); MPa, or dimensionless for Poisson's ratio.
struct MeasuredCurve {
  Task task = Task::stress_strain;
  std::vector<Eigen::Vector2d> points;
};

struct ReductionOptions {
  int max_control_points = 12;  ///< 2 to 64
  numerics::Interpolation interpolation = numerics::Interpolation::cubic;
  double tolerance = 0.005;  ///< relative root mean square deviation at which no control point is added
  /// Whether the curve passes through (0, 0). Automatic: where stress over strain begins within 5 % of the strains'
  /// range of zero, or passes it.
  Switch origin = Switch::automatic;
  /// Whether only first loadings count: points beyond all strains that were reached before the strain last turned back.
  /// Automatic: where the strain turns back by more than 5 % of its range.
  Switch loading = Switch::automatic;
  /// Whether what follows a break is left out: the stress falls within four points below a fifth of its greatest value
  /// and stays below half of it. On and automatic are the same.
  Switch rupture = Switch::automatic;
  std::optional<double> lower, upper;  ///< the part of x that counts
};

/// Points that did not count, by the reason.
struct SetAside {
  std::size_t no_number = 0;          ///< not finite
  std::size_t out_of_range = 0;       ///< outside of the bounds
  std::size_t not_first_loading = 0;  ///< unloadings, and strains that were reached before
  std::size_t after_rupture = 0;
  std::size_t total() const { return no_number + out_of_range + not_first_loading + after_rupture; }
};

/// A measured curve as the few control points that a target has.
struct ReducedCurve {
  std::vector<Eigen::Vector2d> control_points;  ///< x increasing; finite
  numerics::Interpolation interpolation = numerics::Interpolation::cubic;
  std::vector<Eigen::Vector2d> points;  ///< the measured points that counted, by x, those of one x averaged
  double relative_rms = 0;              ///< deviation of the curve from them over their root mean square
  double max_deviation = 0;             ///< largest, in the unit of y
  double max_at = 0;                    ///< x of it
  double noise = 0;   ///< relative root mean square of the points' scatter about their neighbours, estimated
  double offset = 0;  ///< y that was measured at x = 0 where the curve was made to pass through the origin
  SetAside set_aside;
  std::optional<double> rupture_at;  ///< the last strain before a rupture
  bool through_origin = false;
  bool first_loading = false;
};

/// Control points whose curve comes closest to the measured points in the sense of least squares. Knots are added where
/// the squared deviation is largest until the deviation is within the tolerance or one more follows nothing but the
/// points' scatter, moved to where they serve best, and left out again where they are not needed. Where there are many
/// points, averages of neighbours are fitted, 400 or 16 for each control point; deviations are those of all points.
/// Directions are taken modulo pi. The bill has the effects "origin", "loading" and "rupture". Throws
/// "design.invalid_measurement" where fewer than two points of different x remain. Some 20 ms for 500 points and 12
/// control points, seconds for 64 control points or a million points.
ReducedCurve reduce(const MeasuredCurve& curve, const ReductionOptions& options, const Execution& execution = {});

}  // namespace supple::design
