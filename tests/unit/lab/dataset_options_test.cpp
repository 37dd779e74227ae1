#include "supple/lab/dataset_options.h"

#include <gtest/gtest.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/lab/design_sequence.h"
#include "supple/tiling/family_definition.h"

namespace supple::lab {
namespace {

DatasetOptions usual() {
  DatasetOptions options;
  options.family = "IH21";
  return options;
}

TEST(DatasetOptions, ComeBackFromTheRecipeTheyBecame) {
  DatasetOptions options = usual();
  options.seed = 12345;
  options.first = 10;
  options.designs = 20;
  options.shard = 1;
  options.shards = 3;
  options.corners = false;
  options.loads.kind = PlanKind::grid;
  options.loads.max_stretch = 1.3;
  options.simulation.mesh.mesh_size = 0.77;
  options.simulation.contact = microscale::Switch::off;
  options.simulation.material.law = microscale::Law::incompressible_plane_stress;
  options.simulation.tangents = false;
  options.part_lower = {0.11, 0.5};
  options.part_upper = {0.12, 0.6};
  const auto recipe = recipe_of(options);
  const DatasetOptions back = options_of(recipe, selection_of(options));
  EXPECT_EQ(recipe_of(back), recipe);
  EXPECT_EQ(selection_of(back), selection_of(options));
  EXPECT_EQ(back.loads.max_stretch, 1.3);
  EXPECT_EQ(back.simulation.contact, microscale::Switch::off);
  EXPECT_EQ(back.simulation.material.law, microscale::Law::incompressible_plane_stress);
  EXPECT_FALSE(back.simulation.tangents);
  EXPECT_EQ(back.part_upper, options.part_upper);
}

TEST(DatasetOptions, ComeBackFromTheRecipeWithAFamilyOfOnesOwn) {
  EXPECT_FALSE(recipe_of(usual()).has("definition"));
  auto definition = *tiling::family("IH21").definition;
  definition.id = "own";
  definition.parameters[0].range.lower = 0.12;
  definition.parameters[0].range.preset = 0.13;
  definition.beam_width = {0.01, 0.2, 0.05};
  DatasetOptions options;
  options.family = "own";
  options.own_family = std::make_shared<const tiling::Family>(tiling::make_family(definition));
  check(options);
  const DatasetOptions back = options_of(recipe_of(options), selection_of(options));
  EXPECT_EQ(*family_of(back).definition, definition);
  EXPECT_EQ(recipe_of(back), recipe_of(options));
  EXPECT_GE(planned_design(back, 4).parameters[0], 0.12 - back.box_margin * 0.1)
      << "within the bounds of the definition";
  dataset::Recipe damaged;
  const auto recipe = recipe_of(options);
  for (const auto& setting : recipe.settings())
    damaged.set(setting.name,
                setting.name == "definition" ? dataset::Recipe::Value(std::string("none")) : setting.value,
                setting.unit);
  EXPECT_THROW((void)options_of(damaged, selection_of(options)), Error);
}

TEST(DatasetOptions, ComeBackFromTheRecipeWithAListAndARefinement) {
  DatasetOptions options = usual();
  options.list = {0.11, 0.6, 0.15, 0.7};
  options.directions = {0.5, 3};
  options.designs = 2;
  options.simulation.refinement = microscale::Refinement::extrapolated;
  check(options);
  const DatasetOptions back = options_of(recipe_of(options), selection_of(options));
  EXPECT_EQ(recipe_of(back), recipe_of(options));
  EXPECT_EQ(back.list, options.list);
  EXPECT_EQ(back.directions, options.directions);
  EXPECT_EQ(back.simulation.refinement, microscale::Refinement::extrapolated);
}

TEST(DatasetOptions, MakeTheRecipeNameBoundsAndBeamWidthOfTheFamily) {
  const auto recipe = recipe_of(usual());
  EXPECT_EQ(recipe.numbers("lower_bounds"), (std::vector<double>{0.105, 0.505}));
  EXPECT_EQ(recipe.numbers("upper_bounds"), (std::vector<double>{0.195, 0.795}));
  EXPECT_EQ(recipe.number("beam_width"), 0.0641);
}

TEST(DatasetOptions, WithoutLaterOptionsHaveTheRecipeOfDataFromBeforeThem) {
  for (const auto* setting : {"part_lower", "list", "directions", "refinement"})
    EXPECT_FALSE(recipe_of(usual()).has(setting));
}

TEST(DatasetOptions, OfAnotherShardOrLengthHaveTheSameRecipe) {
  DatasetOptions other = usual();
  other.designs = 7;
  other.first = 3;
  other.shards = 2;
  other.shard = 1;
  EXPECT_EQ(recipe_of(other), recipe_of(usual()));
}

TEST(DatasetOptions, OutOfRangeAreRefusedByName) {
  const std::vector<std::pair<std::string, std::function<void(DatasetOptions&)>>> faults{
      {"designs", [](auto& o) { o.designs = 0; }},
      {"first", [](auto& o) { o.first = -1; }},
      {"seed", [](auto& o) { o.seed = ~std::uint64_t{0}; }},
      {"shards", [](auto& o) { o.shards = 0; }},
      {"shard", [](auto& o) { o.shard = 1; }},
      {"box_margin", [](auto& o) { o.box_margin = 0.6; }},
      {"parameters", [](auto& o) { o.parameters = {0.1}; }},
      {"list",
       [](auto& o) {
         o.list = {0.11, 0.6, 0.15}, o.designs = 1;
       }},
      {"designs",
       [](auto& o) {
         o.list = {0.11, 0.6}, o.designs = 2;
       }},
      {"directions",
       [](auto& o) {
         o.list = {0.11, 0.6}, o.designs = 1, o.directions = {1, 2};
       }},
      {"directions", [](auto& o) { o.directions = {1}; }},
      {"list",
       [](auto& o) {
         o.list = {0.11, 0.6}, o.designs = 1, o.parameters = {0.11, 0.6};
       }},
      {"part_upper",
       [](auto& o) {
         o.part_lower = {0.11, 0.5};
       }},
      {"part_lower[1]",
       [](auto& o) {
         o.part_lower = {0.11, 0.6}, o.part_upper = {0.12, 0.6};
       }},
      {"part_lower[0]",
       [](auto& o) {
         o.part_lower = {0.1, 0.5}, o.part_upper = {0.12, 0.6};
       }},
      {"first_strain", [](auto& o) { o.loads.first_strain = 0.1; }}};
  for (const auto& [name, spoil] : faults) {
    DatasetOptions options = usual();
    spoil(options);
    try {
      check(options);
      ADD_FAILURE() << name << " was accepted";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), "dataset.invalid_option");
      ASSERT_FALSE(error.details().empty());
      EXPECT_EQ(error.details().front().where, name);
    }
  }
}

TEST(DatasetOptions, OfAnUnknownFamilyAreRefused) {
  DatasetOptions options;
  options.family = "IH99";
  try {
    check(options);
    FAIL() << "accepted";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "tiling.family_not_found");
  }
}

}  // namespace
}  // namespace supple::lab
