#include "supple/lab/design_sequence.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "supple/base/random.h"
#include "supple/base/sobol.h"

namespace supple::lab {
namespace {

constexpr std::size_t load_coordinate_count = 4;
static_assert(load_coordinate_count < SobolSequence::max_dimensions);

std::array<double, load_coordinate_count> load_coordinates_of(
    const std::array<double, SobolSequence::max_dimensions>& point) {
  std::array<double, load_coordinate_count> load_coordinates{};
  std::copy(point.end() - load_coordinate_count, point.end(), load_coordinates.begin());
  return load_coordinates;
}

std::uint64_t design_seed(std::uint64_t seed, std::int64_t index) {
  return RandomStream("lab.design", seed).next() + static_cast<std::uint64_t>(index);
}

/// Range of parameter `i` in the part of the box, or in the family's box. `check` allows a part to end outside of the
/// widened box by a rounding error. Such a part is clamped to the widened box, because no structures exist outside.
std::pair<double, double> range_of(const DatasetOptions& options, const tiling::Parameter& bounds, std::size_t i) {
  const auto& [lower, upper, preset] = bounds;
  if (options.part_lower.empty()) return {lower, upper};
  const double margin = options.box_margin * (upper - lower);
  return {std::max(options.part_lower[i], lower - margin), std::min(options.part_upper[i], upper + margin)};
}

}  // namespace

PlannedDesign planned_design(const DatasetOptions& options, std::int64_t index) {
  const auto& bounds = family_of(options).parameters;
  PlannedDesign design{index, options.parameters, {}};
  if (!options.list.empty()) {
    const auto listed = options.list.begin() + index * static_cast<std::int64_t>(bounds.size());
    design.parameters.assign(listed, listed + static_cast<std::int64_t>(bounds.size()));
  }
  const bool chosen = !design.parameters.empty();
  const std::int64_t corners = options.corners && !chosen ? std::int64_t{1} << bounds.size() : 0;
  const bool corner = index < corners;
  // The loads of the corners are from a separate sequence, so that the other designs use each point of the main one.
  const SobolSequence sequence(corner ? "lab.corners" : "lab.designs", options.seed);
  const auto point = sequence.point(static_cast<std::uint32_t>(corner ? index : index - corners));
  if (!chosen) {
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      const auto [lower, upper] = range_of(options, bounds[i], i);
      // A part is not widened. The family's box is widened, except for its corners.
      const double margin = options.part_lower.empty() ? options.box_margin * (upper - lower) : 0;
      design.parameters.push_back(corner ? ((index >> i) & 1) != 0 ? upper : lower
                                         : lower - margin + point[i] * (upper - lower + 2 * margin));
    }
  }
  auto load_coordinates = load_coordinates_of(point);
  if (!options.directions.empty())
    std::fill_n(load_coordinates.begin(), 3, options.directions[static_cast<std::size_t>(index)] / std::numbers::pi);
  design.paths = plan_loads(options.loads, load_coordinates, design_seed(options.seed, index));
  return design;
}

}  // namespace supple::lab
