#include "weave_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "cost_output.h"
#include "csv_cells.h"
#include "plot_paper.h"
#include "style.h"
#include "table_numbers.h"

namespace supple::cli {
namespace {

/// What a member of "discretization_error" is the error of, in the words of this output.
std::string error_name(const std::string& name) {
  if (name == "youngs_modulus") return "Young";
  if (name == "poisson_ratio") return "Poisson";
  return name;
}

/// An error in per cent, or as it is where it is no relative one.
/// Errors below rounding are shown as 0.
std::string error_text(const std::string& name, double error) {
  constexpr double rounding = 1e-12;
  if (error < rounding) error = 0;
  return name == "poisson_ratio" ? fmt::format("{:.2g}", error) : fmt::format("{:.2g} %", 100 * error);
}

void print_accuracy(const nlohmann::json& answer) {
  const auto& accuracy = answer.at("accuracy");
  const auto& residual = accuracy.at("residual");
  fmt::print("residual    {} of what {:.1e} allows\n",
             residual.is_null() ? "none" : fmt::format("{:.1e}", residual.get<double>()),
             accuracy.at("tolerance").get<double>());
  std::string errors;
  if (const auto& discretization = accuracy.at("discretization_error"); discretization.is_object())
    for (const auto& [name, error] : discretization.items())
      errors += fmt::format("{}{} +- {}", errors.empty() ? "" : ", ", error_name(name),
                            error_text(name, error.get<double>()));
  fmt::print("error       {}\n", errors.empty() ? "unknown" : errors + ", because of the rods' resolution");
  const auto& limits = accuracy.at("limit_error");
  if (limits.is_null() || limits.get<double>() > 0)
    fmt::print("limits      an energy may be {} too high, because sliders stand short of their limits\n",
               limits.is_null() ? "any amount" : fmt::format("{:.1e} of it", limits.get<double>()));
}

void print_message(const nlohmann::json& answer) {
  if (const auto message = answer.at("message").get<std::string>(); !message.empty()) print_notice(message);
}

std::string members_text(const nlohmann::json& crossing) {
  std::string text;
  for (const auto& member : crossing.at("members"))
    text += fmt::format("{}{}{}", text.empty() ? "" : ", ", member.at("strand").get<int>(),
                        member.at("slides").get<bool>() ? " slides" : "");
  return text;
}

bool slides(const nlohmann::json& crossing) {
  const auto& members = crossing.at("members");
  return std::any_of(members.begin(), members.end(),
                     [](const nlohmann::json& member) { return member.at("slides").get<bool>(); });
}

/// The sum of a state's reactions over the places of each of the request's supports.
std::vector<std::array<double, 3>> resultants(const nlohmann::json& supports, const nlohmann::json& state) {
  std::vector<std::array<double, 3>> sums;
  for (std::size_t i = 0; i < supports.size(); ++i) {
    const auto support = supports.at(i).at("support").get<std::size_t>();
    if (sums.size() <= support) sums.resize(support + 1, {0, 0, 0});
    for (std::size_t c = 0; c < 3; ++c) sums[support][c] += state.at("reactions").at(i).at(c).get<double>();
  }
  return sums;
}

std::string range_text(const nlohmann::json& values, const char* unit) {
  Range range;
  for (const auto& value : values)
    if (!value.is_null()) range.add(value.get<double>());
  if (!(range.low <= range.high)) return "none";
  return fmt::format("{:.5g} to {:.5g}{}", range.low, range.high, unit);
}

}  // namespace

void print_layout(const nlohmann::json& answer, bool crossings) {
  const auto& list = answer.at("crossings");
  double length = 0;
  for (const auto& strand : answer.at("strands")) length += strand.at("length").get<double>();
  fmt::print("strands     {}, {:.6g} mm in all\n", answer.at("strands").size(), length);
  fmt::print("crossings   {}, {} of which slide\n", list.size(), std::count_if(list.begin(), list.end(), slides));
  if (const auto& lattice = answer.at("lattice"); lattice.is_null()) {
    fmt::print("lattice     none: a sheet\n");
  } else {
    for (const auto& translation : lattice)
      fmt::print("translation {} {} mm\n", rounded(translation.at(0), scale_of(lattice), 6),
                 rounded(translation.at(1), scale_of(lattice), 6));
  }
  if (crossings) {
    fmt::print("{:>8}  {:>9} {:>9}  {}\n", "crossing", "x/mm", "y/mm", "strands");
    for (std::size_t i = 0; i < list.size(); ++i) {
      const auto& at = list.at(i).at("position");
      fmt::print("{:>8}  {:>9.4f} {:>9.4f}  {}\n", i, at.at(0).get<double>(), at.at(1).get<double>(),
                 members_text(list.at(i)));
    }
  }
  for (const auto& warning : answer.at("warnings")) print_notice(warning.get<std::string>());
}

namespace {

constexpr auto state_names =
    "energy_density,stopped,residual,out_of_plane,stable,iterations,load_steps,branches,limit_error";

/// Adds the fields `state_names`, which every equilibrium of a cell has besides its gradient and stress.
void append_state(std::string& line, const nlohmann::json& answer, std::size_t i) {
  for (const char* name : {"energy_density", "stopped", "residual", "out_of_plane", "stable", "iterations",
                           "load_steps", "branches", "limit_error"})
    line += ',' + cell_text(answer.at(name).at(i));
}

std::string matrix_text(const nlohmann::json& matrix) {
  const double scale = scale_of(matrix);
  const auto entry = [&](int row, int column) { return rounded(matrix.at(row).at(column), scale, 4); };
  return fmt::format("{:>10} {:>10} {:>10} {:>10}", entry(0, 0), entry(0, 1), entry(1, 0), entry(1, 1));
}

}  // namespace

std::string deformations_as_csv(const nlohmann::json& answer) {
  std::string text =
      fmt::format("F_xx,F_xy,F_yx,F_yy,P_xx,P_xy,P_yx,P_yy,sigma_xx,sigma_xy,sigma_yx,sigma_yy,{}\n", state_names);
  for (std::size_t i = 0; i < answer.at("stopped").size(); ++i) {
    std::string line;
    for (const char* name : {"deformation_gradient", "nominal_stress", "cauchy_stress"})
      append_matrix(line, answer.at(name).at(i), 2);
    append_state(line, answer, i);
    text += line.substr(1) + '\n';
  }
  return text;
}

void print_deformations(const nlohmann::json& answer) {
  fmt::print("{:>43}   {:>43}  {:>10}  {}\n", "F: xx, xy, yx, yy", "Cauchy stress/(N/m): xx, xy, yx, yy", "W/(N/m)",
             "stopped");
  for (std::size_t i = 0; i < answer.at("stopped").size(); ++i)
    fmt::print("{}   {}  {:>10.5g}  {}{}\n", matrix_text(answer.at("deformation_gradient").at(i)),
               matrix_text(answer.at("cauchy_stress").at(i)), answer.at("energy_density").at(i).get<double>(),
               answer.at("stopped").at(i).get<std::string>(),
               answer.at("out_of_plane").at(i).get<bool>() ? ", out of plane" : "");
  print_accuracy(answer);
  print_cost(answer);
  print_message(answer);
}

std::string homogenization_as_csv(const nlohmann::json& answer) {
  const bool mpa = answer.contains("youngs_modulus_mpa");
  std::string text = fmt::format(
      "direction,youngs_modulus,{}poisson_ratio,youngs_modulus_error,poisson_ratio_error,F_xx,F_xy,F_yx,F_yy,sigma_xx,"
      "sigma_xy,sigma_yx,sigma_yy,{}\n",
      mpa ? "youngs_modulus_mpa," : "", state_names);
  for (std::size_t i = 0; i < answer.at("directions").size(); ++i) {
    std::string line = cell_text(answer.at("directions").at(i));
    line += ',' + cell_text(answer.at("youngs_modulus").at(i));
    if (mpa) line += ',' + cell_text(answer.at("youngs_modulus_mpa").at(i));
    for (const char* name : {"poisson_ratio", "youngs_modulus_error", "poisson_ratio_error"})
      line += ',' + cell_text(answer.at(name).at(i));
    append_matrix(line, answer.at("deformation_gradient").at(i), 2);
    append_matrix(line, answer.at("cauchy_stress").at(i), 2);
    append_state(line, answer, i);
    text += line + '\n';
  }
  return text;
}

void print_homogenization(const nlohmann::json& answer) {
  const auto& directions = answer.at("directions");
  const auto cell = [&](const char* name, std::size_t i) {
    return rounded(answer.at(name).at(i), scale_of(answer.at(name)));
  };
  const auto error_of = [&](const char* name, std::size_t i) {
    const auto& error = answer.at(name).at(i);
    return error.is_null() ? "unknown" : fmt::format("{:.2g}", error.get<double>());
  };
  // More directions than this are not printed, since they are better plotted.
  constexpr std::size_t max_lines = 24;
  if (directions.size() <= max_lines) {
    fmt::print("{:>10}  {:>12}  {:>12}  {:>10}  {:>10}  {}\n", "angle/rad", "E/(N/m)", "+-", "Poisson", "+-",
               "stopped");
    for (std::size_t i = 0; i < directions.size(); ++i)
      fmt::print("{:>10}  {:>12}  {:>12}  {:>10}  {:>10}  {}{}\n", with_decimals(directions.at(i).get<double>()),
                 cell("youngs_modulus", i), error_of("youngs_modulus_error", i), cell("poisson_ratio", i),
                 error_of("poisson_ratio_error", i), answer.at("stopped").at(i).get<std::string>(),
                 answer.at("out_of_plane").at(i).get<bool>() ? ", out of plane" : "");
  }
  fmt::print("directions  {} at the strain {:.6g}\n", directions.size(), answer.at("strain").get<double>());
  fmt::print("Young       {}\n", range_text(answer.at("youngs_modulus"), " N/m"));
  if (answer.contains("youngs_modulus_mpa"))
    fmt::print("            {}\n", range_text(answer.at("youngs_modulus_mpa"), " MPa"));
  fmt::print("Poisson     {}\n", range_text(answer.at("poisson_ratio"), ""));
  print_accuracy(answer);
  print_cost(answer);
  print_message(answer);
}

std::vector<ProfilePlot> plots_of_homogenization(const nlohmann::json& answer) {
  const auto plot_of = [&](const char* name, const char* title, const char* label) {
    ProfilePlot plot;
    plot.title = title;
    plot.subtitle = fmt::format("over the direction of the strain {:.4g} (rad), lateral strain and shear free",
                                answer.at("strain").get<double>());
    plot.achieved_name = label;
    plot.polar = true;
    plot.x = values_of(answer.at("directions"));
    plot.achieved = values_of(answer.at(name));
    return plot;
  };
  const bool mpa = answer.contains("youngs_modulus_mpa");
  return {plot_of(mpa ? "youngs_modulus_mpa" : "youngs_modulus", "Young\u2019s modulus", mpa ? "E (MPa)" : "E (N/m)"),
          plot_of("poisson_ratio", "Poisson\u2019s ratio", "Poisson\u2019s ratio")};
}

std::string strands_as_obj(const nlohmann::json& strands) {
  std::string points;
  std::string lines;
  std::size_t next = 1;
  for (const auto& strand : strands) {
    lines += "l";
    for (const auto& point : strand) {
      points +=
          fmt::format("v {} {} {}\n", point.at(0).get<double>(), point.at(1).get<double>(), point.at(2).get<double>());
      lines += fmt::format(" {}", next++);
    }
    lines += '\n';
  }
  return points + lines;
}

std::string sheet_states_as_csv(const nlohmann::json& answer) {
  const auto& supports = answer.at("supports");
  std::string text =
      "state,share,energy,stopped,residual,iterations,load_steps,branches,out_of_plane,stable,limit_error";
  for (std::size_t i = 0; i < answer.at("states").size(); ++i) {
    const auto& state = answer.at("states").at(i);
    const auto sums = resultants(supports, state);
    if (i == 0) {
      for (std::size_t k = 0; k < sums.size(); ++k) text += fmt::format(",R{0}_x,R{0}_y,R{0}_z", k);
      text += '\n';
    }
    std::string line = std::to_string(i);
    for (const char* name : {"share", "energy", "stopped", "residual", "iterations", "load_steps", "branches",
                             "out_of_plane", "stable", "limit_error"})
      line += ',' + cell_text(state.at(name));
    for (const auto& sum : sums)
      for (const double component : sum) line += fmt::format(",{}", component);
    text += line + '\n';
  }
  return text;
}

void print_weave_simulation(const nlohmann::json& answer) {
  fmt::print("{:>5}  {:>8}  {:>12}  {:>10}  {}\n", "state", "share", "energy/Nmm", "iterations", "stopped");
  std::size_t number = 0;
  for (const auto& state : answer.at("states"))
    fmt::print("{:>5}  {:>8.5f}  {:>12.6g}  {:>10}  {}{}{}\n", number++, state.at("share").get<double>(),
               state.at("energy").get<double>(), state.at("iterations").get<int>(),
               state.at("stopped").get<std::string>(), state.at("out_of_plane").get<bool>() ? ", out of plane" : "",
               state.at("stable").get<bool>() ? "" : ", unstable");
  const auto sums = resultants(answer.at("supports"), answer.at("states").back());
  const double force_scale = scale_of(answer.at("states").back().at("reactions"));
  for (std::size_t k = 0; k < sums.size(); ++k)
    fmt::print("support {:<3} {} {} {} N\n", k, rounded(sums[k][0], force_scale, 6),
               rounded(sums[k][1], force_scale, 6), rounded(sums[k][2], force_scale, 6));
  print_accuracy(answer);
  fmt::print("unknowns    {}\n", answer.at("accuracy").at("unknowns").get<int>());
  print_cost(answer);
  print_message(answer);
}

}  // namespace supple::cli
