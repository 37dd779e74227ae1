#include "part_simulation_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "cost_output.h"
#include "csv_cells.h"
#include "style.h"
#include "table_numbers.h"

namespace supple::cli {
namespace {

using Vector = std::array<double, 2>;

double length_of(const Vector& v) { return std::hypot(v[0], v[1]); }

/// The force over the displacement of the support that moves farthest, both along its motion: positive where the
/// support does work.
struct ForceCurve {
  std::size_t support = 0;
  std::vector<double> displacement;  ///< mm
  std::vector<double> force;         ///< N
};

ForceCurve force_curve(const nlohmann::json& answer) {
  ForceCurve curve;
  const auto& states = answer.at("states");
  Vector motion{};
  for (std::size_t k = 0; k < answer.at("supports").size(); ++k) {
    const auto moved = answer.at("supports").at(k).at("displacement").get<Vector>();
    if (length_of(moved) < length_of(motion)) continue;
    motion = moved;
    curve.support = k;
  }
  const double length = length_of(motion);
  const Vector along = length > 0 ? Vector{motion[0] / length, motion[1] / length} : Vector{0, 1};
  for (const auto& state : states) {
    const auto& support = state.at("supports").at(curve.support);
    const auto force = support.at("force").get<Vector>();
    curve.displacement.push_back(state.at("share").get<double>() * length);
    curve.force.push_back(force[0] * along[0] + force[1] * along[1]);
  }
  return curve;
}

/// "the top plate", "clamp 2" by its number from 1.
std::string support_name(const nlohmann::json& supports, std::size_t index) {
  const auto& support = supports.at(index);
  if (support.at("kind") == "plate") return fmt::format("the {} plate", support.at("side").get<std::string>());
  return fmt::format("clamp {}", index + 1);
}

void print_supports(const nlohmann::json& answer) {
  const auto& last = answer.at("states").back().at("supports");
  double scale = 0;
  for (const auto& support : last) scale = std::max(scale, scale_of(support.at("force")));
  for (std::size_t k = 0; k < last.size(); ++k) {
    const auto& force = last.at(k).at("force");
    fmt::print("{:<16} exerts ({}, {}) N at the end, touches {} nodes\n", support_name(answer.at("supports"), k),
               rounded(force.at(0), scale), rounded(force.at(1), scale), last.at(k).at("touching").get<int>());
  }
}

void print_part_accuracy(const nlohmann::json& accuracy) {
  const auto& residual = accuracy.at("residual");
  fmt::print("residual    {} (asked for {:.1e})\n",
             residual.is_null() ? "none" : fmt::format("{:.1e}", residual.get<double>()),
             accuracy.at("tolerance").get<double>());
  fmt::print("mesh        {} nodes, {} unknowns at most\n", accuracy.at("nodes").get<int>(),
             accuracy.at("unknowns").get<int>());
  const auto& error = accuracy.at("discretization_error");
  fmt::print("mesh error  {}\n", error.is_null() ? "unknown"
                                                 : fmt::format("{:.2g} % of the forces, {:.2g} % of the energy",
                                                               100 * error.at("force").get<double>(),
                                                               100 * error.at("energy").get<double>()));
}

}  // namespace

std::string part_states_as_csv(const nlohmann::json& states) {
  std::string text = "state,share";
  const std::size_t supports = states.empty() ? 0 : states.front().at("supports").size();
  for (std::size_t k = 0; k < supports; ++k)
    for (const char* name : {"displacement_x", "displacement_y", "force_x", "force_y", "touching"})
      text += fmt::format(",{}_{}", name, k);
  constexpr std::array members{"energy",  "largest_strain", "contacts",   "stable",    "branch",
                               "stopped", "residual",       "iterations", "load_steps"};
  for (const char* name : members) text += fmt::format(",{}", name);
  text += '\n';
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto& state = states.at(i);
    std::string line = std::to_string(i) + ',' + cell_text(state.at("share"));
    for (const auto& support : state.at("supports")) {
      append_cells(line, support.at("displacement"));
      append_cells(line, support.at("force"));
      line += ',' + cell_text(support.at("touching"));
    }
    for (const char* name : members) line += ',' + cell_text(state.at(name));
    text += line + '\n';
  }
  return text;
}

void print_part_simulation(const nlohmann::json& answer) {
  const auto& part = answer.at("part");
  const auto& size = part.at("size");
  fmt::print("size        {:.6g} x {:.6g} x {:.6g} mm\n", size.at(0).get<double>(), size.at(1).get<double>(),
             size.at(2).get<double>());
  const ForceCurve curve = force_curve(answer);
  fmt::print("moved       {}\n", support_name(answer.at("supports"), curve.support));
  fmt::print("{:>5}  {:>12}  {:>12}  {:>8}  {:>8}  {}\n", "state", "moved/mm", "force/N", "strain/%", "contacts",
             "stopped");
  double scale = 0;
  for (const double force : curve.force) scale = std::max(scale, std::abs(force));
  std::size_t i = 0;
  for (const auto& state : answer.at("states")) {
    fmt::print("{:>5}  {:>12}  {:>12}  {:>8.3g}  {:>8}  {}{}\n", i, with_decimals(curve.displacement[i]),
               rounded(curve.force[i], scale), 100 * state.at("largest_strain").get<double>(),
               state.at("contacts").get<int>(), state.at("stopped").get<std::string>(),
               state.at("stable").get<bool>() ? "" : ", unstable");
    ++i;
  }
  print_supports(answer);
  print_part_accuracy(answer.at("accuracy"));
  print_cost(answer);
  if (const auto lacks = part.at("message").get<std::string>(); !lacks.empty()) print_notice(lacks);
  if (const auto message = answer.at("message").get<std::string>(); !message.empty())
    print_notice("the path ended early: " + message);
}

ProfilePlot plot_of_part(const nlohmann::json& answer) {
  const ForceCurve curve = force_curve(answer);
  const auto& size = answer.at("part").at("size");
  ProfilePlot plot;
  plot.title = fmt::format("Part of {:.6g} x {:.6g} x {:.6g} mm", size.at(0).get<double>(), size.at(1).get<double>(),
                           size.at(2).get<double>());
  const auto name = support_name(answer.at("supports"), curve.support);
  plot.subtitle = "force of " + name + " along its displacement";
  plot.x_label = "displacement (mm)";
  plot.y_label = "force (N)";
  // The part is at rest at first.
  plot.x = {0};
  plot.achieved = {0};
  plot.x.insert(plot.x.end(), curve.displacement.begin(), curve.displacement.end());
  plot.achieved.insert(plot.achieved.end(), curve.force.begin(), curve.force.end());
  plot.achieved_name = "simulated part";
  return plot;
}

}  // namespace supple::cli
