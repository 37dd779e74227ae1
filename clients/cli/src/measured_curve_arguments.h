#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "session.h"

namespace supple::cli {

/// How a file of measurements is to be read, and how closely it is to be followed.
struct MeasuredCurveArguments {
  std::string columns;  ///< "0,2", or names
  std::string units;    ///< "%,kPa"
  double gauge_length = 0;
  double area = 0;
  int control_points = 0;

  bool any() const { return !columns.empty() || !units.empty() || gauge_length > 0 || area > 0 || control_points > 0; }
};

void add_measured_curve_options(CLI::App& command, MeasuredCurveArguments& arguments);

/// Whether the argument of --target is a file of measurements rather than of control points: standard input (-), more
/// rows than a target may have, or rows that are no control points (whose x may be angles with a unit over directions).
bool is_measured(const std::string& target, bool over_directions);

/// The answer of the server to the measurements of a file, or of standard input where it is "-". Throws Failure.
nlohmann::json reduce_curve(Session& session, const std::string& file, const std::string& task,
                            const MeasuredCurveArguments& arguments);

/// What the reduction did, in a sentence.
std::string reduction_words(const nlohmann::json& answer);

}  // namespace supple::cli
