#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "supple/design/measurements.h"
#include "supple/json/limits.h"

/// Measured curves that become targets; the request is read like those of requests.h and throws the same. Whether the
/// text is a table, and its units are known, is not checked here.
namespace supple::json {

struct MeasuredCurveRequest {
  design::MeasurementRequest measurements;  ///< measurements with the text of "text", or of "content" in UTF-8
  std::string encoding = "utf-8";           ///< encoding of "content"
  const char* text_field = "/text";         ///< pointer to the field that the text comes from
  design::ReductionOptions options;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
MeasuredCurveRequest parse_measured_curve(std::string_view body, const Limits& limits);

}  // namespace supple::json
