#include "supple/json/structure_answers.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace supple::json {
namespace {

using nlohmann::json;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();
constexpr double infinite = std::numeric_limits<double>::infinity();

/// Two triangles with a common side that fill the periodic unit square: one corner node, three midpoints.
tiling::PeriodicMesh unit_square() {
  tiling::PeriodicMesh mesh;
  mesh.lattice.setIdentity();
  mesh.nodes.resize(2, 4);
  mesh.nodes << 0, 0.5, 0, 0.5,  //
      0, 0, 0.5, 0.5;
  mesh.triangles = {{0, 0, 0, 1, 2, 3}, {0, 0, 0, 3, 1, 2}};
  mesh.shifts = {{{{0, 0}, {1, 0}, {1, 1}, {0, 0}, {1, 0}, {0, 0}}},
                 {{{0, 0}, {1, 1}, {0, 1}, {0, 0}, {0, 1}, {0, 0}}}};
  return mesh;
}

tiling::Structure reflected_tile() {
  tiling::Structure structure;
  structure.family = "IH01";
  structure.parameters = {0.1};
  structure.tiling.tiles = {{{0, 0}, {2, 0}, {0, 1}}};
  structure.tiling.placements = {{0, Eigen::Vector2d(-1, 1).asDiagonal(), {5, 0}}};
  structure.tiling.lattice << 1, 3, 2, 4;
  structure.holes = {{{{4.5, 0.5}, {4, 0.25}, {4.5, 0.25}}}};  // the hole of the placement, in coordinates of the plane
  structure.cell_area = 4;
  structure.solid_area = 1;
  return structure;
}

microscale::State state_of(const std::shared_ptr<const tiling::PeriodicMesh>& mesh) {
  microscale::State state;
  state.smallest_gap = infinite;
  state.deformed = microscale::DeformedMesh{mesh, 2 * mesh->lattice, 2 * mesh->nodes};
  return state;
}

json simulation_answer(const SimulationRequest& request, const microscale::SimulationResult& result) {
  return json::parse(write_simulation(request, reflected_tile(), unit_square(), result, {}));
}

TEST(StructureAnswers, PlaceTilesAndKeepThemCounterclockwise) {
  const auto answer = json::parse(write_structure(reflected_tile(), nullptr, nullptr, {}));
  EXPECT_EQ(answer["tiles"][0]["outline"], (json{{5, 1}, {3, 0}, {5, 0}}));
  EXPECT_EQ(answer["tiles"][0]["holes"], (json{{{4.5, 0.5}, {4, 0.25}, {4.5, 0.25}}}));
  EXPECT_EQ(answer["lattice"], (json{{1, 2}, {3, 4}})) << "each translation is one entry";
  EXPECT_EQ(answer["relative_density"], 0.25);
  EXPECT_FALSE(answer.contains("mesh"));
  EXPECT_FALSE(answer.contains("svg"));
}

TEST(SimulationAnswers, SayNullWhereAStateHasNoNumber) {
  microscale::SimulationResult result;
  result.states.resize(1);
  result.states[0].residual = not_a_number;
  result.states[0].smallest_gap = infinite;
  const auto answer = simulation_answer({}, result);
  const auto& state = answer["states"][0];
  EXPECT_TRUE(state["tangent"].is_null());
  EXPECT_TRUE(state["residual"].is_null());
  EXPECT_TRUE(state["smallest_gap"].is_null());
  EXPECT_TRUE(answer["accuracy"]["residual"].is_null());
  EXPECT_FALSE(answer.contains("meshes"));
}

TEST(SimulationAnswers, RefuseAStressThatIsNotFinite) {
  microscale::SimulationResult result;
  result.states.resize(1);
  result.states[0].stress[1] = not_a_number;
  try {
    simulation_answer({}, result);
    FAIL() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "computation.non_finite");
  }
}

TEST(SimulationAnswers, ReportTheWorstResidual) {
  microscale::SimulationResult result;
  result.states.resize(3);
  result.states[1].residual = 0.25;
  result.states[2].residual = 0.125;
  EXPECT_EQ(simulation_answer({}, result)["accuracy"]["residual"], 0.25);
}

TEST(SimulationAnswers, UnwrapDeformedPatchesAndWriteEachMeshOnce) {
  const auto mesh = std::make_shared<const tiling::PeriodicMesh>(unit_square());
  microscale::SimulationResult result;
  result.states = {state_of(mesh), state_of(mesh)};
  SimulationRequest request;
  request.deformed = Deformed::json;
  const auto answer = simulation_answer(request, result);
  ASSERT_EQ(answer["meshes"].size(), 1U);
  const auto& rest = answer["meshes"][0];
  // The corners of the square, the midpoints of its sides and the middle of the diagonal.
  EXPECT_EQ(rest["points"].size(), 9U);
  EXPECT_EQ(rest["triangles"].size(), 2U);
  for (const auto& state : answer["states"]) {
    EXPECT_EQ(state["deformed"]["mesh"], 0);
    EXPECT_EQ(state["deformed"]["lattice"], (json{{2, 0}, {0, 2}}));
    for (std::size_t i = 0; i < 9; ++i) {
      for (std::size_t k = 0; k < 2; ++k) {
        EXPECT_EQ(state["deformed"]["points"][i][k], 2 * rest["points"][i][k].get<double>());
      }
    }
  }
  for (const auto& triangle : rest["triangles"]) {
    for (int side = 0; side < 3; ++side) {
      for (std::size_t k = 0; k < 2; ++k) {
        const auto at = [&](int corner) {
          return rest["points"][triangle[static_cast<std::size_t>(corner)].get<std::size_t>()][k].get<double>();
        };
        EXPECT_EQ(at(3 + side), (at(side) + at((side + 1) % 3)) / 2);
      }
    }
  }
}

TEST(SimulationAnswers, WriteAVtuForEachStateWhereItWasAskedFor) {
  const auto mesh = std::make_shared<const tiling::PeriodicMesh>(unit_square());
  microscale::SimulationResult result;
  result.states = {state_of(mesh)};
  SimulationRequest request;
  request.deformed = Deformed::vtu;
  const auto answer = simulation_answer(request, result);
  const auto vtu = answer["states"][0]["vtu"].get<std::string>();
  EXPECT_NE(vtu.find("NumberOfPoints=\"9\" NumberOfCells=\"2\""), std::string::npos) << vtu;
  EXPECT_FALSE(answer.contains("meshes"));
  EXPECT_FALSE(answer["states"][0].contains("deformed"));
}

}  // namespace
}  // namespace supple::json
