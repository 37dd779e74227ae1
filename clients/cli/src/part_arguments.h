#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "drawing_arguments.h"
#include "session.h"

namespace supple::cli {

/// The options that say what a part is like.
struct PartArguments {
  std::string family;
  std::string parameters;
  std::string request_file;
  std::string design_file;
  std::string coupon;
  std::string block;
  std::string rectangle;
  std::string outline;
  std::vector<std::string> regions;
  DrawingArguments drawing;
  double grip = -1;
  double plate = -1;
  double beam_width = 0;
  std::string orientation;
  std::string direction;
  std::string axis;
  double frame = -1;
  double seam = -1;
  double smallest_wall = -1;
  double thickness = 0;
  double density = 0;
  bool whole = false;
};

void add_part_options(CLI::App& command, PartArguments& arguments);

/// The request for the part. `command` is the one that has the options. Throws Failure(usage) if they describe no part
/// or have no effect on it, and Failure(local_file).
nlohmann::json part_request(const CLI::App& command, const PartArguments& arguments, Session& session);

}  // namespace supple::cli
