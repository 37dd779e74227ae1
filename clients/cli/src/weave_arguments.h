#pragma once

#include <CLI/App.hpp>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace supple::cli {

/// The options that describe the weave.
struct WeaveArguments {
  std::string weave;  ///< a pattern or a file
  std::string type;
  std::string sample;
  std::string connections;
  double pitch = 0;
  double side = 0;
  double overlap = 0;
  double circle_radius = 0;
  double distance = 0;
  std::string sheet;  ///< "4x3"
  int fused_border = 0;
  double radius = 0;
  double youngs_modulus = 0;
  std::string poisson_ratio;
  double sliding_fraction = 0;
  std::vector<std::string> fused;    ///< crossings whose strands are fused
  std::vector<std::string> sliding;  ///< "crossing:member"
};

void add_weave_options(CLI::App& command, WeaveArguments& arguments);

/// The weave as JSON. Throws Failure(usage) and Failure(local_file).
nlohmann::json weave_of(const WeaveArguments& arguments);

/// The options that say how equilibria are found.
struct EquilibriumArguments {
  int segments = 0;
  double tolerance = 0;
  int max_iterations = 0;
  int load_steps = 0;
  double limit_tolerance = 0;
  std::string least_distance;
  std::string barrier_range;
  std::string sliding_stiffness;
  std::string out_of_plane;
  std::string buckling;
  std::string error_estimate;
  double deadline = 0;
};

void add_equilibrium_options(CLI::App& command, EquilibriumArguments& arguments);

/// Sets the fields of a request for the options that are set.
void set_equilibrium_fields(const EquilibriumArguments& arguments, nlohmann::json& request);

}  // namespace supple::cli
