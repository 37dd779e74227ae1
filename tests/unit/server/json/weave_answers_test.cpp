#include "supple/json/weave_answers.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace supple::json {
namespace {

using Json = nlohmann::json;

weave::Weave one_crossing() {
  weave::Weave weave;
  weave.strands.push_back({weave::StrandCurve({{-1, 0}, {1, 0}}, weave::Ends::open)});
  weave.strands.push_back({weave::StrandCurve({{0, -2}, {0, 2}}, weave::Ends::open), 0.5});
  weave.crossings = {{{{0, 1}, {1, 2, {0, 0}, true, 0.5}}}};
  return weave;
}

weave::DirectionalResponse response(double modulus, weave::Stop stopped = weave::Stop::converged) {
  weave::DirectionalResponse result;
  result.youngs_modulus = modulus;
  result.youngs_modulus_mpa = modulus / 1000;
  result.poisson_ratio = stopped == weave::Stop::converged ? 0.25 : std::numeric_limits<double>::quiet_NaN();
  result.state.stopped = stopped;
  result.state.residual = 2e-9;
  result.state.tolerance = 1e-8;
  result.state.deformation_gradient = Eigen::Matrix2d{{1.1, 0.2}, {0, 0.9}};
  result.state.strands = {{{0, 0, 0}, {1, 2, 3}}};
  result.state.sliding = {0.125};
  return result;
}

TEST(WeaveAnswers, DescribeALayoutAsARequestMayGiveIt) {
  const std::string svg = "<svg/>";
  const auto answer = Json::parse(write_weave_layout(one_crossing(), {"Careful."}, &svg, {}));
  EXPECT_EQ(answer["strands"][1]["length"], 4.0);
  EXPECT_EQ(answer["strands"][1]["radius"], 0.5);
  EXPECT_EQ(answer["strands"][0]["ends"], "open");
  EXPECT_EQ(answer["strands"][0]["polyline"], Json::parse("[[-1.0,0.0],[1.0,0.0]]"));
  const auto& crossing = answer["crossings"][0];
  EXPECT_EQ(crossing["position"], Json::parse("[0.0,0.0]"));
  EXPECT_EQ(crossing["members"][0], Json::parse(R"({"strand":0,"coordinate":1.0,"shift":[0,0],"slides":false})"));
  EXPECT_EQ(crossing["members"][1], Json::parse(R"({"strand":1,"coordinate":2.0,"shift":[0,0],"slides":true,
                                                    "backward":0.5,"forward":null})"));
  EXPECT_TRUE(answer["lattice"].is_null());
  EXPECT_EQ(answer["warnings"], Json::parse(R"(["Careful."])"));
  EXPECT_EQ(answer["svg"], svg);
  EXPECT_FALSE(Json::parse(write_weave_layout(one_crossing(), {}, nullptr, {})).contains("svg"));
}

TEST(WeaveAnswers, HaveOneEntryForEachDirectionAndNullWhereOneWasNotReached) {
  weave::Weave weave = one_crossing();
  weave.lattice = Eigen::Matrix2d{{4, 0}, {0, 4}};
  WeaveHomogenizationRequest request;
  request.options.directions = {0, 1.5};
  request.options.deformed = {0};
  const auto lost = response(std::numeric_limits<double>::quiet_NaN(), weave::Stop::step_too_small);
  const auto answer = Json::parse(write_weave_homogenization(request, weave, {response(250), lost}, {}));
  EXPECT_EQ(answer["directions"], Json::parse("[0.0,1.5]"));
  EXPECT_EQ(answer["youngs_modulus"], Json::parse("[250.0,null]"));
  EXPECT_EQ(answer["poisson_ratio"], Json::parse("[0.25,null]"));
  EXPECT_EQ(answer["stopped"], Json::parse(R"(["converged","step_too_small"])"));
  EXPECT_FALSE(answer.contains("youngs_modulus_mpa"));
  EXPECT_NE(answer["message"].get<std::string>().find("1 of 2"), std::string::npos);
  EXPECT_EQ(answer["deformation_gradient"][0], Json::parse("[[1.1,0.2],[0.0,0.9]]"));
  EXPECT_EQ(answer["sliders"], Json::parse(R"([{"crossing":0,"member":1}])"));
  ASSERT_EQ(answer["cells"].size(), 1U);
  EXPECT_EQ(answer["cells"][0]["strands"], Json::parse("[[[0.0,0.0,0.0],[1.0,2.0,3.0]]]"));
  EXPECT_EQ(answer["cells"][0]["sliding"], Json::parse("[0.125]"));
  EXPECT_NEAR(answer["cells"][0]["lattice"][1][0].get<double>(), 0.8, 1e-12) << "translations are rows";
  EXPECT_NEAR(answer["accuracy"]["residual"].get<double>(), 0.2, 1e-12);
  request.options.thickness = 1;
  EXPECT_EQ(Json::parse(write_weave_homogenization(request, weave, {response(250), lost}, {}))["youngs_modulus_mpa"][0],
            0.25);
}

TEST(WeaveAnswers, SayWhereSlidersStandShortOfTheirLimits) {
  weave::Weave weave = one_crossing();
  weave.lattice = Eigen::Matrix2d{{4, 0}, {0, 4}};
  WeaveHomogenizationRequest request;
  request.options.directions = {0, 1.5};
  auto short_of_limits = response(250);
  short_of_limits.state.limit_error = 0.125;
  const auto written = [&] {
    return Json::parse(write_weave_homogenization(request, weave, {response(250), short_of_limits}, {}));
  };
  const auto answer = written();
  EXPECT_EQ(answer["limit_error"], Json::parse("[0.0,0.125]"));
  EXPECT_EQ(answer["accuracy"]["limit_error"], 0.125);
  EXPECT_EQ(answer["accuracy"]["limit_tolerance"], 1e-6);
  EXPECT_EQ(answer["message"],
            "In 1 of 2 directions sliders stand short of their limits; `limit_error` says how much "
            "too high the energy may be.");
  request.options.equilibrium.limit_tolerance = 0.5;
  EXPECT_EQ(written()["message"], "");
}

TEST(WeaveAnswers, HaveOneEntryForEachDeformationGradient) {
  weave::Weave weave = one_crossing();
  weave.lattice = Eigen::Matrix2d{{4, 0}, {0, 4}};
  WeaveDeformationRequest request;
  request.deformed = {1};
  auto lost = response(0, weave::Stop::iteration_limit).state;
  lost.nominal_stress << 1, 2, 3, 4;
  lost.energy_density = 0.5;
  const auto answer = Json::parse(write_weave_deformation(request, weave, {response(1).state, lost}, {}));
  EXPECT_EQ(answer["stopped"], Json::parse(R"(["converged","iteration_limit"])"));
  EXPECT_EQ(answer["message"], "1 of 2 deformation gradients were not reached; `stopped` says why.");
  EXPECT_EQ(answer["nominal_stress"][1], Json::parse("[[1.0,2.0],[3.0,4.0]]"));
  EXPECT_EQ(answer["energy_density"], Json::parse("[0.0,0.5]"));
  ASSERT_EQ(answer["cells"].size(), 1U);
  EXPECT_EQ(answer["cells"][0]["state"], 1);
  EXPECT_NEAR(answer["cells"][0]["lattice"][1][0].get<double>(), 0.8, 1e-12);
  EXPECT_NEAR(answer["accuracy"]["residual"].get<double>(), 0.2, 1e-12);
}

TEST(WeaveAnswers, HoldStrandsInTheFormThatWasAskedFor) {
  weave::SimulationResult result;
  result.unknowns = 7;
  auto& state = result.states.emplace_back();
  state.share = 1;
  state.energy = 2.5;
  state.strands = {{{0, 0, 0}, {1, 0.5, 0}}, {{0, 1, 0}, {0, 2, 0}}};
  state.crossings = {{0.5, 0, 0}};
  state.reactions = {{1, 2, 0}};
  state.tolerance = 1;
  WeaveSimulationRequest request;
  const auto written = [&](DeformedStrands deformed) {
    request.deformed = deformed;
    return Json::parse(write_weave_simulation(request, one_crossing(), {{3, 0, 2}}, result, {}));
  };
  const auto json = written(DeformedStrands::json);
  EXPECT_EQ(json["supports"], Json::parse(R"([{"support":3,"strand":0,"coordinate":2.0,"position":[1.0,0.0]}])"));
  EXPECT_EQ(json["states"][0]["strands"][0], Json::parse("[[0.0,0.0,0.0],[1.0,0.5,0.0]]"));
  EXPECT_EQ(json["states"][0]["reactions"], Json::parse("[[1.0,2.0,0.0]]"));
  EXPECT_EQ(json["states"][0]["energy"], 2.5);
  EXPECT_EQ(json["accuracy"]["unknowns"], 7);
  EXPECT_EQ(written(DeformedStrands::obj)["states"][0]["obj"], "v 0 0 0\nv 1 0.5 0\nv 0 1 0\nv 0 2 0\nl 1 2\nl 3 4\n");
  const auto vtu = written(DeformedStrands::vtu)["states"][0];
  EXPECT_NE(vtu["vtu"].get<std::string>().find("NumberOfPoints=\"4\" NumberOfCells=\"2\""), std::string::npos);
  EXPECT_FALSE(vtu.contains("strands"));
  const auto none = written(DeformedStrands::none)["states"][0];
  EXPECT_FALSE(none.contains("strands") || none.contains("obj") || none.contains("vtu"));
}

}  // namespace
}  // namespace supple::json
