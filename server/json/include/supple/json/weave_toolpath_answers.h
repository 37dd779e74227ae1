#pragma once

#include <string>

#include "supple/json/answers.h"
#include "supple/weave/gcode_check.h"
#include "supple/weave/toolpath.h"

/// The answers about printing weaves as JSON text; they throw like those of answers.h.
namespace supple::json {

/// Parts that were not asked for are null.
struct ToolpathFiles {
  const std::string* gcode = nullptr;
  const std::string* svg = nullptr;
  bool moves = false;
};

/// `check` is what was found in the G-code, whether or not the answer has it.
std::string write_weave_toolpath(const weave::Toolpath& toolpath, const ToolpathFiles& files,
                                 const weave::GcodeReport& check, const Bill& bill);

std::string write_gcode_report(const weave::GcodeReport& report, const Bill& bill);

}  // namespace supple::json
