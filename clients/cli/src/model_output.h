#pragma once

#include <nlohmann/json.hpp>
#include <string>

namespace supple::cli {

/// One line for each strain with everything that the answer has, after a line of names. `strains` are those of the
/// request.
std::string evaluation_as_csv(const nlohmann::json& strains, const nlohmann::json& answer);
/// The same for people.
void print_evaluation(const nlohmann::json& strains, const nlohmann::json& answer);

/// One line for each state, after a line of names. What is null is empty.
std::string uniaxial_as_csv(const nlohmann::json& states);
/// The states for people.
void print_uniaxial(const nlohmann::json& answer);

}  // namespace supple::cli
