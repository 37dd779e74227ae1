#include "supple/json/structure_requests.h"

#include <gtest/gtest.h>

#include "supple/microscale/accurate_simulation.h"
#include "supple/problem/problem.h"
#include "support/expect_error.h"

namespace supple::json {
namespace {

using microscale::BiaxialLoad;
using microscale::GreenStrainLoad;
using microscale::UniaxialLoad;
using Pointers = std::vector<std::string>;

Pointers faults_of_simulation(const std::string& fields) {
  return testing::places(
      testing::expect_error("request.invalid", [&] { parse_simulation("{\"family\":\"IH01\"," + fields + "}", {}); }));
}

Pointers faults_of_load(const std::string& load) { return faults_of_simulation("\"load\":" + load); }

TEST(StructureRequests, ReadEveryField) {
  Limits limits;
  limits.max_mesh_nodes = 77;
  const auto request = parse_structure(
      R"({"family":"IH21","parameters":[0.15,0.65],"cells":[3,4],"height":2.5,"mesh":{"mesh_size":0.5,"corner_size":0.2,"mesh_region":"cell"},
          "svg":true,"deadline":9})",
      limits);
  EXPECT_EQ(request.structure.family, "IH21");
  EXPECT_EQ(request.structure.parameters, (std::vector<double>{0.15, 0.65}));
  EXPECT_EQ(request.files.first, 3);
  EXPECT_EQ(request.files.second, 4);
  EXPECT_EQ(request.files.height, 2.5);
  ASSERT_TRUE(request.mesh);
  EXPECT_EQ(request.mesh->mesh_size, 0.5);
  EXPECT_EQ(request.mesh->corner_size, 0.2);
  EXPECT_EQ(request.mesh->region, tiling::Region::cell);
  EXPECT_EQ(request.mesh->max_nodes, 77);
  EXPECT_TRUE(request.svg);
  EXPECT_EQ(request.deadline, 9);
}

TEST(StructureRequests, LeaveParametersAndMeshOpenWhereTheyAreNotGiven) {
  const auto request = parse_structure(R"({"family":"IH01"})", {});
  EXPECT_FALSE(request.structure.parameters);
  EXPECT_FALSE(request.mesh);
  EXPECT_FALSE(request.svg);
  EXPECT_TRUE(parse_structure(R"({"family":"IH01","mesh":{}})", {}).mesh);
}

TEST(StructureRequests, PointToEachFieldAtFault) {
  const auto error = testing::expect_error("request.invalid", [] {
    parse_structure(
        R"({"family":"","parameters":[1,"x"],"cells":[0,2],"height":0,"mesh":{"mesh_size":3,"mesh_region":"all","corner":1},"svg":1})",
        {});
  });
  EXPECT_EQ(error.code(), "request.invalid");
  EXPECT_EQ(testing::places(error), (Pointers{"/family", "/parameters/1", "/cells", "/height", "/mesh/mesh_size",
                                              "/mesh/mesh_region", "/mesh/corner", "/svg"}));
}

TEST(StructureRequests, RefuseCellsThatAreNoPairOfCounts) {
  for (const char* cells : {"[1]", "[1,2,3]", "[1,101]", "[1.5,2]", "2", "[\"1\",1]"}) {
    const auto error = testing::expect_error(
        "request.invalid", [&] { parse_structure(R"({"family":"IH01","cells":)" + std::string(cells) + "}", {}); });
    EXPECT_EQ(testing::places(error), Pointers{"/cells"}) << cells;
  }
}

TEST(SimulationRequests, ReadGreenStrains) {
  const auto request =
      parse_simulation(R"({"family":"IH01","load":{"green_strain":[[0.1,-0.05,0.02],[0.2,0,0]]}})", {});
  const auto& load = std::get<GreenStrainLoad>(request.load);
  ASSERT_EQ(load.strains.size(), 2U);
  EXPECT_EQ(load.strains[0], Eigen::Vector3d(0.1, -0.05, 0.02));
  EXPECT_EQ(load.strains[1], Eigen::Vector3d(0.2, 0, 0));
}

TEST(SimulationRequests, ReadUniaxialAndBiaxialStretches) {
  const auto uniaxial =
      parse_simulation(R"({"family":"IH01","load":{"uniaxial":{"direction":0.5,"stretches":[1.1,1.2]}}})", {});
  EXPECT_EQ(std::get<UniaxialLoad>(uniaxial.load).direction, 0.5);
  EXPECT_EQ(std::get<UniaxialLoad>(uniaxial.load).stretches, (std::vector<double>{1.1, 1.2}));
  const auto biaxial =
      parse_simulation(R"({"family":"IH01","load":{"biaxial":{"direction":-1,"stretches":[[1.1,0.9]]}}})", {});
  EXPECT_EQ(std::get<BiaxialLoad>(biaxial.load).direction, -1);
  EXPECT_EQ(std::get<BiaxialLoad>(biaxial.load).stretches[0], Eigen::Vector2d(1.1, 0.9));
}

TEST(SimulationRequests, ReadEveryOption) {
  const auto request = parse_simulation(
      R"({"family":"IH01","parameters":[],"load":{"green_strain":[[0,0,0]]},
          "material":{"law":"incompressible_plane_stress","youngs_modulus":2,"poisson_ratio":0.3},
          "accuracy":{"mesh_size":0.25,"corner_size":0.5,"tolerance":1e-6,"max_iterations":30,"max_load_step":0.1},
          "effects":{"contact":"on","patch":"off","buckling":"automatic"},"tangents":false,"deformed":"vtu","deadline":3})",
      {});
  const auto& options = request.options;
  EXPECT_EQ(options.material.law, microscale::Law::incompressible_plane_stress);
  EXPECT_EQ(options.material.youngs_modulus, 2);
  EXPECT_EQ(options.material.poisson_ratio, 0.3);
  EXPECT_EQ(options.mesh.mesh_size, 0.25);
  EXPECT_EQ(options.mesh.corner_size, 0.5);
  EXPECT_EQ(options.tolerance, 1e-6);
  EXPECT_EQ(options.max_iterations, 30);
  EXPECT_EQ(options.max_load_step, 0.1);
  EXPECT_EQ(options.contact, microscale::Switch::on);
  EXPECT_EQ(options.patch, microscale::Switch::off);
  EXPECT_EQ(options.buckling, microscale::Switch::automatic);
  EXPECT_FALSE(options.tangents);
  EXPECT_TRUE(options.deformed_meshes);
  EXPECT_EQ(request.deformed, Deformed::vtu);
  EXPECT_EQ(request.deadline, 3);
}

TEST(SimulationRequests, LeaveTheMeshAndItsErrorToTheEngineUnlessTheyNameOne) {
  using microscale::Refinement;
  const auto read = [](const std::string& more) {
    return parse_simulation(R"({"family":"IH01","load":{"green_strain":[[0,0,0]]},)" + more + "}", {});
  };
  const auto accepted = read(R"("accuracy":{"discretization_error":0.01})");
  EXPECT_EQ(accepted.accepted_error, 0.01);
  EXPECT_FALSE(accepted.mesh_given);
  EXPECT_EQ(accepted.options.refinement, Refinement::extrapolated);
  const auto both = read(R"("accuracy":{"discretization_error":0.01,"mesh_size":0.5})");
  EXPECT_TRUE(both.mesh_given);
  EXPECT_EQ(both.options.refinement, Refinement::estimated);
  EXPECT_EQ(both.options.mesh.corner_size, tiling::MeshOptions{}.corner_size);
  EXPECT_EQ(both.options.mesh.max_nodes, Limits{}.max_mesh_nodes);
  EXPECT_EQ(read(R"("accuracy":{"mesh_size":0.5},"effects":{"refinement":"on"})").options.refinement,
            Refinement::extrapolated);
  EXPECT_EQ(read(R"("effects":{"refinement":"off"})").options.refinement, Refinement::off);
  const std::string load = R"("load":{"green_strain":[[0,0,0]]},)";
  EXPECT_EQ(faults_of_simulation(load + R"("accuracy":{"discretization_error":0.01},"effects":{"refinement":"off"})"),
            Pointers{"/accuracy/discretization_error"});
  EXPECT_EQ(faults_of_simulation(load + R"("accuracy":{"discretization_error":0})"),
            Pointers{"/accuracy/discretization_error"});
}

TEST(SimulationRequests, TakeTheEnginesDefaults) {
  const auto request = parse_simulation(R"({"family":"IH01","load":{"green_strain":[[0,0,0]]}})", {});
  const microscale::SimulationOptions defaults;
  EXPECT_EQ(request.options.mesh.mesh_size, microscale::extrapolated_mesh().mesh_size);
  EXPECT_EQ(request.options.mesh.corner_size, microscale::extrapolated_mesh().corner_size);
  EXPECT_EQ(request.options.refinement, microscale::Refinement::extrapolated);
  EXPECT_FALSE(request.accepted_error);
  EXPECT_EQ(request.options.tolerance, defaults.tolerance);
  EXPECT_EQ(request.options.tangents, defaults.tangents);
  EXPECT_FALSE(request.options.deformed_meshes);
  EXPECT_EQ(request.options.mesh.max_nodes, Limits{}.max_mesh_nodes);
}

TEST(SimulationRequests, NeedExactlyOneKindOfLoad) {
  EXPECT_EQ(faults_of_simulation("\"tangents\":true"), Pointers{"/load"});
  EXPECT_EQ(faults_of_load("{}"), Pointers{"/load"});
  EXPECT_EQ(faults_of_load("[]"), Pointers{"/load"});
  EXPECT_EQ(faults_of_load(R"({"green_strain":[[0,0,0]],"uniaxial":{"direction":0,"stretches":[1]}})"),
            Pointers{"/load"});
  EXPECT_EQ(faults_of_load(R"({"uniaxal":{}})"), (Pointers{"/load", "/load/uniaxal"}));
}

TEST(SimulationRequests, PointToEachFaultyStateOfALoad) {
  EXPECT_EQ(faults_of_load(R"({"green_strain":[[0,0],[0,0,"x"],[0,0,0],7]})"),
            (Pointers{"/load/green_strain/0", "/load/green_strain/1/2", "/load/green_strain/3"}));
  EXPECT_EQ(faults_of_load(R"({"green_strain":[]})"), Pointers{"/load/green_strain"});
  EXPECT_EQ(faults_of_load(R"({"uniaxial":{"stretches":[1,0.1,5]}})"),
            (Pointers{"/load/uniaxial/direction", "/load/uniaxial/stretches/1", "/load/uniaxial/stretches/2"}));
  EXPECT_EQ(faults_of_load(R"({"biaxial":{"direction":"x","stretches":[[1,1,1],[1,-1]]}})"),
            (Pointers{"/load/biaxial/direction", "/load/biaxial/stretches/0", "/load/biaxial/stretches/1/1"}));
}

TEST(SimulationRequests, PointToEachOptionAtFault) {
  const std::string load = "\"load\":{\"green_strain\":[[0,0,0]]},";
  EXPECT_EQ(faults_of_simulation(load + R"("material":{"law":"steel","youngs_modulus":0,"poisson_ratio":0.5})"),
            (Pointers{"/material/law", "/material/youngs_modulus", "/material/poisson_ratio"}));
  EXPECT_EQ(
      faults_of_simulation(
          load +
          R"("accuracy":{"mesh_size":0,"corner_size":2,"tolerance":1,"max_iterations":0,"max_load_step":0,"tol":1})"),
      (Pointers{"/accuracy/mesh_size", "/accuracy/corner_size", "/accuracy/tolerance", "/accuracy/max_iterations",
                "/accuracy/max_load_step", "/accuracy/tol"}));
  EXPECT_EQ(faults_of_simulation(load + R"("effects":{"contact":true,"patch":"yes","gravity":"on"},"deformed":"obj")"),
            (Pointers{"/effects/contact", "/effects/patch", "/effects/gravity", "/deformed"}));
}

TEST(SimulationRequests, RefuseMoreStatesThanTheLimitAndNameTheSetting) {
  Limits limits;
  limits.max_states = 2;
  try {
    parse_simulation(R"({"family":"IH01","load":{"uniaxial":{"direction":0,"stretches":[1,1,1]}}})", limits);
    FAIL() << "nothing was thrown";
  } catch (const problem::ProblemError& error) {
    EXPECT_EQ(error.code(), "request.limit_exceeded");
    EXPECT_EQ(error.problem().limit->setting, "--max-states");
    EXPECT_EQ(testing::places(error), Pointers{"/load/uniaxial/stretches"});
  }
}

}  // namespace
}  // namespace supple::json
