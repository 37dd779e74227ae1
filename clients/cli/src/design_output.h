#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace supple::cli {

/// The designs of an answer of /v1/designs: its regions, or the one.
std::vector<nlohmann::json> designs_in(const nlohmann::json& answer);
/// The profiles of a design: that of the main target, then the others.
std::vector<nlohmann::json> profiles_in(const nlohmann::json& design);

/// The file of one of several: "name-2.svg" for the second; the name itself where there is one.
std::string numbered_file(const std::string& file, std::size_t index, std::size_t count);

/// A line for each sample of each target of each region. Verified values stand at the samples that were simulated.
std::string designs_as_csv(const nlohmann::json& answer);
void print_designs(const nlohmann::json& answer);

/// The same of an answer of /v1/profiles.
std::string profile_as_csv(const nlohmann::json& answer);
void print_profile(const nlohmann::json& answer);

}  // namespace supple::cli
