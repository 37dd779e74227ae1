#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// CSV with a line of names, and a line for each strain with all values of the answer. `strains` are those of the
/// request.
std::string evaluation_as_csv(const nlohmann::json& strains, const nlohmann::json& answer);
/// Prints the answer for people.
void print_evaluation(const nlohmann::json& strains, const nlohmann::json& answer);

/// CSV with a line of names and a line for each state. Null gives an empty cell.
std::string uniaxial_as_csv(const nlohmann::json& states);
/// Prints the states for people.
void print_uniaxial(const nlohmann::json& answer);

}  // namespace supple::cli
