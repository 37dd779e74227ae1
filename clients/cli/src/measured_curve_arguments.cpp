#include "measured_curve_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iostream>
#include <iterator>
#include <utility>

#include "failure.h"
#include "load_arguments.h"
#include "numbers.h"
#include "profile_arguments.h"

namespace supple::cli {
namespace {

constexpr std::size_t most_control_points = 64;

std::string text_of(const std::string& file) {
  if (file != "-") return read_file(file);
  return {std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>()};
}

/// Two entries separated by a comma, either of which may be empty.
std::pair<std::string, std::string> two_of(const std::string& text, const char* option) {
  const auto comma = text.find(',');
  if (comma == std::string::npos || text.find(',', comma + 1) != std::string::npos)
    throw Failure(ExitCode::usage,
                  fmt::format("{} takes two entries separated by a comma, one for x and one for y", option));
  return {text.substr(0, comma), text.substr(comma + 1)};
}

nlohmann::json column_of(const std::string& text) {
  if (const auto index = integer_in(text)) return *index;
  return text;
}

}  // namespace

void add_measured_curve_options(CLI::App& command, MeasuredCurveArguments& arguments) {
  command.add_option("--columns", arguments.columns,
                     "Columns x,y of a measured file, by index from 0 or by name (told by the header)");
  command.add_option("--units", arguments.units,
                     "Units x,y of a measured file, for example %,kPa or mm,N (the header's)");
  command
      .add_option("--gauge-length", arguments.gauge_length, "Length at rest that was stretched in mm; of displacements")
      ->check(CLI::PositiveNumber);
  command.add_option("--area", arguments.area, "Cross-section at rest in mm^2; of forces")->check(CLI::PositiveNumber);
  command.add_option("--control-points", arguments.control_points, "Control points of a measured curve, at most (12)")
      ->check(CLI::Range(2, static_cast<int>(most_control_points)));
}

bool is_measured(const std::string& target, bool over_directions) {
  if (target == "-") return true;
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(target, ignored)) return false;
  const std::string text = read_file(target);
  if (text.find(';') != std::string::npos || text.find('\t') != std::string::npos) return true;
  bool is_file = false;
  const auto rows = parse_rows(target, is_file);
  if (rows.size() > most_control_points + 1) return true;
  // The first row may be a header.
  return std::any_of(rows.begin() + (rows.empty() ? 0 : 1), rows.end(),
                     [over_directions](const std::string& row) { return !control_point_in(row, over_directions); });
}

nlohmann::json reduce_curve(Session& session, const std::string& file, const std::string& task,
                            const MeasuredCurveArguments& arguments) {
  nlohmann::json request = {{"text", text_of(file)}};
  if (!task.empty()) request["task"] = task;
  if (!arguments.columns.empty()) {
    const auto [x, y] = two_of(arguments.columns, "--columns");
    if (!x.empty()) request["columns"]["x"] = column_of(x);
    if (!y.empty()) request["columns"]["y"] = column_of(y);
  }
  if (!arguments.units.empty()) {
    const auto [x, y] = two_of(arguments.units, "--units");
    if (!x.empty()) request["units"]["x"] = x;
    if (!y.empty()) request["units"]["y"] = y;
  }
  if (arguments.gauge_length > 0) request["specimen"]["gauge_length"] = arguments.gauge_length;
  if (arguments.area > 0) request["specimen"]["area"] = arguments.area;
  if (arguments.control_points > 0) request["accuracy"]["max_control_points"] = arguments.control_points;
  return session.compute("/v1/measured-curves", request).json();
}

std::string reduction_words(const nlohmann::json& answer) {
  const auto& error = answer.at("error");
  const auto message = answer.at("message").get<std::string>();
  return fmt::format("{} control points follow {} measured ones within {:.2g} %{}{}",
                     answer.at("target").at("control_points").size(), answer.at("point_count").get<std::size_t>(),
                     100 * error.at("relative_rms").get<double>(), message.empty() ? "" : ". ", message);
}

}  // namespace supple::cli
