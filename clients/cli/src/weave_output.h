#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "profile_plot.h"

namespace supple::cli {

/// Prints a layout for people, with a line for each crossing if `crossings`.
void print_layout(const nlohmann::json& answer, bool crossings);

/// CSV with a line of names and a line for each direction. Null gives an empty cell.
std::string homogenization_as_csv(const nlohmann::json& answer);
void print_homogenization(const nlohmann::json& answer);
/// Young's modulus and Poisson's ratio over directions.
std::vector<ProfilePlot> plots_of_homogenization(const nlohmann::json& answer);
/// CSV with a line of names and a line for each deformation gradient.
std::string deformations_as_csv(const nlohmann::json& answer);
void print_deformations(const nlohmann::json& answer);
/// Deformed strands as an OBJ file of polylines.
std::string strands_as_obj(const nlohmann::json& strands);

/// CSV with a line for each state, with the resultant reaction at each support of the request.
std::string sheet_states_as_csv(const nlohmann::json& answer);
void print_weave_simulation(const nlohmann::json& answer);

}  // namespace supple::cli
