#pragma once

#include <nlohmann/json.hpp>

namespace supple::cli {

/// What a toolpath amounts to, for people.
void print_toolpath(const nlohmann::json& answer);
/// What a checker found in a file, for people.
void print_gcode_report(const nlohmann::json& answer);

/// Lists a report's violations with their lines on standard error and throws Failure(violations) where there are any.
void fail_on_violations(const nlohmann::json& report);

}  // namespace supple::cli
