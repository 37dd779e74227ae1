#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// CSV with a line of names, and a line for each state with all of its numbers. Null gives an empty cell.
std::string states_as_csv(const nlohmann::json& states);

/// The name of a state's file: `file` itself if there is one state, else "name-0007.vtu", counted from 0. `extension`
/// is added to names without one.
std::string state_file(const std::string& file, std::size_t state, std::size_t states, const char* extension);

/// Prints the states for people, and why the path ended early.
void print_simulation(const nlohmann::json& answer);

}  // namespace supple::cli
