#include "supple/json/family_atlases.h"

#include <gtest/gtest.h>

#include "supple/tiling/family_definition.h"
#include "support/expect_error.h"

namespace supple::json {
namespace {

using Definition = std::shared_ptr<const tiling::FamilyDefinition>;
using Pointers = std::vector<std::string>;

Definition ih21() { return tiling::family("IH21").definition; }

AtlasRecord record() {
  design::FamilyAtlas atlas;
  atlas.family = "IH21";
  atlas.bounds = tiling::family("IH21").parameters;
  atlas.mesh_size = 1;
  design::AtlasSample solved{.parameters = {0.1, 0.6},
                             .compliance = design::Compliance::Identity() * 0.25,
                             .relative_density = 0.3,
                             .error = 0.002};
  atlas.samples = {solved,
                   {.parameters = {0.2, 0.7}, .place = design::AtlasPlace::closed, .compliance = {}, .error = {}}};
  atlas.profiles = {{"poisson_0", 0, {.deviation = 0.5, .orientation = 0.25, .is_met = false}}};
  atlas.warnings = {{.flaw = tiling::DefinitionFlaw::crossing,
                     .where = "tile",
                     .message = "crosses itself",
                     .parameters = {0.2, 0.7},
                     .point = Eigen::Vector2d(1, 2)}};
  return make_atlas_record(std::move(atlas), ih21(), {});
}

TEST(FamilyAtlases, AreReadAsTheyWereWritten) {
  const std::string text = write_family_atlas(record(), nullptr, true);
  const auto read = read_family_atlas(text, ih21());
  ASSERT_TRUE(read);
  EXPECT_EQ(write_family_atlas(*read, nullptr, true), text);
  EXPECT_EQ(read->atlas.samples[0].compliance.value(), record().atlas.samples[0].compliance.value());
  EXPECT_EQ(read->atlas.count(design::AtlasPlace::closed), 1U);
  EXPECT_EQ(read->atlas.warnings[0].where, "tile");
}

TEST(FamilyAtlases, OfAnotherDefinitionOrBrokenHoldNoLonger) {
  const std::string text = write_family_atlas(record(), nullptr, true);
  auto changed = *ih21();
  changed.parameters[0].range.upper += 0.01;
  EXPECT_FALSE(read_family_atlas(text, std::make_shared<const tiling::FamilyDefinition>(changed)));
  EXPECT_FALSE(read_family_atlas(text, nullptr));
  EXPECT_FALSE(read_family_atlas(text.substr(0, text.size() / 2), ih21()));
  EXPECT_FALSE(read_family_atlas("{}", ih21()));
}

TEST(FamilyAtlases, AreAskedForByOneOfThreeFields) {
  const auto parsed = [](const char* body) { return parse_family_atlas_request(body, {}); };
  EXPECT_EQ(parsed(R"({"family":"IH21"})").crossings, std::nullopt);
  EXPECT_EQ(parsed(R"({"isohedral_type":21,"crossings":true})").crossings, true);
  EXPECT_EQ(parsed(R"({"family":"IH21","crossings":false})").crossings, false);
  // Few samples have no more errors than samples.
  EXPECT_EQ(parsed(R"({"family":"IH21","samples":3})").options.error_samples, 3);
  const auto faults = [&](const char* body) {
    return testing::places(testing::expect_error("request.invalid", [&] { parsed(body); }));
  };
  EXPECT_EQ(faults(R"({})"), Pointers{""});
  EXPECT_EQ(faults(R"({"isohedral_type":19})"), Pointers{"/isohedral_type"});
  EXPECT_EQ(faults(R"({"family":"IH21","isohedral_type":21})"), Pointers{""});
  EXPECT_EQ(faults(R"({"family":"IH21","samples":5000})"), Pointers{"/samples"});
}

}  // namespace
}  // namespace supple::json
