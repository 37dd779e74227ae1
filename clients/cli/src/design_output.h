#pragma once

#include <cstddef>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace supple::cli {

/// The designs in an answer of /v1/designs: those of its regions, or the answer itself.
std::vector<nlohmann::json> designs_in(const nlohmann::json& answer);
/// The profiles of a design: that of the main target, then the others.
std::vector<nlohmann::json> profiles_in(const nlohmann::json& design);

/// Whether a design misses its target, or nothing tells whether it reaches it.
bool misses_target(const nlohmann::json& design);

/// The indices of designs, the worst one first: those that miss their targets, then the others, by their deviations. A
/// design without a deviation is the worst of its kind.
std::vector<std::size_t> worst_first(const std::vector<nlohmann::json>& designs);

/// What to call the region of a design, which is the `index`-th of several.
std::string region_words(const nlohmann::json& design, std::size_t index);

/// The nearest that any material comes to the profile's target at rest, or to all targets of the design together if
/// there are several: an object with `deviation` and `y`. Null if there is none; older servers do not tell.
nlohmann::json nearest_possible(const nlohmann::json& profile);

/// The name of one of several files: "name-2.svg" for the second; `file` itself if there is only one.
std::string numbered_file(const std::string& file, std::size_t index, std::size_t count);

/// CSV with a line for each sample of each target of each region. Samples that were simulated have a verified value.
std::string designs_as_csv(const nlohmann::json& answer);
void print_designs(const nlohmann::json& answer);

/// CSV of an answer of /v1/profiles.
std::string profile_as_csv(const nlohmann::json& answer);
void print_profile(const nlohmann::json& answer);

}  // namespace supple::cli
