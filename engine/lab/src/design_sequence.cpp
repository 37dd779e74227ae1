#include "supple/lab/design_sequence.h"

#include <algorithm>
#include <numbers>
#include <utility>

#include "supple/base/random.h"
#include "supple/base/sobol.h"
#include "supple/tiling/family.h"

namespace supple::lab {
namespace {

constexpr std::size_t load_turns = 4;
static_assert(load_turns < SobolSequence::max_dimensions);

std::array<double, load_turns> turns_of(const std::array<double, SobolSequence::max_dimensions>& point) {
  std::array<double, load_turns> turns{};
  std::copy(point.end() - load_turns, point.end(), turns.begin());
  return turns;
}

std::uint64_t design_seed(std::uint64_t seed, std::int64_t index) {
  return RandomStream("lab.design", seed).next() + static_cast<std::uint64_t>(index);
}

/// Of parameter `i`, in the part or in the family's own box. A part that `check` lets end beyond the widened box, by
/// rounding, ends at its border, where structures do.
std::pair<double, double> range_of(const DatasetOptions& options, const tiling::Parameter& bounds, std::size_t i) {
  const auto& [lower, upper, preset] = bounds;
  if (options.part_lower.empty()) return {lower, upper};
  const double margin = options.box_margin * (upper - lower);
  return {std::max(options.part_lower[i], lower - margin), std::min(options.part_upper[i], upper + margin)};
}

}  // namespace

PlannedDesign planned_design(const DatasetOptions& options, std::int64_t index) {
  const auto& bounds = tiling::family(options.family).parameters;
  PlannedDesign design{index, options.parameters, {}};
  if (!options.list.empty()) {
    const auto listed = options.list.begin() + index * static_cast<std::int64_t>(bounds.size());
    design.parameters.assign(listed, listed + static_cast<std::int64_t>(bounds.size()));
  }
  const bool chosen = !design.parameters.empty();
  const std::int64_t corners = options.corners && !chosen ? std::int64_t{1} << bounds.size() : 0;
  const bool corner = index < corners;
  // Corners have a sequence of their own for their loads, so that the other designs are the whole sequence.
  const SobolSequence sequence(corner ? "lab.corners" : "lab.designs", options.seed);
  const auto point = sequence.point(static_cast<std::uint32_t>(corner ? index : index - corners));
  if (!chosen) {
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      const auto [lower, upper] = range_of(options, bounds[i], i);
      // A part ends where it says; the family's box is widened, except for its corners.
      const double margin = options.part_lower.empty() ? options.box_margin * (upper - lower) : 0;
      design.parameters.push_back(corner ? ((index >> i) & 1) != 0 ? upper : lower
                                         : lower - margin + point[i] * (upper - lower + 2 * margin));
    }
  }
  auto turns = turns_of(point);
  if (!options.directions.empty())
    std::fill_n(turns.begin(), 3, options.directions[static_cast<std::size_t>(index)] / std::numbers::pi);
  design.paths = plan_loads(options.loads, turns, design_seed(options.seed, index));
  return design;
}

}  // namespace supple::lab
