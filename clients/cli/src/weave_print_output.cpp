#include "weave_print_output.h"

#include <fmt/format.h>
#include <algorithm>

#include <cstdio>
#include <string>

#include "cost_output.h"
#include "failure.h"

namespace supple::cli {
namespace {

double number(const nlohmann::json& object, const char* name) { return object.at(name).get<double>(); }

std::string heights_text(const nlohmann::json& heights) {
  constexpr std::size_t max_listed = 10;
  std::string text;
  for (std::size_t i = 0; i < heights.size() && i < max_listed; ++i)
    text += fmt::format("{}{:.6g}", i > 0 ? ", " : "", heights.at(i).get<double>());
  return heights.empty() ? "none" : text + (heights.size() > max_listed ? " ... mm" : " mm");
}

/// Prints what toolpaths and reports have in common.
void print_totals(const nlohmann::json& totals, std::size_t channels) {
  fmt::print("extruded    {:.6g} mm of strands, {:.6g} mm of filament\n", number(totals, "extruded_length"),
             number(totals, "filament"));
  fmt::print("channels    {}, {:.6g} mm\n", channels, number(totals, "channel_length"));
  fmt::print("travels     {}, {:.6g} mm\n", totals.at("travels").get<int>(), number(totals, "travel_length"));
  fmt::print("heights     {}\n", heights_text(totals.at("heights")));
  const auto& lowest = totals.at("lowest");
  const auto& highest = totals.at("highest");
  fmt::print("box         {:.6g} to {:.6g}, {:.6g} to {:.6g}, {:.6g} to {:.6g} mm\n", lowest.at(0).get<double>(),
             highest.at(0).get<double>(), lowest.at(1).get<double>(), highest.at(1).get<double>(),
             lowest.at(2).get<double>(), highest.at(2).get<double>());
  if (const auto& minutes = totals.at("minutes"); !minutes.is_null())
    fmt::print("minutes     {:.4g}\n", minutes.get<double>());
}

void print_violation_count(const nlohmann::json& report) {
  fmt::print("violations  {}\n", report.at("violation_count").get<long>());
  const auto& unchecked = report.at("unchecked");
  if (unchecked.empty()) return;
  constexpr std::size_t max_listed = 12;
  std::string commands;
  for (std::size_t k = 0; k < std::min(unchecked.size(), max_listed); ++k)
    commands += (k == 0 ? "" : ", ") + unchecked[k].at("command").get<std::string>();
  const auto count = report.at("unchecked_count").get<long>();
  fmt::print("passed on   {}: {}{}; what they do was not followed\n", count, commands,
             count > static_cast<long>(max_listed) ? ", ..." : "");
}

}  // namespace

void print_toolpath(const nlohmann::json& answer) {
  const auto& statistics = answer.at("statistics");
  fmt::print("strands     {:.6g} mm on the bed, {:.6g} mm lifted, {:.6g} mm of supports, {:.6g} mm to prime\n",
             number(statistics, "strand_length"), number(statistics, "lifted_length"),
             number(statistics, "support_length"), number(statistics, "priming_length"));
  print_totals(statistics, statistics.at("channels").get<std::size_t>());
  print_violation_count(answer.at("check"));
  print_cost(answer);
}

void print_gcode_report(const nlohmann::json& answer) {
  const auto& report = answer.at("report");
  fmt::print("lines       {}\n", report.at("lines").get<long>());
  print_totals(report, report.at("channels").size());
  fmt::print("retractions {}\n", report.at("retractions").get<int>());
  print_violation_count(report);
  print_cost(answer);
}

void fail_on_violations(const nlohmann::json& report) {
  const auto count = report.at("violation_count").get<long>();
  if (count == 0) return;
  for (const auto& violation : report.at("violations"))
    fmt::print(stderr, "line {}: {}: {}\n", violation.at("line").get<int>(), violation.at("kind").get<std::string>(),
               violation.at("message").get<std::string>());
  throw Failure(ExitCode::violations, fmt::format("the G-code has {} violation{}", count, count == 1 ? "" : "s"));
}

}  // namespace supple::cli
