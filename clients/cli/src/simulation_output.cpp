#include "simulation_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "cost_output.h"
#include "csv_cells.h"
#include "style.h"
#include "table_numbers.h"

namespace supple::cli {
namespace {

constexpr auto header =
    "state,E_xx,E_yy,E_xy,S_xx,S_yy,S_xy,energy_density,F_xx,F_xy,F_yx,F_yy,C_11,C_12,C_13,C_21,C_22,C_23,C_31,C_32,"
    "C_33,stopped,residual,iterations,load_steps,contacts,smallest_gap,smallest_jacobian,stable,branch,cells,"
    "stress_error,energy_density_error\n";

}  // namespace

std::string states_as_csv(const nlohmann::json& states) {
  std::string text = header;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto& state = states.at(i);
    std::string line = std::to_string(i);
    for (const char* name : {"green_strain", "stress"}) append_cells(line, state.at(name));
    line += ',' + cell_text(state.at("energy_density"));
    append_matrix(line, state.at("deformation_gradient"), 2);
    append_matrix(line, state.at("tangent"), 3);
    for (const char* name :
         {"stopped", "residual", "iterations", "load_steps", "contacts", "smallest_gap", "smallest_jacobian", "stable",
          "branch", "cells", "stress_error", "energy_density_error"}) {
      line += ',' + cell_text(state.at(name));
    }
    text += line + '\n';
  }
  return text;
}

std::string state_file(const std::string& file, std::size_t state, std::size_t states, const char* extension) {
  if (states == 1) return file;
  const std::filesystem::path path(file);
  const auto end = path.has_extension() ? path.extension().string() : extension;
  return (path.parent_path() / fmt::format("{}-{:04}{}", path.stem().string(), state, end)).string();
}

void print_simulation(const nlohmann::json& answer) {
  fmt::print("{:>5}  {:>9} {:>9} {:>9}  {:>11} {:>11} {:>11}  {:>11}  {:>8}  {}\n", "state", "E_xx", "E_yy", "E_xy",
             "S_xx/MPa", "S_yy/MPa", "S_xy/MPa", "energy/MPa", "contacts", "stopped");
  double stress_scale = 0;
  double energy_scale = 0;
  for (const auto& state : answer.at("states")) {
    stress_scale = std::max(stress_scale, scale_of(state.at("stress")));
    energy_scale = std::max(energy_scale, scale_of(state.at("energy_density")));
  }
  std::size_t number = 0;
  for (const auto& state : answer.at("states")) {
    fmt::print("{:>5} ", number++);
    for (const auto& component : state.at("green_strain")) fmt::print(" {:>9}", with_decimals(component.get<double>()));
    fmt::print(" ");
    for (const auto& component : state.at("stress")) fmt::print(" {:>11}", rounded(component, stress_scale));
    fmt::print("  {:>11}  {:>8}  {}{}\n", rounded(state.at("energy_density"), energy_scale),
               state.at("contacts").get<int>(), state.at("stopped").get<std::string>(),
               state.at("stable").get<bool>() ? "" : ", unstable");
  }
  const auto& accuracy = answer.at("accuracy");
  const auto& residual = accuracy.at("residual");
  fmt::print("residual    {} (asked for {:.1e})\n",
             residual.is_null() ? "none" : fmt::format("{:.1e}", residual.get<double>()),
             accuracy.at("tolerance").get<double>());
  fmt::print("mesh        {} nodes in a cell, {} unknowns at most\n", accuracy.at("nodes").get<int>(),
             accuracy.at("unknowns").get<int>());
  const auto& error = accuracy.at("discretization_error");
  if (error.is_null()) {
    fmt::print("mesh error  unknown\n");
  } else {
    const bool exceeded = accuracy.at("error_accepted") == false;
    fmt::print(
        "mesh error  {:.2g} % of the stress, {:.2g} % of the energy{}{}\n", 100 * error.at("stress").get<double>(),
        100 * error.at("energy").get<double>(), accuracy.at("extrapolated").get<bool>() ? ", after extrapolation" : "",
        exceeded ? fmt::format("; {:.2g} % was asked for", 100 * accuracy.at("accepted_error").get<double>()) : "");
  }
  print_cost(answer);
  if (const auto message = answer.at("message").get<std::string>(); !message.empty()) {
    print_notice("the path ended early: " + message);
  }
}

}  // namespace supple::cli
