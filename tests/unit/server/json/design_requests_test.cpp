#include "supple/json/design_requests.h"

#include <gtest/gtest.h>

#include <numbers>

#include "support/expect_error.h"

namespace supple::json {
namespace {

using Pointers = std::vector<std::string>;
using design::StrainMeasure;
using design::Task;

const std::string target = R"("target":{"control_points":[[0,0],[0.1,1]]})";

Pointers faults_of_design(const std::string& fields) {
  return testing::places(testing::expect_error("request.invalid", [&] { parse_design("{" + fields + "}", {}); }));
}

Pointers faults_of_profile(const std::string& fields) {
  return testing::places(testing::expect_error("request.invalid", [&] { parse_profile("{" + fields + "}", {}); }));
}

TEST(DesignRequests, ReadEveryField) {
  const auto request = parse_design(
      R"({"name":"heel","task":"poisson","strain":0.1,"strain_measure":"engineering",
          "target":{"control_points":[[0,0.1],[1,-0.2]],"interpolation":"monotone","weights":[1,2],"bands":[0.1,0]},
          "samples":24,"weight":3,"also":[{"task":"stress_strain","direction":0.5,
          "target":{"control_points":[[-0.1,-1],[0.2,2]]}}],"model":"ih21","initial":[0.15,0.6],"fixed":[null,0.6],
          "verify":true,"accuracy":{"tolerance":1e-4,"equilibrium_tolerance":1e-8,"max_iterations":9,"starts":3,
          "candidates":40,"verified_samples":5,"polish_tolerance":0.01,"polish_rounds":7,"polish_seconds":50},
          "effects":{"multi_start":"on","envelope":"off","polish":"on","ways_out":"on","beam_width_sensitivity":"on"},"session":"tab-1",
          "deadline":9})",
      {});
  EXPECT_FALSE(request.several);
  ASSERT_EQ(request.regions.size(), 1U);
  const auto& region = request.regions[0];
  EXPECT_EQ(region.name, "heel");
  EXPECT_EQ(region.model, "ih21");
  ASSERT_EQ(region.problem.targets.size(), 2U);
  const auto& main = region.problem.targets[0];
  EXPECT_EQ(main.task, Task::poisson);
  EXPECT_EQ(main.strain, 0.1);
  EXPECT_EQ(main.measure, StrainMeasure::engineering);
  EXPECT_EQ(main.control_points[1], Eigen::Vector2d(1, -0.2));
  EXPECT_EQ(main.interpolation, numerics::Interpolation::monotone);
  EXPECT_EQ(main.weights, (std::vector<double>{1, 2}));
  EXPECT_EQ(main.bands, (std::vector<double>{0.1, 0}));
  EXPECT_EQ(main.samples, 24);
  EXPECT_EQ(main.weight, 3);
  EXPECT_EQ(region.problem.targets[1].direction, 0.5);
  EXPECT_EQ(*region.problem.initial, Eigen::Vector2d(0.15, 0.6));
  EXPECT_EQ(region.problem.fixed, (std::vector<std::optional<double>>{std::nullopt, 0.6}));
  EXPECT_TRUE(request.verify);
  EXPECT_EQ(request.verification.polish, Switch::on);
  EXPECT_EQ(request.verification.options.samples, 5);
  EXPECT_EQ(request.verification.options.tolerance, 0.01);
  EXPECT_EQ(request.verification.options.max_rounds, 7);
  EXPECT_EQ(request.verification.options.max_seconds, 50);
  EXPECT_EQ(request.verification.options.equilibrium_tolerance, 1e-8);
  EXPECT_EQ(request.options.tolerance, 1e-4);
  EXPECT_EQ(request.options.equilibrium_tolerance, 1e-8);
  EXPECT_EQ(request.options.max_iterations, 9);
  EXPECT_EQ(request.options.starts, 3);
  EXPECT_EQ(request.options.candidates, 40);
  EXPECT_EQ(request.options.multi_start, Switch::on);
  EXPECT_EQ(request.options.envelope, Switch::off);
  EXPECT_EQ(request.ways_out, Switch::on);
  EXPECT_EQ(request.beam_width_sensitivity, Switch::on);
  EXPECT_TRUE(request.needs_simulations());
  EXPECT_EQ(request.session, "tab-1");
  EXPECT_EQ(request.deadline, 9);
}

TEST(DesignRequests, SimulateWhereTheyAreVerifiedOrPolishedAtAllEvents) {
  const auto simulates = [](const std::string& more) {
    return parse_design("{\"task\":\"stiffness\"," + target + more + "}", {}).simulates();
  };
  EXPECT_FALSE(simulates(""));
  EXPECT_FALSE(simulates(",\"effects\":{\"polish\":\"automatic\"}"));
  EXPECT_TRUE(simulates(",\"verify\":true"));
  EXPECT_TRUE(simulates(",\"verify\":true,\"effects\":{\"polish\":\"off\"}"));
  EXPECT_TRUE(simulates(",\"effects\":{\"polish\":\"on\"}"));
}

TEST(DesignRequests, SeekWaysOutUnlessTheyBelongToASession) {
  const auto seeks = [](const std::string& more) {
    return parse_design("{\"task\":\"stiffness\"," + target + more + "}", {}).seeks_ways_out();
  };
  EXPECT_TRUE(seeks(""));
  EXPECT_FALSE(seeks(",\"session\":\"a\""));
  EXPECT_TRUE(seeks(",\"session\":\"a\",\"effects\":{\"ways_out\":\"on\"}"));
  EXPECT_FALSE(seeks(",\"effects\":{\"ways_out\":\"off\"}"));
}

TEST(DesignRequests, ReadRegions) {
  const auto request = parse_design(
      "{\"regions\":[{\"name\":\"a\",\"task\":\"stiffness\"," + target + "},{\"task\":\"poisson\"," + target + "}]}",
      {});
  EXPECT_TRUE(request.several);
  ASSERT_EQ(request.regions.size(), 2U);
  EXPECT_EQ(request.regions[0].name, "a");
  EXPECT_EQ(request.regions[1].family, "any");
}

RegionSpec region_of(const std::string& fields) {
  return parse_design("{\"task\":\"stiffness\"," + target + "," + fields + "}", {}).regions.front();
}

TEST(DesignRequests, ReadMaterials) {
  EXPECT_TRUE(region_of("\"name\":\"a\"").materials.empty());
  const auto one = region_of(R"("material":{"youngs_modulus":12,"poisson_ratio":0.48,"density":2})").materials;
  ASSERT_EQ(one.size(), 1U);
  EXPECT_TRUE(one[0].has_modulus && one[0].is_neo_hookean);
  EXPECT_EQ(one[0].youngs_modulus.least, 12);
  EXPECT_EQ(one[0].youngs_modulus.most, 12);
  EXPECT_EQ(one[0].poisson_ratio, 0.48);
  EXPECT_EQ(one[0].density, 2);
  const auto several =
      region_of(
          R"("material":[{"name":"a","law":"incompressible_plane_stress","youngs_modulus":2},{"youngs_modulus":[3,4]}])")
          .materials;
  ASSERT_EQ(several.size(), 2U);
  EXPECT_EQ(several[0].name, "a");
  EXPECT_FALSE(several[0].is_neo_hookean);
  EXPECT_EQ(several[0].density, 1.2);
  EXPECT_EQ(several[1].youngs_modulus.least, 3);
  EXPECT_EQ(several[1].youngs_modulus.most, 4);
}

TEST(DesignRequests, ReadSizesAndTheirLimitsInWidthsOfABeam) {
  const auto plain = region_of("\"beam_width\":0.5,\"limits\":{\"relative_density\":[0.1,0.2],\"cell_size\":[2,4]}");
  EXPECT_EQ(plain.beam_width, 0.5);
  EXPECT_EQ(plain.cell_size, 0);
  EXPECT_EQ(plain.problem.limits.relative_density.least, 0.1);
  EXPECT_EQ(plain.problem.limits.relative_density.most, 0.2);
  EXPECT_EQ(plain.problem.limits.cell_size.least, 4);
  EXPECT_EQ(plain.problem.limits.cell_size.most, 8);
  const auto by_cells = region_of(R"("cell_size":6,"limits":{"beam_width":[0.5,0.75]})");
  EXPECT_EQ(by_cells.cell_size, 6);
  EXPECT_EQ(by_cells.problem.limits.cell_size.least, 8);
  EXPECT_EQ(by_cells.problem.limits.cell_size.most, 12);
  EXPECT_FALSE(region_of("\"cell_size\":6").problem.limits.any());
}

TEST(DesignRequests, PointToWhatIsWrongWithMaterialsAndSizes) {
  const auto faults = [](const std::string& fields) {
    return faults_of_design("\"task\":\"poisson\"," + target + "," + fields);
  };
  EXPECT_EQ(faults(R"("material":{"youngs_modulus":[4,3],"law":"hooke","density":0,"color":"red"})"),
            (Pointers{"/material/youngs_modulus", "/material/law", "/material/density", "/material/color"}));
  EXPECT_EQ(faults(R"("material":[])"), Pointers{"/material"});
  EXPECT_EQ(faults(R"("material":[{"youngs_modulus":1},{"name":"a"}])"), Pointers{"/material/1"});
  EXPECT_EQ(region_of(R"("material":[{"name":"a"}])").materials.size(), 1U) << "the model's modulus";
  EXPECT_EQ(faults(R"("material":[{"youngs_modulus":1},{"youngs_modulus":-1}])"),
            Pointers{"/material/1/youngs_modulus"});
  EXPECT_EQ(faults(R"("cell_size":2,"beam_width":0.2)"), Pointers{"/cell_size"});
  EXPECT_EQ(faults(R"("limits":{"beam_width":[0.1,0.2],"relative_density":[0.1,2]})"),
            (Pointers{"/limits/relative_density/1", "/limits/beam_width"}));
  EXPECT_EQ(faults(R"("cell_size":2,"limits":{"cell_size":[1,2]})"), Pointers{"/limits/cell_size"});
}

TEST(DesignRequests, PointToEachFieldAtFault) {
  EXPECT_EQ(faults_of_design(""), (Pointers{"/task", "/target"}));
  EXPECT_EQ(
      faults_of_design(R"("task":"bend","target":{"control_points":[[0,0]],"weights":[-1,1]},"samples":1,"weight":0)"),
      (Pointers{"/task", "/target/control_points", "/target/weights/0", "/samples", "/weight"}));
  EXPECT_EQ(faults_of_design("\"task\":\"poisson\"," + target + R"(,"strain":-0.5,"session":"a b","fixed":["x"])"),
            (Pointers{"/strain", "/fixed/0", "/session"}));
  EXPECT_EQ(faults_of_design("\"task\":\"poisson\"," + target + R"(,"family":"IH21","model":"ih21")"),
            Pointers{"/model"});
  EXPECT_EQ(faults_of_design("\"regions\":[{\"task\":\"poisson\"}],\"task\":\"poisson\""),
            (Pointers{"/regions/0/target", "/task"}));
  EXPECT_EQ(
      faults_of_design("\"task\":\"poisson\"," + target + R"(,"also":[{"task":"poisson"}],"accuracy":{"starts":0})"),
      (Pointers{"/also/0/target", "/accuracy/starts"}));
}

TEST(ProfileRequests, SpreadTheirSamples) {
  const auto strains = parse_profile(R"({"task":"stress_strain","family":"IH21","parameters":[1],"samples":4})", {});
  EXPECT_EQ(strains.samples.x.size(), 4U);
  EXPECT_DOUBLE_EQ(strains.samples.x.front(), -0.1);
  EXPECT_DOUBLE_EQ(strains.samples.x.back(), 0.2);
  const auto angles = parse_profile(R"({"task":"poisson","model":"ih21","parameters":[1]})", {});
  ASSERT_EQ(angles.samples.x.size(), 50U);
  EXPECT_DOUBLE_EQ(angles.samples.x[1], std::numbers::pi / 50);
  const auto given = parse_profile(R"({"task":"poisson","model":"ih21","parameters":[1],"x":[3,1]})", {});
  EXPECT_EQ(given.samples.x, (std::vector<double>{3, 1}));
}

TEST(ProfileRequests, TakeOneModulus) {
  const std::string rest = R"("task":"poisson","family":"IH21","parameters":[1],"material":{"youngs_modulus":)";
  EXPECT_EQ(parse_profile("{" + rest + "5}}", {}).material->youngs_modulus.most, 5);
  EXPECT_EQ(faults_of_profile(rest + "[5,6]}"), Pointers{"/material/youngs_modulus"});
}

TEST(ProfileRequests, PointToEachFieldAtFault) {
  EXPECT_EQ(faults_of_profile(R"("task":"poisson")"), (Pointers{"", "/parameters"}));
  EXPECT_EQ(faults_of_profile(R"("task":"poisson","family":"IH21","parameters":[1],"range":[0,1])"),
            Pointers{"/range"});
  EXPECT_EQ(faults_of_profile(R"("task":"stress_strain","family":"IH21","parameters":[1],"x":[0],"samples":3)"),
            Pointers{"/x"});
}

}  // namespace
}  // namespace supple::json
