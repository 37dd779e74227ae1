#include "model_output.h"

#include <fmt/format.h>

#include <algorithm>

#include "cost_output.h"
#include "csv_cells.h"
#include "table_numbers.h"

namespace supple::cli {
namespace {

void print_strains(const nlohmann::json& values) {
  for (const auto& value : values) fmt::print(" {:>9}", with_decimals(value.get<double>()));
}

void print_stresses(const nlohmann::json& values, double scale) {
  for (const auto& value : values) fmt::print(" {:>11}", rounded(value, scale));
}

/// The scale of a member of all states.
double scale_in(const nlohmann::json& states, const char* name) {
  double scale = 0;
  for (const auto& state : states) scale = std::max(scale, scale_of(state.at(name)));
  return scale;
}

void print_model_and_cost(const nlohmann::json& answer) {
  fmt::print("model       {}\n", answer.at("model").get<std::string>());
  print_cost(answer);
}

/// The stress error bar of state `i`; null if the answer has none.
nlohmann::json stress_error_bar_at(const nlohmann::json& answer, std::size_t i) {
  const auto& bars = answer.at("stress_error_bar");
  return bars.is_null() ? nlohmann::json(nullptr) : bars.at(i);
}

}  // namespace

std::string evaluation_as_csv(const nlohmann::json& strains, const nlohmann::json& answer) {
  const bool stresses = answer.contains("stress");
  const bool tangents = answer.contains("tangent");
  std::string text = "strain,E_xx,E_yy,E_xy,energy_density";
  if (stresses) text += ",S_xx,S_yy,S_xy";
  if (tangents) text += ",C_11,C_12,C_13,C_21,C_22,C_23,C_31,C_32,C_33";
  if (stresses) text += ",stress_error_bar";
  text += ",in_range\n";
  for (std::size_t i = 0; i < strains.size(); ++i) {
    std::string line = std::to_string(i);
    append_cells(line, strains.at(i));
    line += ',' + cell_text(answer.at("energy_density").at(i));
    if (stresses) append_cells(line, answer.at("stress").at(i));
    if (tangents) append_matrix(line, answer.at("tangent").at(i), 3);
    if (stresses) line += ',' + cell_text(stress_error_bar_at(answer, i));
    line += ',' + cell_text(answer.at("in_range").at(i));
    text += line + '\n';
  }
  return text;
}

void print_evaluation(const nlohmann::json& strains, const nlohmann::json& answer) {
  const bool stresses = answer.contains("stress");
  fmt::print("{:>6}  {:>9} {:>9} {:>9}  {:>11}", "strain", "E_xx", "E_yy", "E_xy", "energy/MPa");
  if (stresses) fmt::print("  {:>11} {:>11} {:>11}  {:>9}", "S_xx/MPa", "S_yy/MPa", "S_xy/MPa", "error bar");
  fmt::print("  in range\n");
  for (std::size_t i = 0; i < strains.size(); ++i) {
    fmt::print("{:>6} ", i);
    print_strains(strains.at(i));
    fmt::print("  {:>11}", rounded(answer.at("energy_density").at(i), scale_of(answer.at("energy_density"))));
    if (stresses) {
      fmt::print(" ");
      print_stresses(answer.at("stress").at(i), scale_of(answer.at("stress")));
      fmt::print("  {:>9}", error_bar_text(stress_error_bar_at(answer, i), scale_of(answer.at("stress"))));
    }
    fmt::print("  {}\n", answer.at("in_range").at(i).get<bool>() ? "yes" : "no");
    if (!answer.contains("tangent")) continue;
    for (const auto& row : answer.at("tangent").at(i)) {
      fmt::print("{:>6}  {:<9}", "", "tangent");
      print_stresses(row, scale_of(answer.at("tangent").at(i)));
      fmt::print("\n");
    }
  }
  print_model_and_cost(answer);
}

std::string uniaxial_as_csv(const nlohmann::json& states) {
  std::string text =
      "state,E_xx,E_yy,E_xy,S_xx,S_yy,S_xy,directional_stress,error_bar,energy_density,in_range,converged,residual,"
      "iterations\n";
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto& state = states.at(i);
    std::string line = std::to_string(i);
    for (const char* name : {"green_strain", "stress"}) append_cells(line, state.at(name));
    for (const char* name :
         {"directional_stress", "error_bar", "energy_density", "in_range", "converged", "residual", "iterations"}) {
      line += ',' + cell_text(state.at(name));
    }
    text += line + '\n';
  }
  return text;
}

void print_uniaxial(const nlohmann::json& answer) {
  fmt::print("{:>5}  {:>9} {:>9} {:>9}  {:>11} {:>11} {:>11}  {:>11}  {:>9}  {:>11}  {}\n", "state", "E_xx", "E_yy",
             "E_xy", "S_xx/MPa", "S_yy/MPa", "S_xy/MPa", "along/MPa", "error bar", "energy/MPa", "in range");
  const double stress_scale = scale_in(answer.at("states"), "stress");
  const double energy_scale = scale_in(answer.at("states"), "energy_density");
  std::size_t number = 0;
  for (const auto& state : answer.at("states")) {
    fmt::print("{:>5} ", number++);
    print_strains(state.at("green_strain"));
    fmt::print(" ");
    print_stresses(state.at("stress"), stress_scale);
    fmt::print("  {:>11}  {:>9}  {:>11}  {}{}\n", rounded(state.at("directional_stress"), stress_scale),
               error_bar_text(state.at("error_bar"), stress_scale), rounded(state.at("energy_density"), energy_scale),
               state.at("in_range").get<bool>() ? "yes" : "no",
               state.at("converged").get<bool>() ? "" : ", not converged");
  }
  const auto& accuracy = answer.at("accuracy");
  const auto& residual = accuracy.at("residual");
  fmt::print("residual    {} (asked for {:.1e})\n",
             residual.is_null() ? "none" : fmt::format("{:.1e}", residual.get<double>()),
             accuracy.at("tolerance").get<double>());
  print_model_and_cost(answer);
}

}  // namespace supple::cli
