#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "profile_plot.h"

// Answers of /v1/part-simulations.
namespace supple::cli {

/// CSV with a line of names, and a line for each state with the displacement and the force of each support, as the
/// server's text/csv has them. Null gives an empty cell.
std::string part_states_as_csv(const nlohmann::json& states);

/// Prints the states for people: the force over the displacement of the support that moves farthest, then what all
/// supports exert at the end, and why the path ended early.
void print_part_simulation(const nlohmann::json& answer);

/// The plot of force over displacement of the support that moves farthest.
ProfilePlot plot_of_part(const nlohmann::json& answer);

}  // namespace supple::cli
