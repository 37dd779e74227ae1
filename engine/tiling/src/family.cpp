#include "supple/tiling/family.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <sstream>
#include <utility>

#include "polygon.h"
#include "square_family.h"
#include "supple/base/error.h"
#include "supple/tiling/family_definition.h"
#include "supple/tiling/tiling_error.h"

namespace supple::tiling {
namespace {

/// Smallest allowed ratio of a tile's area to that of the default tile. The published data [LiCoros2023] state 15 %,
/// but have a design with 11.9 %.
constexpr double min_area_ratio = 0.1;

std::vector<Family> make_families() {
  std::vector<Family> result;
  for (const FamilyDefinition& definition : shipped_definitions()) result.push_back(make_family(definition));
  result.push_back({.id = "square",
                    .description = "A square of half side |p| in a square cell, corners joined; singular at p = 0",
                    .parameters = {{-1, 1, 0.5}},
                    .beam_width = 0.0848,
                    .holes_may_close = true,
                    .shape = [](std::span<const double> parameters) { return square_in_square(parameters[0]); }});
  return result;
}

void check_bounds(const Family& family, std::span<const double> parameters, double box_margin) {
  if (parameters.size() != family.parameters.size()) {
    std::ostringstream message;
    message << "Family " << family.id << " has " << family.parameters.size()
            << (family.parameters.size() == 1 ? " parameter" : " parameters") << ", but " << parameters.size()
            << (parameters.size() == 1 ? " was given." : " were given.");
    throw TilingError("tiling.parameter_count", message.str(), {{"parameters", message.str()}});
  }
  std::vector<Error::Detail> details;
  for (std::size_t k = 0; k < parameters.size(); ++k) {
    const auto [lower, upper, preset] = family.parameters[k];
    const double margin = box_margin * (upper - lower);
    // The condition is negated, so that NaN is out of bounds.
    if (!(parameters[k] >= lower - margin && parameters[k] <= upper + margin)) {
      std::ostringstream message;
      message << "must lie between " << lower - margin << " and " << upper + margin << ", but is " << parameters[k];
      details.push_back({"parameters/" + std::to_string(k), message.str()});
    }
  }
  if (details.empty()) return;
  throw TilingError(
      "tiling.parameter_out_of_bounds",
      "Family " + family.id + ": parameter " + details[0].where.substr(11) + " " + details[0].message + ".", details);
}

void check_area(const Family& family, const Tiling& tiling) {
  if (family.holes_may_close) return;
  const double ratio = area(tiling.tiles[0]) / area(family.shape(presets(family)).tiles[0]);
  if (ratio < min_area_ratio) {
    std::ostringstream message;
    message << "The tile has " << 100 * ratio << " % of the default tile's area; the least allowed is "
            << 100 * min_area_ratio << " %.";
    throw TilingError("tiling.cell_too_small", "Family " + family.id + ": " + message.str(),
                      {{"parameters", message.str()}});
  }
}

}  // namespace

const std::vector<Family>& families() {
  static const std::vector<Family> all = make_families();
  return all;
}

const Family* find_family(std::string_view id) {
  const auto& all = families();
  const auto found = std::find_if(all.begin(), all.end(), [&](const Family& candidate) { return candidate.id == id; });
  return found == all.end() ? nullptr : &*found;
}

const Family& family(std::string_view id) {
  if (const Family* found = find_family(id)) return *found;
  std::string known;
  for (const Family& candidate : families()) known += (known.empty() ? "" : ", ") + candidate.id;
  throw FamilyNotFound("tiling.family_not_found",
                       "There is no family \"" + std::string(id) + "\"; known are " + known + ".",
                       {{"family", "must be one of " + known}});
}

std::vector<double> presets(const Family& family) {
  std::vector<double> result;
  result.reserve(family.parameters.size());
  for (const Parameter& parameter : family.parameters) result.push_back(parameter.preset);
  return result;
}

double beam_width_at(const Family& family, std::span<const double> parameters) {
  if (!family.definition) return family.beam_width;
  const AffineExpression& width = family.definition->beam_width;
  return width.slopes.empty() ? family.beam_width : width(parameters);
}

Family with_beam_width_factor(const Family& family, double factor) {
  Family changed = family;
  changed.beam_width *= factor;
  if (family.definition) {
    auto definition = *family.definition;
    definition.beam_width.constant *= factor;
    for (double& slope : definition.beam_width.slopes) slope *= factor;
    changed.definition = std::make_shared<const FamilyDefinition>(std::move(definition));
  }
  return changed;
}

Tiling tiling_of(const Family& family, std::span<const double> parameters, double box_margin) {
  check_bounds(family, parameters, box_margin);
  Tiling tiling = family.shape(parameters);
  check_area(family, tiling);
  return tiling;
}

}  // namespace supple::tiling
