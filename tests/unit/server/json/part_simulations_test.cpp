#include "supple/json/part_simulations.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "support/expect_error.h"

namespace supple::json {
namespace {

using microscale::Clamp;
using microscale::Plate;
using nlohmann::json;
using Pointers = std::vector<std::string>;

const std::string part_of_sheet = R"("part":{"outline":{"rectangle":[20,30]},"structure":{"family":"IH21"}})";
const std::string part_of_block =
    R"("part":{"outline":{"block":{"width":20,"height":30,"plate":2}},"structure":{"family":"IH21"}})";
const std::string part_of_coupon =
    R"("part":{"outline":{"coupon":{"width":12,"length":30,"grip_length":8}},"structure":{"family":"IH21"},"thickness":3})";

PartSimulationRequest read_simulation(const std::string& fields) {
  return parse_part_simulation("{" + fields + "}", {});
}

Pointers faults_of_part_simulation(const std::string& fields) {
  return testing::places(testing::expect_error("request.invalid", [&] { read_simulation(fields); }));
}
Pointers faults_of_support(const std::string& support) {
  return faults_of_part_simulation(part_of_sheet + R"(,"supports":[)" + support + "]");
}

TEST(PartSimulationRequests, ReadEveryField) {
  const auto request =
      read_simulation(part_of_sheet +
                      R"(,"material":{"law":"incompressible_plane_stress","youngs_modulus":2,"poisson_ratio":0.3},
          "supports":[{"kind":"clamp","box":[[-1,-2],[21,1]]},
                      {"kind":"plate","side":"top","gap":0.5,"friction":"stick","displacement":[1,-3]}],
          "states":7,"deformed":"vtu","svg":true,
          "accuracy":{"mesh_size":1,"corner_size":0.5,"tolerance":1e-6,"max_iterations":30,"max_load_step":0.1,"pressure_length":2},
          "effects":{"contact":"off","buckling":"on","error_estimate":"off"},"deadline":9)");
  EXPECT_EQ(request.part.filling.structure.family, "IH21");
  EXPECT_FALSE(request.has_default_supports);
  ASSERT_EQ(request.supports.size(), 2U);
  const auto& clamp = std::get<Clamp>(request.supports[0]);
  EXPECT_EQ(clamp.lower, Eigen::Vector2d(-1, -2));
  EXPECT_EQ(clamp.upper, Eigen::Vector2d(21, 1));
  EXPECT_EQ(clamp.displacement, Eigen::Vector2d(0, 0));
  const auto& plate = std::get<Plate>(request.supports[1]);
  EXPECT_EQ(plate.side, microscale::Side::top);
  EXPECT_EQ(plate.gap, 0.5);
  EXPECT_EQ(plate.friction, microscale::Friction::stick);
  EXPECT_EQ(plate.displacement, Eigen::Vector2d(1, -3));
  const auto& options = request.options;
  EXPECT_EQ(options.material.law, microscale::Law::incompressible_plane_stress);
  EXPECT_EQ(options.material.youngs_modulus, 2);
  EXPECT_EQ(options.states, 7);
  EXPECT_EQ(options.tolerance, 1e-6);
  EXPECT_EQ(options.max_iterations, 30);
  EXPECT_EQ(options.max_load_step, 0.1);
  EXPECT_EQ(options.pressure_length, 2);
  EXPECT_EQ(options.contact, Switch::off);
  EXPECT_EQ(options.buckling, Switch::on);
  EXPECT_TRUE(options.deformed_nodes);
  EXPECT_EQ(request.mesh.mesh_size, 1);
  EXPECT_EQ(request.mesh.corner_size, 0.5);
  EXPECT_EQ(request.error_estimate, Switch::off);
  EXPECT_EQ(request.deformed, DeformedPart::vtu);
  EXPECT_TRUE(request.svg);
  EXPECT_EQ(request.deadline, 9);
}

TEST(PartSimulationRequests, PressABlockBetweenPlatesByDefault) {
  const auto request = read_simulation(part_of_block);
  EXPECT_TRUE(request.has_default_supports);
  ASSERT_EQ(request.supports.size(), 2U);
  EXPECT_EQ(std::get<Plate>(request.supports[0]).side, microscale::Side::bottom);
  const auto& top = std::get<Plate>(request.supports[1]);
  EXPECT_EQ(top.side, microscale::Side::top);
  EXPECT_EQ(top.friction, microscale::Friction::none);
  EXPECT_EQ(top.displacement, Eigen::Vector2d(0, -0.2 * 30));
  const auto less = read_simulation(part_of_block + R"(,"strain":-0.05)");
  EXPECT_EQ(std::get<Plate>(less.supports[1]).displacement, Eigen::Vector2d(0, -1.5));
  EXPECT_FALSE(request.options.deformed_nodes);
}

TEST(PartSimulationRequests, StretchACouponBetweenItsGripsByDefault) {
  const auto request = read_simulation(part_of_coupon + R"(,"strain":0.1)");
  ASSERT_EQ(request.supports.size(), 2U);
  const auto& lower = std::get<Clamp>(request.supports[0]);
  const auto& upper = std::get<Clamp>(request.supports[1]);
  EXPECT_TRUE(lower.upper.isApprox(Eigen::Vector2d(12, 8), 1e-6));
  EXPECT_GE(lower.upper.y(), 8);
  EXPECT_LE(upper.lower.y(), 38);
  EXPECT_TRUE(upper.upper.isApprox(Eigen::Vector2d(12, 46), 1e-6));
  EXPECT_NEAR(upper.displacement.y(), 3, 1e-12);
  EXPECT_EQ(request.options.thickness, 3);
}

TEST(PartSimulationRequests, NeedSupportsForOtherOutlines) {
  EXPECT_EQ(faults_of_part_simulation(part_of_sheet), Pointers{"/supports"});
  EXPECT_EQ(faults_of_part_simulation(part_of_sheet + R"(,"strain":0.1)"), Pointers{"/supports"});
  EXPECT_EQ(faults_of_part_simulation(part_of_block + R"(,"strain":0.1)"), Pointers{"/strain"});
  EXPECT_EQ(faults_of_part_simulation(part_of_block + R"(,"strain":-0.1,"supports":[{"kind":"plate","side":"top"}])"),
            Pointers{"/strain"});
  EXPECT_EQ(faults_of_part_simulation(R"("states":3)"), Pointers{"/part"});
}

TEST(PartSimulationRequests, PointToFieldsOfThePart) {
  EXPECT_EQ(faults_of_part_simulation(
                R"("part":{"outline":{"block":{"width":20}},"structure":{"family":"IH21"},"axis":1,"material":{}})"),
            (Pointers{"/part/outline/block/height", "/part/axis", "/part/material"}));
  EXPECT_EQ(faults_of_part_simulation(R"("part":{"outline":{"regions":true},"structure":{"family":"IH21"}},)"
                                      R"("supports":[{"kind":"plate","side":"top"}])"),
            Pointers{"/part/outline/regions"});
}

TEST(PartSimulationRequests, PointToTheSupportAtFault) {
  EXPECT_EQ(faults_of_support(R"({"kind":"plate"})"), Pointers{"/supports/0/side"});
  EXPECT_EQ(faults_of_support(R"({"kind":"plate","side":"up"})"), Pointers{"/supports/0/side"});
  EXPECT_EQ(faults_of_support(R"({"kind":"plate","side":"top","gap":-1})"), Pointers{"/supports/0/gap"});
  EXPECT_EQ(faults_of_support(R"({"kind":"plate","side":"top","box":[[0,0],[1,1]]})"), Pointers{"/supports/0/box"});
  EXPECT_EQ(faults_of_support(R"({"kind":"clamp"})"), Pointers{"/supports/0/box"});
  EXPECT_EQ(faults_of_support(R"({"kind":"clamp","box":[[0,0],[1]]})"), Pointers{"/supports/0/box/1"});
  EXPECT_EQ(faults_of_support(R"({"kind":"clamp","box":[[0,0],[1,1]],"displacement":[0]})"),
            Pointers{"/supports/0/displacement"});
  EXPECT_EQ(faults_of_support(R"({"kind":"glue"})").front(), "/supports/0/kind");
  EXPECT_EQ(faults_of_part_simulation(part_of_sheet + R"(,"supports":[])"), Pointers{"/supports"});
}

/// A part of one quadratic triangle.
tiling::PeriodicMesh single_triangle() {
  tiling::PeriodicMesh mesh;
  mesh.lattice = 4 * Eigen::Matrix2d::Identity();
  mesh.nodes.resize(2, 6);
  mesh.nodes << 0, 1, 0, 0.5, 0.5, 0,  //
      0, 0, 1, 0, 0.5, 0.5;
  mesh.triangles = {{0, 1, 2, 3, 4, 5}};
  mesh.shifts.resize(1);
  mesh.mesh_size = 1;
  return mesh;
}

microscale::PartSimulationResult part_result(const tiling::PeriodicMesh& mesh) {
  microscale::PartSimulationResult result;
  result.nodes = static_cast<int>(mesh.nodes.cols());
  result.states.resize(2);
  for (auto& state : result.states) {
    state.fraction = 0.5;
    state.residual = 1e-9;
    state.displacements = 0.1 * mesh.nodes;
    state.supports.resize(2);
    state.supports[0].force = {1, 2};
    state.supports[1].pressure = microscale::PlatePressure{{0.5}, {3}};
  }
  return result;
}

json part_answer(const PartSimulationRequest& request, const microscale::PartSimulationResult& result,
                 const std::optional<microscale::PartMeshError>& error = std::nullopt) {
  tiling::Part part;
  part.lower = {0, 0};
  part.upper = {20, 34};
  part.thickness = 1;
  part.outline_area = 2;
  part.solid_area = 1;
  part.crumb_area = 0;
  const auto mesh = single_triangle();
  return json::parse(write_part_simulation(request, {part, mesh, result, error}, {}));
}

TEST(PartSimulationAnswers, HaveTheSupportsAndTheirForces) {
  const auto answer = part_answer(read_simulation(part_of_block), part_result(single_triangle()),
                                  microscale::PartMeshError{0.01, 0.02});
  EXPECT_EQ(answer["part"]["size"], (json{20, 34, 1}));
  EXPECT_EQ(answer["supports"][1]["side"], "top");
  EXPECT_EQ(answer["supports"][1]["displacement"], (json{0, -6}));
  ASSERT_EQ(answer["states"].size(), 2U);
  const auto& supports = answer["states"][0]["supports"];
  EXPECT_EQ(supports[0]["force"], (json{1, 2}));
  EXPECT_TRUE(supports[0]["pressure"].is_null());
  EXPECT_EQ(supports[1]["pressure"]["length"], 1);
  EXPECT_EQ(supports[1]["pressure"]["positions"], json::array({0.5}));
  EXPECT_EQ(supports[1]["pressure"]["values"], json::array({3}));
  EXPECT_EQ(answer["accuracy"]["discretization_error"], (json{{"force", 0.01}, {"energy", 0.02}}));
  EXPECT_FALSE(answer.contains("mesh"));
  EXPECT_FALSE(answer["states"][0].contains("svg"));
}

TEST(PartSimulationAnswers, SayNullForAResidualOrAnErrorThatIsUnknown) {
  auto result = part_result(single_triangle());
  result.states[1].residual = std::numeric_limits<double>::quiet_NaN();
  const auto answer = part_answer(read_simulation(part_of_block), result);
  EXPECT_TRUE(answer["states"][1]["residual"].is_null());
  EXPECT_TRUE(answer["accuracy"]["residual"].is_null());
  EXPECT_TRUE(answer["accuracy"]["discretization_error"].is_null());
}

TEST(PartSimulationAnswers, RefuseAForceThatIsNotFinite) {
  auto result = part_result(single_triangle());
  result.states[1].supports[0].force.x() = std::numeric_limits<double>::infinity();
  testing::expect_error("computation.non_finite", [&] { part_answer(read_simulation(part_of_block), result); });
}

TEST(PartSimulationAnswers, HaveDeformedPartsAsTheRequestAsks) {
  const auto mesh = single_triangle();
  const auto result = part_result(mesh);
  const auto as_json = part_answer(read_simulation(part_of_block + R"(,"deformed":"json")"), result);
  EXPECT_EQ(as_json["mesh"]["points"].size(), static_cast<std::size_t>(mesh.nodes.cols()));
  EXPECT_EQ(as_json["mesh"]["triangles"].size(), mesh.triangles.size());
  const auto& deformed = as_json["states"][1]["deformed"];
  EXPECT_NEAR(deformed["points"][1][0].get<double>(), 1.1 * as_json["mesh"]["points"][1][0].get<double>(), 1e-12);
  ASSERT_EQ(deformed["strains"].size(), mesh.triangles.size());
  EXPECT_NEAR(deformed["strains"][0].get<double>(), 0.1, 1e-12);
  const auto as_obj = part_answer(read_simulation(part_of_block + R"(,"deformed":"obj")"), result);
  EXPECT_TRUE(as_obj["states"][0]["obj"].get<std::string>().starts_with("o part"));
  const auto with_files = part_answer(read_simulation(part_of_block + R"(,"deformed":"vtu","svg":true)"), result);
  const auto& as_vtu = with_files["states"][0];
  EXPECT_NE(as_vtu["vtu"].get<std::string>().find("largest_strain"), std::string::npos);
  EXPECT_NE(as_vtu["svg"].get<std::string>().find("<svg"), std::string::npos);
}

TEST(PartSimulationAnswers, TellTheLatestStateWithoutItsPoints) {
  const auto request = read_simulation(part_of_block + R"(,"deformed":"json","states":5)");
  const auto partial = json::parse(write_partial_part_simulation(request, 2, part_result(single_triangle()).states[0]));
  EXPECT_EQ(partial["number"], 2);
  EXPECT_EQ(partial["states"], 5);
  EXPECT_EQ(partial["state"]["share"], 0.5);
  EXPECT_FALSE(partial["state"].contains("deformed"));
}

}  // namespace
}  // namespace supple::json
