#include "supple/json/family_definitions.h"

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>

#include "support/expect_error.h"

namespace supple::json {
namespace {

using tiling::EdgeSymmetry;
using tiling::FamilyDefinition;
using Pointers = std::vector<std::string>;

std::string file_of(const std::string& id) {
  std::string name = id;
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  std::ifstream file(std::string(SUPPLE_SOURCE_DIR) + "/models/families/" + name + ".json");
  EXPECT_TRUE(file.good()) << name;
  return {std::istreambuf_iterator<char>(file), {}};
}

// A definition of a square whose fields can be replaced: the text after "parameters" is given.
std::string square_definition(const std::string& fields) {
  return R"({"id":"own","description":"A square","parameters":[{"description":"bend","lower":-0.2,"upper":0.2,"default":0.1}],)" +
         fields + "}";
}

constexpr const char* square_tile =
    R"("beam_width":0.1,"tile":{"vertices":[[0,0],[1,0],[1,1],[0,1]],"edges":[{"shape":0},{"shape":1},{"shape":0,"turned":true,"mirrored":true},{"shape":1}],)"
    R"("translations":[[1,0],[0,1]],"placements":[{"linear":[1,0,0,1],"offset":[0,0]}]})";

Pointers faults_of(const std::string& text) {
  return testing::places(testing::expect_error("request.invalid", [&] { parse_family_definition(text, {}); }));
}

TEST(FamilyDefinitions, OfTheFilesAreTheBuiltInOnesAndRoundTrip) {
  ASSERT_EQ(tiling::shipped_definitions().size(), 7u);
  for (const FamilyDefinition& built_in : tiling::shipped_definitions()) {
    const FamilyDefinition read = parse_family_definition(file_of(built_in.id), {});
    EXPECT_EQ(read, built_in) << built_in.id;
    EXPECT_EQ(parse_family_definition(write_family_definition(read), {}), read) << built_in.id;
  }
}

TEST(FamilyDefinitions, WithCurvesAndAVaryingWidthRoundTrip) {
  const auto definition = parse_family_definition(
      R"({"id":"curved","description":"Pentagons with curved sides","parameters":[)"
      R"({"description":"height","lower":0.15,"upper":0.63,"default":0.36},{"description":"arch","lower":-0.26,"upper":0.31,"default":0},)"
      R"({"description":"wave","lower":-0.34,"upper":0.35,"default":0},{"description":"width","lower":0.04,"upper":0.2,"default":0.1}],)"
      R"("beam_width":[0,0,0,0,1],"mesh_size":1,"isohedral_type":29,)"
      R"("shapes":[{"class":"I"},{"class":"J","sines":[[0,0,1],[0,0,0,1]],"pieces":24}]})",
      {});
  EXPECT_EQ(definition.isohedral_type, 29);
  EXPECT_EQ(definition.tile.vertices.size(), 5u);
  EXPECT_EQ(definition.sufficient_mesh_size, 1);
  EXPECT_EQ(definition.beam_width(std::vector{0.3, 0.0, 0.0, 0.07}), 0.07);
  const auto& curve = std::get<tiling::SineEdge>(definition.shapes[1].line);
  EXPECT_EQ(curve.pieces, 24);
  EXPECT_EQ(curve.sines[1](std::vector{0.3, 0.1, 0.2, 0.07}), 0.2);
  EXPECT_EQ(parse_family_definition(write_family_definition(definition), {}), definition);
}

TEST(FamilyDefinitions, OfATypeWithoutShapesHaveStraightEdgesOfItsClasses) {
  const auto definition = parse_family_definition(
      R"({"id":"IH12x","description":"","parameters":[{"description":"","lower":0.1,"upper":0.3,"default":0.2},)"
      R"({"description":"","lower":0.1,"upper":0.3,"default":0.2}],"beam_width":0.05,"isohedral_type":12})",
      {});
  ASSERT_EQ(definition.shapes.size(), 2u);
  EXPECT_EQ(definition.shapes[0].symmetry, EdgeSymmetry::mirror_symmetric);
  EXPECT_EQ(definition.shapes[1].symmetry, EdgeSymmetry::any);
}

TEST(FamilyDefinitions, ReadAndWriteTilesOfOnesOwn) {
  const auto definition = parse_family_definition(
      square_definition(std::string(square_tile) + R"(,"shapes":[{"class":"U","points":[[0.5,[0,1]]]},{"class":"I"}])"),
      {});
  EXPECT_EQ(definition.isohedral_type, 0);
  EXPECT_EQ(definition.tile.edges[2], (tiling::TileEdge{0, true, true}));
  EXPECT_EQ(definition.tile.edges[1], (tiling::TileEdge{1, false, false}));
  EXPECT_EQ(definition.sufficient_mesh_size, tiling::default_mesh_size);
  EXPECT_EQ(std::get<tiling::PolylineEdge>(definition.shapes[0].line).points[0].y(std::vector{0.2}), 0.2);
  EXPECT_EQ(parse_family_definition(write_family_definition(definition), {}), definition);
}

TEST(FamilyDefinitions, PointToEachFieldAtFault) {
  EXPECT_EQ(faults_of(square_definition(R"("beam_width":[0,1,2],"isohedral_type":19)")),
            (Pointers{"/beam_width", "/isohedral_type"}));
  EXPECT_EQ(faults_of(square_definition(R"("beam_width":0.1)")), Pointers{"/tile"});
  EXPECT_EQ(faults_of(square_definition(std::string(square_tile) + R"(,"isohedral_type":12)")), Pointers{"/tile"});
  EXPECT_EQ(faults_of(square_definition(std::string(square_tile) +
                                        R"(,"shapes":[{"class":"K"},{"points":[[0.5,0]],"sines":[1],"class":"J"}])")),
            (Pointers{"/shapes/0/class", "/shapes/1"}));
  EXPECT_EQ(faults_of(square_definition(
                R"("beam_width":"thin","tile":{"vertices":[[0,0],[1],[1,[]],[0,[0,1e7]]],"translations":[[1,0],[0,1]],)"
                R"("placements":[{"linear":[1,0,0,2],"offset":[0,0],"scale":2}]})")),
            (Pointers{"/beam_width", "/tile/vertices/1", "/tile/vertices/2/1", "/tile/vertices/3/1/1",
                      "/tile/placements/0/linear/3", "/tile/placements/0/scale"}));
}

}  // namespace
}  // namespace supple::json
