#include "kept_atlases.h"

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <string>

#include "supple/tiling/family_definition.h"
#include "support/temporary_folder.h"

namespace supple::routes {
namespace {

namespace fs = std::filesystem;

KeptAtlases::Definition definition(double upper) {
  auto changed = *tiling::family("IH21").definition;
  changed.id = "mine";
  changed.parameters[0].range.upper = upper;
  return std::make_shared<const tiling::FamilyDefinition>(std::move(changed));
}

json::AtlasRecord record_of(const KeptAtlases::Definition& of) {
  design::FamilyAtlas atlas;
  atlas.family = of->id;
  for (const auto& parameter : of->parameters) atlas.bounds.push_back(parameter.range);
  atlas.mesh_size = 1;
  atlas.samples = {{.parameters = {0.1, 0.6}, .place = design::AtlasPlace::closed, .compliance = {}, .error = {}}};
  return json::make_atlas_record(std::move(atlas), of, {});
}

TEST(KeptAtlases, OfAddedFamiliesAreFoundByTheDefinitionAlone) {
  const testing::TemporaryFolder folder;
  KeptAtlases kept("", folder.path());
  const auto one = definition(0.2), other = definition(0.21);
  EXPECT_FALSE(kept.find_added(one));
  kept.keep_added(record_of(one));
  EXPECT_FALSE(kept.find_added(other));
  EXPECT_FALSE(kept.find("mine", one));
  const auto found = KeptAtlases("", folder.path()).find_added(definition(0.2));
  ASSERT_TRUE(found);
  EXPECT_EQ(found->atlas.bounds[0].upper, 0.2);
}

TEST(KeptAtlases, TheOldestOfAddedFamiliesMakeRoom) {
  const testing::TemporaryFolder folder;
  KeptAtlases kept("", folder.path());
  const auto oldest = definition(0.2), newest = definition(0.21);
  kept.keep_added(record_of(oldest));
  const auto added = folder.path() / "added";
  const auto begin = fs::file_time_type::clock::now() - std::chrono::hours(1);
  fs::last_write_time(fs::directory_iterator(added)->path(), begin);
  for (std::size_t k = 1; k < KeptAtlases::max_added; ++k) {
    const auto path = added / (std::to_string(k) + ".json");
    std::ofstream(path) << "{}";
    fs::last_write_time(path, begin + std::chrono::seconds(k));
  }
  EXPECT_TRUE(kept.find_added(oldest));
  kept.keep_added(record_of(newest));
  EXPECT_FALSE(kept.find_added(oldest));
  EXPECT_TRUE(kept.find_added(newest));
  EXPECT_EQ(std::distance(fs::directory_iterator(added), {}), static_cast<std::ptrdiff_t>(KeptAtlases::max_added));
}

}  // namespace
}  // namespace supple::routes
