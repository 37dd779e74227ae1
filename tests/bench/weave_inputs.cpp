// Cells, sheets and bookkeeping that the studies share.
#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "measurement.h"
#include "weave_bench.h"

namespace supple::bench {

using weave::CircleType;
using weave::Connection;
using weave::DirectionalResponse;
using weave::SquareType;
using weave::Stop;

std::string percent(double fraction) { return number(100 * fraction, 2); }

std::vector<BenchCell> all_cells() {
  return {{"regular, fused", weave::regular_weave(weave::uniform_block(Connection::fused))},
          {"regular, sliding", weave::regular_weave(weave::uniform_block(Connection::slides_y))},
          {"squares, type 1", weave::interlacing_squares(SquareType::all_fused)},
          {"squares, type 2", weave::interlacing_squares(SquareType::all_slide_x)},
          {"squares, type 3", weave::interlacing_squares(SquareType::slide_both_ways)},
          {"squares, type 4", weave::interlacing_squares(SquareType::one_corner_fused)},
          {"circles, fused", weave::interlacing_circles(CircleType::all_fused)},
          {"circles, sliding", weave::interlacing_circles(CircleType::all_slide)}};
}

BenchCell cell_named(const std::string& name) {
  for (BenchCell& cell : all_cells())
    if (cell.name == name) return std::move(cell);
  throw std::out_of_range("no cell is named " + name);
}

TimedCell run_timed(const weave::Weave& cell, const weave::HomogenizationOptions& options) {
  return billed([&](const Execution& execution) { return weave::homogenize(cell, options, execution); });
}

TimedSheet run_timed(const weave::Weave& sheet, const weave::SheetLoad& load,
                     const weave::EquilibriumOptions& options) {
  return billed([&](const Execution& execution) { return weave::simulate(sheet, load, options, execution); });
}

int iterations_of(const weave::SimulationResult& result) {
  int sum = 0;
  for (const weave::SheetState& state : result.states) sum += state.iterations;
  return sum;
}

int load_steps_of(const weave::SimulationResult& result) {
  int sum = 0;
  for (const weave::SheetState& state : result.states) sum += state.load_steps;
  return sum;
}

bool converged(const weave::SimulationResult& result) {
  return result.message.empty() && std::all_of(result.states.begin(), result.states.end(),
                                               [](const auto& state) { return state.stopped == Stop::converged; });
}

weave::HomogenizationOptions uniaxial(double strain, int count, const weave::EquilibriumOptions& equilibrium) {
  weave::HomogenizationOptions options;
  options.strain = strain;
  options.directions = weave::directions_over_half_turn(count);
  options.equilibrium = equilibrium;
  return options;
}

LoadedSheet sheared_sheet(int n, Connection connection, Shear shear, double amount) {
  LoadedSheet sheet{weave::regular_sheet(n, n, weave::uniform_block(connection), sheet_pitch), {}};
  const auto fix = [&](int column, int row, const std::array<bool, 3>& fixed, const Eigen::Vector3d& displacement) {
    sheet.load.supports.push_back({row, (column + 0.5) * sheet_pitch, fixed, displacement});
  };
  constexpr std::array<bool, 3> all{true, true, true};
  const int last = n - 1;
  const double distance = amount * last * sheet_pitch;
  if (shear == Shear::diagonal) {
    for (const auto& [column, row] : {std::pair(0, 0), std::pair(1, 0), std::pair(0, 1)}) {
      fix(column, row, all, {0, 0, 0});
      fix(last - column, last - row, all, {-distance, -distance, 0});
    }
    return sheet;
  }
  for (int column = 0; column < n; ++column) {
    fix(column, 0, all, {0, 0, 0});
    fix(column, last, {true, shear == Shear::level, true}, {distance, 0, 0});
  }
  return sheet;
}

ProfileError profile_error(const std::vector<DirectionalResponse>& profile,
                           const std::vector<DirectionalResponse>& reference) {
  std::vector<double> modulus, poisson, scale;
  ProfileError error;
  for (std::size_t i = 0; i < reference.size(); ++i) {
    const bool alike = profile[i].state.stopped == Stop::converged && reference[i].state.stopped == Stop::converged &&
                       profile[i].state.out_of_plane == reference[i].state.out_of_plane;
    if (!alike) {
      ++error.left_out;
      continue;
    }
    scale.push_back(reference[i].youngs_modulus);
    modulus.push_back(std::abs(profile[i].youngs_modulus - reference[i].youngs_modulus));
    poisson.push_back(profile[i].poisson_ratio - reference[i].poisson_ratio);
  }
  error.compared = static_cast<int>(modulus.size());
  if (modulus.empty()) return error;
  error.modulus_rms = root_mean_square(modulus) / root_mean_square(scale);
  error.modulus_worst = quantile(modulus, 1) / root_mean_square(scale);
  error.poisson_rms = root_mean_square(poisson);
  return error;
}

WeaveTimes times_of(const CostLedger& cost) {
  WeaveTimes times;
  for (const char* term : {"stretch", "bend", "twist", "joint_bend", "joint_twist", "sliding_limits",
                           "crossing_contact", "sliding_regularizer", "point_forces"})
    times.assembly += effect_seconds(cost, term);
  times.factorization = stage_seconds(cost, "factorization");
  times.solve = stage_seconds(cost, "solve");
  times.out_of_plane = stage_seconds(cost, "out-of-plane stability");
  return times;
}

}  // namespace supple::bench
