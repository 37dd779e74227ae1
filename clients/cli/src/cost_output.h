#pragma once

#include <nlohmann/json.hpp>

namespace supple::cli {

/// Prints how long the server took.
void print_cost(const nlohmann::json& answer);

}  // namespace supple::cli
