#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/measured_curve.h"
#include "supple/design/measured_table.h"

namespace supple::design {

/// Direction of the load on a specimen. `both` occurs only in answers: the strain is positive and negative.
enum class Sense : std::uint8_t { automatic, tension, compression, both };
/// Where the sense was taken from. `nothing` means that tension was assumed.
enum class SenseSource : std::uint8_t { request, titles, remarks, signs, nothing };
/// Origin of displacements. `first` subtracts the first displacement, and `as_written` subtracts nothing. `automatic`
/// subtracts nothing either, and asks if the first displacement is not near 0.
enum class ZeroChoice : std::uint8_t { automatic, first, as_written };

std::string to_string(Sense sense);
std::string to_string(SenseSource source);

/// A remark about how measurements were read, for example what was assumed.
struct MeasurementNote {
  std::string text;   ///< a sentence
  std::string where;  ///< field of the request that would change it, e.g. "sense"; empty if there is none
  bool is_warning = false;
};

/// Measurements as text or as points, and what the caller knows about them.
struct MeasurementRequest {
  Task task = Task::stress_strain;
  std::optional<std::string> text;  ///< UTF-8; without it `points` are read
  std::vector<Eigen::Vector2d> points;
  ColumnChoice x, y;
  /// Without them the units of the table, or for points "1" or "rad" (x) and "MPa" or "1" (y).
  std::optional<std::string> x_unit, y_unit;
  Specimen specimen;
  TableOptions table;
  Sense sense = Sense::automatic;
  ZeroChoice zero = ZeroChoice::automatic;
};

struct Measurements {
  std::optional<MeasuredTable> table;  ///< the table that was read from `text`
  ChosenColumns columns;
  std::string x_unit, y_unit;  ///< canonical_unit of the units that were used
  Sense sense = Sense::tension;
  SenseSource told_by = SenseSource::nothing;
  MeasuredCurve curve;
  std::vector<MeasurementNote> notes;
};

/// Finds columns, units, sense and zero, and converts the numbers into the profile's units: strain and MPa, both
/// negative in compression; radians; or Poisson's ratio. Throws "design.unreadable_table", and
/// "design.invalid_measurement" with one detail for each field that the caller has to give: "columns/x", "columns/y",
/// "units/x", "units/y", "specimen/gauge_length", "specimen/area", "decimal_separator", "block", "sense", "zero".
/// O(size of the text).
Measurements read_measurements(const MeasurementRequest& request, const Execution& execution = {});

}  // namespace supple::design
