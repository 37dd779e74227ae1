#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace supple::cli {

/// The options that say which profile is meant: what it shows, of which family, and where it is taken.
struct ProfileArguments {
  std::string task;
  std::string family;
  std::string model;
  std::string direction;  ///< an angle
  std::string strain;
  std::string strain_measure;
};

void add_profile_options(CLI::App& command, ProfileArguments& arguments);

/// The fields of a request that have been given. Throws Failure(usage).
nlohmann::json profile_fields(const ProfileArguments& arguments);

/// The two to four numbers of a control point "x,y,weight,band"; over directions the first is an angle, which may have
/// a unit. Nothing where the text is none.
std::optional<std::vector<double>> control_point_in(const std::string& row, bool over_directions);

/// A target spline from control points "x,y;x,y" or the lines of a file, whose first may be a heading. A third number
/// for each is its weight, a fourth its band. Where the task is over directions each x is an angle, in radians or with
/// a unit. Throws Failure(usage), Failure(local_file).
nlohmann::json parse_target(const std::string& argument, bool over_directions);

/// Whether every line of a text is a control point as parse_target reads it, below a heading or not.
bool holds_control_points(const std::string& text, bool over_directions);

/// Whether the x of a task's profile are directions.
bool is_over_directions(const std::string& task);

/// Parameters of which some are "free": numbers and nulls. Throws Failure(usage).
nlohmann::json parse_fixed(const std::string& text);

}  // namespace supple::cli
