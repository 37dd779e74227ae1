#include "supple/lab/load_plan.h"

#include <cmath>
#include <numbers>
#include <string>

#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/base/random.h"

namespace supple::lab {
namespace {

using Stretches = std::vector<std::array<double, 2>>;

double fractional_part(double x) { return x - std::floor(x); }

/// Fractions in (0, 1] of the range of a path, which are denser towards rest: ((k + u) / (n - 1 + u))^2 for k = 0 .. n
/// - 1 with the offset u in (0, 1]. The last one is 1.
std::vector<double> range_fractions(int n, double offset) {
  std::vector<double> result;
  for (int k = 0; k < n; ++k) {
    const double t = (k + offset) / (n - 1 + offset);
    result.push_back(t * t);
  }
  return result;
}

PlannedPath planned(dataset::LoadKind kind, double direction, Stretches stretches) {
  PlannedPath result;
  result.path.kind = kind;
  result.path.direction = direction;
  result.path.end_stretch = stretches.back()[0];
  result.path.end_lateral_stretch = stretches.back()[1];
  result.path.planned = static_cast<std::int32_t>(stretches.size());
  result.stretches = std::move(stretches);
  return result;
}

/// A path of states from the change of stretch `first` to the stretch `end`.
PlannedPath uniaxial(double direction, double end, int states, double offset, double first) {
  const double range = std::abs(end - 1);
  const double sign = end < 1 ? -1 : 1;
  Stretches stretches;
  for (const double fraction : range_fractions(states, offset))
    stretches.push_back({1 + sign * (first + (range - first) * fraction), 0});
  stretches.back()[0] = end;
  return planned(dataset::LoadKind::uniaxial, direction, std::move(stretches));
}

PlannedPath biaxial(double direction, const std::array<double, 2>& end, int states, double offset, double first) {
  const std::array<double, 2> change{end[0] - 1, end[1] - 1};
  const double range = std::max(std::abs(change[0]), std::abs(change[1]));
  Stretches stretches;
  for (const double fraction : range_fractions(states, offset)) {
    const double scale = (first + (range - first) * fraction) / range;
    stretches.push_back({1 + scale * change[0], 1 + scale * change[1]});
  }
  stretches.back() = end;
  return planned(dataset::LoadKind::biaxial, direction, std::move(stretches));
}

/// The point at the fraction t in [0, 1) of the boundary of the square [low, high]^2.
std::array<double, 2> boundary_point(double low, double high, double t) {
  const double along = 4 * t;
  const double coordinate = low + (high - low) * fractional_part(along);
  switch (static_cast<int>(along)) {
    case 0:
      return {coordinate, low};
    case 1:
      return {high, coordinate};
    case 2:
      return {high + low - coordinate, high};
    default:
      return {low, high + low - coordinate};
  }
}

std::vector<PlannedPath> sequence_plan(const LoadPlanOptions& options, const std::array<double, 4>& load_coordinates,
                                       std::uint64_t seed) {
  RandomStream offsets("lab.load_plan", seed);
  const auto direction = [](double offset, int i, int n) {
    return std::numbers::pi * fractional_part(offset + static_cast<double>(i) / n);
  };
  std::vector<PlannedPath> plan;
  const int paths = options.tension_paths + options.compression_paths + options.biaxial_paths;
  plan.reserve(static_cast<std::size_t>(paths));
  for (int i = 0; i < options.tension_paths; ++i)
    plan.push_back(uniaxial(direction(load_coordinates[0], i, options.tension_paths), options.max_stretch,
                            options.tension_states, 1 - offsets.uniform(), options.first_strain));
  for (int i = 0; i < options.compression_paths; ++i)
    plan.push_back(uniaxial(direction(load_coordinates[1], i, options.compression_paths), options.min_stretch,
                            options.compression_states, 1 - offsets.uniform(), options.first_strain));
  for (int i = 0; i < options.biaxial_paths; ++i) {
    // Multiples of the golden ratio are spread evenly, and are not correlated with the directions.
    const double boundary_position = fractional_part(load_coordinates[3] + i * (std::numbers::phi - 1));
    const auto end = boundary_point(options.min_biaxial_stretch, options.max_biaxial_stretch, boundary_position);
    plan.push_back(biaxial(direction(load_coordinates[2], i, options.biaxial_paths), end, options.biaxial_states,
                           1 - offsets.uniform(), options.first_strain));
  }
  return plan;
}

std::vector<PlannedPath> grid_plan() {
  constexpr int directions = 15;
  std::vector<PlannedPath> plan;
  for (int d = 0; d < directions; ++d) {
    const double direction = d * std::numbers::pi / directions;
    Stretches tension;
    for (int k = 0; 1.001 + 0.016 * k <= 1.5; ++k) tension.push_back({1.001 + 0.016 * k, 0});
    plan.push_back(planned(dataset::LoadKind::uniaxial, direction, std::move(tension)));
    Stretches compression;
    for (int k = 0; 0.999 - 0.016 * k >= 0.7; ++k) compression.push_back({0.999 - 0.016 * k, 0});
    plan.push_back(planned(dataset::LoadKind::uniaxial, direction, std::move(compression)));
    for (int i = 0; i < 10; ++i)
      for (int j = 0; j < 10; ++j)
        plan.push_back(planned(dataset::LoadKind::biaxial, direction, {{0.9 + 0.03 * i, 0.9 + 0.03 * j}}));
  }
  return plan;
}

}  // namespace

void check(const LoadPlanOptions& options) {
  std::vector<Error::Detail> details;
  const auto count = [&](const char* where, int value, int min_value) {
    if (value < min_value || value > 1000)
      details.push_back({where, "must lie within [" + number_text(min_value) + ", 1000], got " + number_text(value)});
  };
  const auto within = [&](const char* where, double value, double low, double high) {
    if (!(value >= low && value <= high))
      details.push_back(
          {where, "must lie within [" + number_text(low) + ", " + number_text(high) + "], got " + number_text(value)});
  };
  count("tension_paths", options.tension_paths, 0);
  count("compression_paths", options.compression_paths, 0);
  count("biaxial_paths", options.biaxial_paths, 0);
  count("tension_states", options.tension_states, 1);
  count("compression_states", options.compression_states, 1);
  count("biaxial_states", options.biaxial_states, 1);
  within("largest_stretch", options.max_stretch, 1.01, 4);
  within("smallest_stretch", options.min_stretch, 0.2, 0.99);
  within("largest_biaxial_stretch", options.max_biaxial_stretch, 1.01, 4);
  within("smallest_biaxial_stretch", options.min_biaxial_stretch, 0.2, 0.99);
  within("first_strain", options.first_strain, 1e-6, 5e-3);
  if (options.tension_paths + options.compression_paths + options.biaxial_paths == 0)
    details.push_back({"tension_paths", "a design needs at least one load path of any kind"});
  if (!details.empty())
    throw Error("dataset.invalid_option", details.front().where + " " + details.front().message + ".", details);
}

microscale::Load PlannedPath::load() const {
  if (path.kind == dataset::LoadKind::uniaxial) {
    microscale::UniaxialLoad uniaxial{path.direction, {}};
    for (const auto& s : stretches) uniaxial.stretches.push_back(s[0]);
    return uniaxial;
  }
  microscale::BiaxialLoad biaxial{path.direction, {}};
  for (const auto& s : stretches) biaxial.stretches.emplace_back(s[0], s[1]);
  return biaxial;
}

std::vector<PlannedPath> plan_loads(const LoadPlanOptions& options, const std::array<double, 4>& load_coordinates,
                                    std::uint64_t seed) {
  switch (options.kind) {
    case PlanKind::grid:
      return grid_plan();
    case PlanKind::rest:
      return {planned(dataset::LoadKind::biaxial, 0, {{1, 1}})};
    default:
      return sequence_plan(options, load_coordinates, seed);
  }
}

}  // namespace supple::lab
