#include "profile_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <sstream>
#include <string_view>
#include <vector>

#include "angles.h"
#include "failure.h"
#include "idle_options.h"
#include "load_arguments.h"
#include "numbers.h"
#include "units.h"

namespace supple::cli {
namespace {

// Columns of a control point: x, y, weight, band.
constexpr std::size_t min_columns = 2;
constexpr std::size_t max_columns = 4;

/// Whether a row begins with a word. A row that begins with a number is a control point, or a fault to be reported.
bool is_heading(const std::string& row) { return !is_quantity(std::string_view(row).substr(0, row.find(','))); }

}  // namespace

std::optional<std::vector<double>> control_point_in(const std::string& row, const std::string& task) {
  const Dimension x = is_over_directions(task) ? Dimension::angle : Dimension::ratio;
  const Dimension y = task == "poisson" ? Dimension::ratio : Dimension::stress;
  auto numbers = quantities_in(row, {x, y, Dimension::ratio, y});
  if (!numbers || numbers->size() < min_columns || numbers->size() > max_columns) return std::nullopt;
  return numbers;
}

void add_profile_options(CLI::App& command, ProfileArguments& arguments) {
  command.add_option("--task", arguments.task, "stress_strain, or over directions stiffness or poisson")
      ->check(CLI::IsMember({"stress_strain", "stiffness", "poisson"}));
  auto* const family = command.add_option("-f,--family", arguments.family, "Family of the tiling, see supple models");
  command.add_option("-m,--model", arguments.model, "Or one of the models, see supple models")->excludes(family);
  command.add_option("-d,--direction", arguments.direction,
                     "Direction of the load, for example 45deg (0); of stress_strain");
  command
      .add_option("-s,--strain", arguments.strain,
                  "Strain along the load, for example 5% (0.05); of stiffness and poisson")
      ->transform(quantity(Dimension::ratio));
  command
      .add_option("--strain-measure", arguments.strain_measure,
                  "green: Green strain and second Piola-Kirchhoff stress (the default); engineering: stretch - 1 and "
                  "force over rest width")
      ->check(CLI::IsMember({"green", "engineering"}));
}

nlohmann::json profile_fields(const ProfileArguments& arguments) {
  nlohmann::json fields = nlohmann::json::object();
  const auto set_text = [&](const char* name, const std::string& value) {
    if (!value.empty()) fields[name] = value;
  };
  set_text("task", arguments.task);
  set_text("family", arguments.family);
  set_text("model", arguments.model);
  set_text("strain_measure", arguments.strain_measure);
  if (!arguments.direction.empty()) fields["direction"] = parse_angle(arguments.direction, "--direction");
  if (!arguments.strain.empty()) fields["strain"] = parse_number(arguments.strain, "strain");
  return fields;
}

bool is_over_directions(const std::string& task) { return task == "stiffness" || task == "poisson"; }

void refuse_idle_profile_options(const CLI::App& command, const std::string& task) {
  refuse_idle_options(command,
                      {{"--direction", !is_over_directions(task), "over directions: the load has each of them"},
                       {"--strain", is_over_directions(task), "over strains"}});
}

nlohmann::json parse_target(const std::string& argument, const std::string& task) {
  bool is_file = false;
  const auto rows = parse_rows(argument, is_file);
  std::vector<std::vector<double>> points;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    auto numbers = control_point_in(rows[i], task);
    if (!numbers && is_file && i == 0 && is_heading(rows[i])) continue;
    if (!numbers) {
      throw Failure(is_file ? ExitCode::local_file : ExitCode::usage,
                    fmt::format("'{}' is no control point: write x,y for each, perhaps x,y,weight or x,y,weight,band; "
                                "one in a line or separated by ;",
                                rows[i]));
    }
    if (!points.empty() && numbers->size() != points.front().size())
      throw Failure(is_file ? ExitCode::local_file : ExitCode::usage,
                    fmt::format("'{}' has not as many numbers as the control points before it", rows[i]));
    points.push_back(*std::move(numbers));
  }
  nlohmann::json target = {{"control_points", nlohmann::json::array()}};
  for (const auto& point : points) {
    target["control_points"].push_back({point[0], point[1]});
    if (point.size() > 2) target["weights"].push_back(point[2]);
    if (point.size() > 3) target["bands"].push_back(point[3]);
  }
  return target;
}

bool holds_control_points(const std::string& text, const std::string& task) {
  const auto rows = rows_in(text);
  const auto first = rows.begin() + (!rows.empty() && is_heading(rows.front()) ? 1 : 0);
  return first != rows.end() &&
         std::all_of(first, rows.end(), [&](const std::string& row) { return control_point_in(row, task); });
}

nlohmann::json parse_fixed(const std::string& text) {
  auto fixed = nlohmann::json::array();
  std::istringstream parts(text);
  for (std::string part; std::getline(parts, part, ',');) {
    const auto value = numbers_in(part);
    if (part == "free") {
      fixed.push_back(nullptr);
    } else if (value) {
      fixed.push_back(value->front());
    } else {
      throw Failure(ExitCode::usage,
                    fmt::format("'{}' holds no parameters: write numbers and free, for example 0.15,free", text));
    }
  }
  return fixed;
}

}  // namespace supple::cli
