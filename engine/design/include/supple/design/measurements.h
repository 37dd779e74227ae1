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

/// Which way a specimen is loaded. `both` is an answer alone: the strain goes both ways.
enum class Sense : std::uint8_t { automatic, tension, compression, both };
/// What told the sense; `nothing` where tension was assumed.
enum class SenseTold : std::uint8_t { request, titles, remarks, signs, nothing };
/// Where displacements count from: zero where they begin there, the first of them, or zero in any case.
enum class ZeroChoice : std::uint8_t { automatic, first, as_written };

std::string to_string(Sense sense);
std::string to_string(SenseTold told);

/// What to know about a curve, for example what was assumed.
struct MeasurementNote {
  std::string text;   ///< a sentence
  std::string where;  ///< place of the request that says it otherwise: "sense"; empty where there is none
  bool is_warning = false;
};

/// Measurements as somebody brings them, and what is said about them besides.
struct MeasurementRequest {
  Task task = Task::stress_strain;
  std::optional<std::string> text;  ///< UTF-8; where it is missing, `points` count
  std::vector<Eigen::Vector2d> points;
  ColumnChoice x, y;
  std::optional<std::string> x_unit, y_unit;  ///< without them those of the table; of points 1 or rad, and MPa or 1
  Specimen specimen;
  TableOptions table;
  Sense sense = Sense::automatic;
  ZeroChoice zero = ZeroChoice::automatic;
};

struct Measurements {
  std::optional<MeasuredTable> table;  ///< of a text
  ChosenColumns columns;
  std::string x_unit, y_unit;  ///< as they were understood
  Sense sense = Sense::tension;
  SenseTold told_by = SenseTold::nothing;
  MeasuredCurve curve;
  std::vector<MeasurementNote> notes;
};

/// Finds columns, units, sense and zero, and converts the numbers into the profile's units: strain and MPa with
/// negative signs in compression, radians, or Poisson's ratio. Throws "design.unreadable_table", and
/// "design.invalid_measurement" with one detail for each thing that has to be said: "columns/x", "columns/y",
/// "units/x", "units/y", "specimen/gauge_length", "specimen/area", "decimal_separator", "block", "sense", "zero".
/// O(size of the text).
Measurements read_measurements(const MeasurementRequest& request, const Execution& execution = {});

}  // namespace supple::design
