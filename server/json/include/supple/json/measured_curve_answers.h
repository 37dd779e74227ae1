#pragma once

#include <string>

#include "supple/design/measurements.h"
#include "supple/json/answers.h"

namespace supple::json {

/// A measured curve, reduced to control points, and its origin.
struct MeasuredCurveAnswer {
  design::Measurements measurements;  ///< the points in it are not used
  std::string encoding;               ///< encoding of the table's text
  design::Task task = design::Task::stress_strain;
  design::ReductionOptions options;
  design::ReducedCurve curve;
};

std::string write_measured_curve(const MeasuredCurveAnswer& answer, const Bill& bill);

}  // namespace supple::json
