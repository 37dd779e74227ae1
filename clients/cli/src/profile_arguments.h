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

/// The two to four numbers of a control point "x,y,weight,band". Strains or angles and stresses may have units. Nothing
/// if the text is no control point of a target of this task.
std::optional<std::vector<double>> control_point_in(const std::string& row, const std::string& task);

/// A target spline from control points "x,y;x,y" or from the lines of a file, whose first may be a heading. A third
/// number of a point is its weight, a fourth its band. What x and y are, and which units they may have, depends on the
/// task. Throws Failure(usage) and Failure(local_file).
nlohmann::json parse_target(const std::string& argument, const std::string& task);

/// Whether every line of a text, perhaps after a heading, is a control point as parse_target reads it.
bool holds_control_points(const std::string& text, const std::string& task);

/// Whether the profile of a task is over directions.
bool is_over_directions(const std::string& task);

/// Refuses what has no effect on a profile of this task: a direction over directions, a strain over strains. Throws
/// Failure(usage).
void refuse_idle_profile_options(const CLI::App& command, const std::string& task);

/// Fixed parameters as numbers, with null for those that are "free". Throws Failure(usage).
nlohmann::json parse_fixed(const std::string& text);

}  // namespace supple::cli
