#pragma once

#include <optional>
#include <string>

#include "supple/design/measured_curve.h"
#include "supple/design/measured_table.h"
#include "supple/json/answers.h"

namespace supple::json {

/// A measured curve that has become control points, and where it came from.
struct MeasuredCurveAnswer {
  std::optional<design::MeasuredTable> table;  ///< of a text
  std::size_t x = 0, y = 1;                    ///< columns of the table
  std::string x_unit, y_unit;                  ///< as they were understood
  design::Task task = design::Task::stress_strain;
  design::ReductionOptions options;
  design::ReducedCurve curve;
};

std::string write_measured_curve(const MeasuredCurveAnswer& answer, const Bill& bill);

}  // namespace supple::json
