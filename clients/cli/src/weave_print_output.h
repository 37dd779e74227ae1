#pragma once

#include <nlohmann/json.hpp>

namespace supple::cli {

/// Prints a summary of a toolpath for people.
void print_toolpath(const nlohmann::json& answer);
/// Prints a summary of a G-code check for people.
void print_gcode_report(const nlohmann::json& answer);

/// If a report has violations, prints them with their lines on standard error and throws Failure(violations).
void fail_on_violations(const nlohmann::json& report);

}  // namespace supple::cli
