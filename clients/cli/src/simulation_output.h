#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// One line for each state with everything that is a number, after a line of names. What is null is empty.
std::string states_as_csv(const nlohmann::json& states);

/// Where the file of a state goes: the file itself where there is one state, else "name-0007.vtu", counted from 0.
/// `extension` is for names without one.
std::string state_file(const std::string& file, std::size_t state, std::size_t states, const char* extension);

/// The states for people, and why the path ended early.
void print_simulation(const nlohmann::json& answer);

}  // namespace supple::cli
