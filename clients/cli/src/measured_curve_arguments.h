#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <string>

#include "session.h"

namespace supple::cli {

/// The options that say how a file of measurements is read, and with how many control points it is approximated.
struct MeasuredCurveArguments {
  std::string columns;  ///< "0,2", or names
  std::string units;    ///< "%,kPa"
  double gauge_length = 0;
  double area = 0;
  int control_points = 0;
  std::string sense;
  std::string decimal_separator;
  std::string zero;
  int block = -1;
  std::string origin, loading, rupture;
};

void add_measured_curve_options(CLI::App& command, MeasuredCurveArguments& arguments);

/// Whether the argument of --target is a file of measurements or standard input (-), and not a list of control points.
bool is_measured(const std::string& target);

/// The bytes of a file, or of standard input if it is "-". Throws Failure(local_file).
std::string bytes_of_measurements(const std::string& file);

/// The server's answer for the measurements in a file, of which `bytes` is the content. Throws Failure.
nlohmann::json reduce_curve(Session& session, const std::string& bytes, const std::string& task,
                            const MeasuredCurveArguments& arguments);

/// A sentence on how well the control points approximate the curve.
std::string reduction_words(const nlohmann::json& answer);

/// Prints the notes and warnings about the curve on standard error, warnings in their colour.
void print_curve_notes(const nlohmann::json& answer);

}  // namespace supple::cli
