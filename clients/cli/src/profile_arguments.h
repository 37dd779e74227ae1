#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace supple::cli {

/// The options that say which profile is meant: its task, its family, and its direction or strain.
struct ProfileArguments {
  std::string task;
  std::string family;
  std::string model;
  std::string direction;  ///< an angle
  std::string strain;
  std::string strain_measure;
};

void add_profile_options(CLI::App& command, ProfileArguments& arguments);

/// The fields of a request for the options that are set. Throws Failure(usage).
nlohmann::json profile_fields(const ProfileArguments& arguments);

/// The two to four numbers of a control point "x,y,weight,band"; over directions x is an angle, which may have a unit.
/// Nothing if the text is no control point.
std::optional<std::vector<double>> control_point_in(const std::string& row, bool over_directions);

/// A target spline from control points "x,y;x,y" or from the lines of a file, whose first may be a heading. A third
/// number of a point is its weight, a fourth its band. Over directions each x is an angle, in radians or with a unit.
/// Throws Failure(usage) and Failure(local_file).
nlohmann::json parse_target(const std::string& argument, bool over_directions);

/// Whether every line of a text, perhaps after a heading, is a control point as parse_target reads it.
bool holds_control_points(const std::string& text, bool over_directions);

/// Whether the profile of a task is over directions.
bool is_over_directions(const std::string& task);

/// Fixed parameters as numbers, with null for those that are "free". Throws Failure(usage).
nlohmann::json parse_fixed(const std::string& text);

}  // namespace supple::cli
