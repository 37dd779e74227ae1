#include "cost_output.h"

#include <fmt/core.h>

namespace supple::cli {

void print_cost(const nlohmann::json& answer) {
  fmt::print("took        {:.4g} s\n", answer.at("cost").at("seconds").get<double>());
}

}  // namespace supple::cli
