#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/design/measured_curve.h"
#include "supple/design/measured_table.h"
#include "supple/json/limits.h"

/// Measured curves that become targets; the request is read like those of requests.h and throws the same. Whether the
/// text is a table, and its units are known, is not asked here.
namespace supple::json {

struct MeasuredCurveRequest {
  design::Task task = design::Task::stress_strain;
  std::optional<std::string> text;  ///< exactly one of text and points is given
  std::vector<Eigen::Vector2d> points;
  design::ColumnChoice x, y;
  std::optional<std::string> x_unit, y_unit;
  design::Specimen specimen;
  design::ReductionOptions options;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
MeasuredCurveRequest parse_measured_curve(std::string_view body, const Limits& limits);

}  // namespace supple::json
