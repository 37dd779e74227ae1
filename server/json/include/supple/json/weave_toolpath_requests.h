#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/json/weave_requests.h"
#include "supple/weave/gcode_check.h"
#include "supple/weave/toolpath.h"

/// The requests about printing weaves as types; they are read like those of weave_requests.h and throw the same.
namespace supple::json {

/// What an answer about a toolpath has beside its statistics.
struct ToolpathParts {
  bool gcode = true;
  bool svg = false;
  bool moves = false;
};

struct WeaveToolpathRequest {
  WeaveSpec weave;
  weave::PrinterProfile printer;
  weave::ToolpathOptions options;
  std::vector<int> overrun_strands;  ///< strand of each entry of the request's overruns; no strand twice
  ToolpathParts include;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
WeaveToolpathRequest parse_weave_toolpath(std::string_view body, const Limits& limits,
                                          const CancellationToken& cancellation = {});

struct GcodeReportRequest {
  std::string gcode;
  weave::GcodeLimits limits;
  double deadline = 0;
};
GcodeReportRequest parse_gcode_report(std::string_view body, const Limits& limits,
                                      const CancellationToken& cancellation = {});

}  // namespace supple::json
