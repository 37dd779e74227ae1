#include "supple/lab/dataset_options.h"

#include <array>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "supple/base/error.h"
#include "supple/base/number_text.h"
#include "supple/tiling/definition_text.h"

namespace supple::lab {
namespace {

using microscale::Law;
using microscale::Refinement;
using microscale::Switch;
using tiling::Region;

template <class T>
struct Name {
  T value;
  std::string_view name;
};
constexpr std::array<Name<Switch>, 3> switch_names{
    {{Switch::automatic, "automatic"}, {Switch::on, "on"}, {Switch::off, "off"}}};
constexpr std::array<Name<Region>, 3> region_names{
    {{Region::automatic, "automatic"}, {Region::tile, "tile"}, {Region::cell, "cell"}}};
constexpr std::array<Name<PlanKind>, 3> plan_names{
    {{PlanKind::sequence, "sequence"}, {PlanKind::grid, "grid"}, {PlanKind::rest, "rest"}}};
constexpr std::array<Name<Refinement>, 3> refinement_names{
    {{Refinement::off, "off"}, {Refinement::estimated, "estimated"}, {Refinement::extrapolated, "extrapolated"}}};
constexpr std::array<Name<Law>, 2> law_names{
    {{Law::neo_hookean, "neo_hookean"}, {Law::incompressible_plane_stress, "incompressible_plane_stress"}}};

template <class T, std::size_t n>
std::string name_of(const std::array<Name<T>, n>& names, T value) {
  for (const auto& each : names)
    if (each.value == value) return std::string(each.name);
  return {};
}

template <class T, std::size_t n>
void set_from(const dataset::Recipe& recipe, const char* setting, const std::array<Name<T>, n>& names, T& value) {
  const std::string& text = recipe.text(setting);
  for (const auto& each : names) {
    if (each.name == text) {
      value = each.value;
      return;
    }
  }
  throw Error("file.unreadable", "The setting " + std::string(setting) + " has the unknown value " + text + ".");
}

/// Writes each setting into a recipe.
struct RecipeWriter {
  dataset::Recipe recipe;

  void field(const char* name, int value, const char* unit = "") { recipe.set(name, std::int64_t{value}, unit); }
  void field(const char* name, std::uint64_t value) { recipe.set(name, static_cast<std::int64_t>(value)); }
  void field(const char* name, bool value) { recipe.set(name, std::int64_t{value}); }
  void field(const char* name, double value, const char* unit) { recipe.set(name, value, unit); }
  void field(const char* name, const std::string& value) { recipe.set(name, value); }
  void field(const char* name, const std::vector<double>& value) { recipe.set(name, value); }
  template <class T, std::size_t n>
  void field(const char* name, T value, const std::array<Name<T>, n>& names) {
    recipe.set(name, name_of(names, value));
  }
};

/// Reads each setting from a recipe.
struct RecipeReader {
  const dataset::Recipe& recipe;

  void field(const char* name, int& value, const char* = "") const { value = static_cast<int>(recipe.integer(name)); }
  void field(const char* name, std::uint64_t& value) const { value = static_cast<std::uint64_t>(recipe.integer(name)); }
  void field(const char* name, bool& value) const { value = recipe.integer(name) != 0; }
  void field(const char* name, double& value, const char*) const { value = recipe.number(name); }
  void field(const char* name, std::string& value) const { value = recipe.text(name); }
  void field(const char* name, std::vector<double>& value) const { value = recipe.numbers(name); }
  template <class T, std::size_t n>
  void field(const char* name, T& value, const std::array<Name<T>, n>& names) const {
    set_from(recipe, name, names, value);
  }
};

/// Visits the settings of a recipe, for a RecipeWriter or a RecipeReader. Their names are those in the files of data
/// sets, and differ from those of some options.
template <class Visitor, class Options>
void visit_settings(Visitor& visit, Options& options) {
  visit.field("family", options.family);
  visit.field("seed", options.seed);
  visit.field("box_margin", options.box_margin, "widths of the box");
  visit.field("corners", options.corners);
  visit.field("parameters", options.parameters);
  auto& loads = options.loads;
  visit.field("plan", loads.kind, plan_names);
  visit.field("tension_paths", loads.tension_paths);
  visit.field("compression_paths", loads.compression_paths);
  visit.field("biaxial_paths", loads.biaxial_paths);
  visit.field("tension_states", loads.tension_states);
  visit.field("compression_states", loads.compression_states);
  visit.field("biaxial_states", loads.biaxial_states);
  visit.field("largest_stretch", loads.max_stretch, "1");
  visit.field("smallest_stretch", loads.min_stretch, "1");
  visit.field("largest_biaxial_stretch", loads.max_biaxial_stretch, "1");
  visit.field("smallest_biaxial_stretch", loads.min_biaxial_stretch, "1");
  visit.field("first_strain", loads.first_strain, "1");
  auto& simulation = options.simulation;
  visit.field("law", simulation.material.law, law_names);
  visit.field("youngs_modulus", simulation.material.youngs_modulus, "MPa");
  visit.field("poisson_ratio", simulation.material.poisson_ratio, "1");
  visit.field("mesh_size", simulation.mesh.mesh_size, "beam widths");
  visit.field("corner_size", simulation.mesh.corner_size, "mesh sizes");
  visit.field("mesh_region", simulation.mesh.region, region_names);
  visit.field("max_nodes", simulation.mesh.max_nodes);
  visit.field("tolerance", simulation.tolerance, "1");
  visit.field("max_iterations", simulation.max_iterations);
  visit.field("max_load_step", simulation.max_load_step, "1");
  visit.field("contact", simulation.contact, switch_names);
  visit.field("patch", simulation.patch, switch_names);
  visit.field("buckling", simulation.buckling, switch_names);
  visit.field("tangents", simulation.tangents);
}

/// Checks the part of the box that the sequence of designs covers.
void check_part(const DatasetOptions& options, const tiling::Family& family, std::vector<Error::Detail>& details) {
  const std::size_t count = family.parameters.size();
  if (options.part_lower.empty() && options.part_upper.empty()) return;
  if (!options.parameters.empty()) details.push_back({"part_lower", "given parameters are one design, without a part"});
  for (const auto& [name, values] : {std::pair("part_lower", &options.part_lower), {"part_upper", &options.part_upper}})
    if (values->size() != count)
      details.push_back({name, "the family " + options.family + " has " + std::to_string(count) + " parameters, got " +
                                   std::to_string(values->size())});
  if (options.part_lower.size() != count || options.part_upper.size() != count) return;
  for (std::size_t k = 0; k < count; ++k) {
    const auto& [lower, upper, preset] = family.parameters[k];
    const double margin = options.box_margin * (upper - lower);
    const double from = options.part_lower[k];
    const double to = options.part_upper[k];
    // Bounds that are written as decimals may exceed the limits by a rounding error.
    const double tolerance = 1e-9 * (upper - lower);
    if (!(from >= lower - margin - tolerance && from < to && to <= upper + margin + tolerance))
      details.push_back({"part_lower[" + std::to_string(k) + "]",
                         "must be below part_upper, both within [" + number_text(lower - margin) + ", " +
                             number_text(upper + margin) + "], got " + number_text(from) + " and " + number_text(to)});
  }
}

void check_list(const DatasetOptions& options, const tiling::Family& family, std::vector<Error::Detail>& details) {
  if (options.list.empty()) {
    if (!options.directions.empty()) details.push_back({"directions", "belong to listed designs, and there are none"});
    return;
  }
  const std::size_t count = family.parameters.size();
  if (options.list.size() % count != 0) {
    details.push_back({"list", "the family " + options.family + " has " + std::to_string(count) +
                                   " parameters, of which " + std::to_string(options.list.size()) +
                                   " numbers are no multiple"});
    return;
  }
  const auto listed = static_cast<std::int64_t>(options.list.size() / count);
  if (options.first + options.designs > listed)
    details.push_back({"designs", "the list has " + std::to_string(listed) + ", but designs from " +
                                      std::to_string(options.first) + " to " +
                                      std::to_string(options.first + options.designs - 1) + " are asked for"});
  if (!options.directions.empty() && static_cast<std::int64_t>(options.directions.size()) != listed)
    details.push_back({"directions", "must be one for each of the " + std::to_string(listed) + " listed designs, got " +
                                         std::to_string(options.directions.size())});
  if (!options.parameters.empty() || !options.part_lower.empty() || !options.part_upper.empty())
    details.push_back({"list", "designs are either listed, or one, or those of a part"});
}

/// The index of a point of the sequence has 32 bits. Indices and numbers of designs above this limit are refused.
constexpr std::int64_t max_designs = 1'000'000'000;

}  // namespace

const tiling::Family& family_of(const DatasetOptions& options) {
  return options.own_family ? *options.own_family : tiling::family(options.family);
}

void check(const DatasetOptions& options) {
  std::vector<Error::Detail> details;
  const auto require = [&details](bool is_met, const char* where, std::string message) {
    if (!is_met) details.push_back({where, std::move(message)});
  };
  const auto& family = family_of(options);
  require(options.seed <= static_cast<std::uint64_t>(std::numeric_limits<std::int64_t>::max()), "seed",
          "must be below 2^63, got " + std::to_string(options.seed));
  require(options.first >= 0 && options.first <= max_designs, "first",
          "must lie within [0, 1000000000], got " + std::to_string(options.first));
  require(options.designs >= 1 && options.designs <= max_designs, "designs",
          "must lie within [1, 1000000000], got " + std::to_string(options.designs));
  require(options.shards >= 1, "shards", "must be at least 1, got " + std::to_string(options.shards));
  require(options.shard >= 0 && options.shard < options.shards, "shard",
          "must lie within [0, shards - 1], got " + std::to_string(options.shard) + " of " +
              std::to_string(options.shards));
  require(options.box_margin >= 0 && options.box_margin <= 0.5, "box_margin",
          "must lie within [0, 0.5], got " + number_text(options.box_margin));
  require(options.parameters.empty() || options.parameters.size() == family.parameters.size(), "parameters",
          "the family " + options.family + " has " + std::to_string(family.parameters.size()) + " parameters, got " +
              std::to_string(options.parameters.size()));
  require(options.parameters.empty() || (options.designs == 1 && options.first == 0), "parameters",
          "given parameters are one design: designs must be 1 and first 0");
  check_part(options, family, details);
  check_list(options, family, details);
  if (!details.empty())
    throw Error("dataset.invalid_option", details.front().where + " " + details.front().message + ".", details);
  check(options.loads);
}

dataset::Recipe recipe_of(const DatasetOptions& options) {
  RecipeWriter writer;
  visit_settings(writer, options);
  if (!options.part_lower.empty()) {
    writer.recipe.set("part_lower", options.part_lower);
    writer.recipe.set("part_upper", options.part_upper);
  }
  if (!options.list.empty()) writer.recipe.set("list", options.list);
  if (!options.directions.empty()) writer.recipe.set("directions", options.directions, "rad");
  if (options.simulation.refinement != Refinement::off)
    writer.field("refinement", options.simulation.refinement, refinement_names);
  // These settings follow from the family. If they change with a version, older data have another recipe.
  const auto& family = family_of(options);
  if (options.own_family) writer.recipe.set("definition", tiling::to_text(*family.definition));
  std::vector<double> lower;
  std::vector<double> upper;
  for (const auto& parameter : family.parameters) {
    lower.push_back(parameter.lower);
    upper.push_back(parameter.upper);
  }
  writer.recipe.set("lower_bounds", std::move(lower));
  writer.recipe.set("upper_bounds", std::move(upper));
  writer.recipe.set("beam_width", family.beam_width, "tiling units");
  writer.recipe.set("printed_beam_width", tiling::printed_beam_width, "mm");
  return std::move(writer.recipe);
}

DatasetOptions options_of(const dataset::Recipe& recipe, const dataset::Selection& selection) {
  DatasetOptions options;
  const RecipeReader reader{recipe};
  visit_settings(reader, options);
  if (recipe.has("part_lower")) {
    reader.field("part_lower", options.part_lower);
    reader.field("part_upper", options.part_upper);
  }
  if (recipe.has("list")) reader.field("list", options.list);
  if (recipe.has("directions")) reader.field("directions", options.directions);
  if (recipe.has("definition")) options.own_family = tiling::family_of(options.family, recipe.text("definition"));
  if (recipe.has("refinement")) reader.field("refinement", options.simulation.refinement, refinement_names);
  options.first = selection.first;
  options.designs = selection.count;
  options.shard = selection.shard;
  options.shards = selection.shards;
  return options;
}

DatasetOptions rest_options() {
  DatasetOptions options;
  options.loads.kind = PlanKind::rest;
  // Without a load, structures neither buckle nor touch themselves.
  options.simulation.contact = Switch::off;
  options.simulation.patch = Switch::off;
  options.simulation.buckling = Switch::off;
  options.designs = 20'000;
  return options;
}

dataset::Selection selection_of(const DatasetOptions& options) {
  return {options.first, options.designs, options.shard, options.shards};
}

}  // namespace supple::lab
