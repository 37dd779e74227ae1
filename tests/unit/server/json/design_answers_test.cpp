#include "supple/json/design_answers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

namespace supple::json {
namespace {

using nlohmann::json;

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

FoundDesigns found() {
  design::Design design;
  design.space = 1;
  design.parameters = Eigen::Vector2d(0.125, 0.5);
  design.error = {0.25, 2};
  design.iterations = 7;
  design.starts = 3;
  design.message = "The closest.";
  design.residual = 1e-11;
  design::DesignProfile profile;
  profile.target.samples = {design::Task::stiffness, 0.3, 0.05, design::StrainMeasure::green, {0, 1}};
  profile.target.y = Eigen::Vector2d(1, 2);
  profile.target.weights = Eigen::Vector2d(0.5, 0.5);
  profile.target.bands = Eigen::Vector2d::Zero();
  profile.target.scale = 2;
  profile.initial = Eigen::Vector2d(missing, 3);
  profile.achieved = Eigen::Vector2d(4, 5);
  profile.in_range = {1, 0};
  profile.reached = {0, 1};
  design.profiles = {profile};
  design.youngs_modulus = 26;
  design.measures = {0.25, 16};
  FoundDesigns designs;
  designs.models = {{"IH29", "ih29", "aa", 26, 0.48}, {"IH21", "ih21", "bb", 26, 0.48}};
  designs.ranking = {{design, 0.125}};
  return designs;
}

json written(const FoundDesigns& designs, bool several = false) {
  DesignRequest request;
  request.several = several;
  return json::parse(write_design(request, {designs}, {}));
}

TEST(DesignAnswers, NameTheModelOfTheBestDesign) {
  const auto answer = written(found());
  EXPECT_EQ(answer["family"], "IH21");
  EXPECT_EQ(answer["model"], "ih21");
  EXPECT_EQ(answer["sha256"], "bb");
  EXPECT_EQ(answer["parameters"], (json{0.125, 0.5}));
  EXPECT_EQ(answer["ranking"][0]["family"], "IH21");
  EXPECT_TRUE(answer["ranking"][0]["model_error"].is_null()) << "nobody measured it";
  EXPECT_EQ(answer["ranking"][0]["simulated_error"], 0.125);
  EXPECT_TRUE(answer["polish"].is_null()) << "nobody asked for it";
  EXPECT_EQ(answer["structure"]["stl"], "/v1/families/IH21/structure?parameters=0.125,0.5&format=stl");
  EXPECT_EQ(answer["accuracy"]["residual"], 1e-11);
  EXPECT_EQ(answer["error"], (json{{"relative_rms", 0.25}, {"max", 2.0}}));
}

TEST(DesignAnswers, SayWhatTheStructureIsMadeOfAndMeasures) {
  auto designs = found();
  auto answer = written(designs);
  EXPECT_EQ(answer["material"],
            (json{{"youngs_modulus", 26.0}, {"law", "neo_hookean"}, {"poisson_ratio", 0.48}, {"density", 1.2}}));
  EXPECT_EQ(answer["structure"]["beam_width"], 0.3);
  EXPECT_DOUBLE_EQ(answer["structure"]["cell_size"], 4.8);
  EXPECT_EQ(answer["structure"]["relative_density"], 0.25);
  EXPECT_DOUBLE_EQ(answer["structure"]["density"], 0.3);

  MaterialSpec other;
  other.name = "TPU";
  other.density = 2;
  designs.spec.materials = {MaterialSpec{}, other};
  designs.ranking[0].design.material = 1;
  designs.ranking[0].design.youngs_modulus = 55;
  designs.spec.cell_size = 8;
  answer = written(designs);
  EXPECT_EQ(answer["material"]["name"], "TPU");
  EXPECT_EQ(answer["material"]["youngs_modulus"], 55);
  EXPECT_EQ(answer["ranking"][0]["material"], answer["material"]);
  EXPECT_EQ(answer["structure"]["density"], 0.5);
  EXPECT_EQ(answer["structure"]["beam_width"], 0.5);
  EXPECT_EQ(answer["structure"]["cell_size"], 8);
  EXPECT_EQ(answer["structure"]["svg"], "/v1/families/IH21/structure?parameters=0.125,0.5&beam_width=0.5&format=svg");

  designs.ranking[0].design.measures.reset();
  designs.spec.cell_size = 0;
  designs.spec.beam_width = 0.75;
  answer = written(designs);
  EXPECT_TRUE(answer["structure"]["density"].is_null());
  EXPECT_TRUE(answer["structure"]["cell_size"].is_null());
  EXPECT_EQ(answer["structure"]["beam_width"], 0.75);
}

TEST(DesignAnswers, SayHowNearAnyMaterialComes) {
  auto designs = found();
  auto answer = written(designs);
  EXPECT_TRUE(answer["profile"]["bound"].is_null()) << "of a profile without a bound";
  EXPECT_EQ(answer["verdict"]["bound"], "");
  designs.ranking[0].design.profiles[0].in_range = {1, 1};
  designs.bounded.targets = {designs.ranking[0].design.profiles[0].target};
  designs.bounded.weights = {1};
  designs.bounded.bounds.targets = {design::MaterialBound{{0.5, Eigen::Vector2d(2, 3)}, {}}};
  answer = written(designs);
  EXPECT_EQ(answer["profile"]["bound"], (json{{"deviation", 0.5}, {"y", {2.0, 3.0}}, {"together", nullptr}}));
  EXPECT_EQ(answer["verdict"]["bound"], "No material at rest comes nearer than 50 % to it.");
  designs.bounded.bounds.targets[0]->together = design::RestProfile{0.75, Eigen::Vector2d(2.5, 3.5)};
  EXPECT_EQ(written(designs)["profile"]["bound"]["together"], (json{{"deviation", 0.75}, {"y", {2.5, 3.5}}}));
}

TEST(DesignAnswers, SayHowSensitiveTheyAreToTheBeamWidth) {
  auto designs = found();
  EXPECT_TRUE(written(designs)["profile"]["beam_width_sensitivity"].is_null());
  designs.beam_width_sensitivity = {{0.125, std::nullopt}};
  EXPECT_EQ(written(designs)["profile"]["beam_width_sensitivity"], (json{{"wider", 0.125}, {"narrower", nullptr}}));
}

TEST(DesignAnswers, SayWhatWouldHelp) {
  auto designs = found();
  EXPECT_TRUE(written(designs)["ways_out"].is_array() && written(designs)["ways_out"].empty());
  design::WayOut shorter;
  shorter.change = design::WayOut::Change::shorten;
  shorter.sentence = "Shorten it.";
  shorter.parameters = Eigen::Vector2d(0.25, 0.75);
  shorter.orientation = 0.5;
  shorter.youngs_modulus = 26;
  shorter.range = {0, 0.125};
  shorter.deviation = 0.0625;
  design::WayOut family = shorter;
  family.change = design::WayOut::Change::family;
  family.other = 0;
  family.range.reset();
  designs.ways_out = {shorter, family};
  designs.other_models = {{"IH67", "ih67", "cc", 26, 0.48}};
  const auto ways = written(designs)["ways_out"];
  const json expected = {{"change", "shorten"},    {"sentence", "Shorten it."},  {"family", "IH21"},
                         {"model", "ih21"},        {"parameters", {0.25, 0.75}}, {"orientation", 0.5},
                         {"youngs_modulus", 26.0}, {"range", {0.0, 0.125}},      {"deviation", 0.0625}};
  EXPECT_EQ(ways[0], expected);
  EXPECT_EQ(ways[1]["family"], "IH67");
  EXPECT_EQ(ways[1]["model"], "ih67");
  EXPECT_TRUE(ways[1]["range"].is_null());
}

TEST(DesignAnswers, SayHowFarTheModelIsOff) {
  auto designs = found();
  designs.ranking[0].design.model_error = 0.0625;
  EXPECT_EQ(written(designs)["ranking"][0]["model_error"], 0.0625);
}

TEST(DesignAnswers, HaveNullWhereThereIsNoEquilibrium) {
  const auto profile = written(found())["profile"];
  EXPECT_TRUE(profile["initial"][0].is_null());
  EXPECT_EQ(profile["initial"][1], 3);
  EXPECT_EQ(profile["strain"], 0.05);
  EXPECT_FALSE(profile.contains("direction")) << "a profile over directions has none";
  EXPECT_TRUE(profile["envelope"].is_null() && profile["verified"].is_null());
  EXPECT_EQ(profile["in_range"], (json{true, false}));
}

TEST(DesignAnswers, HaveErrorBarsWhereTheModelHas) {
  auto designs = found();
  EXPECT_TRUE(written(designs)["profile"]["error_bar"].is_null());
  designs.ranking[0].design.profiles[0].error_bar = Eigen::Vector2d(0.25, missing);
  const auto bars = written(designs)["profile"]["error_bar"];
  EXPECT_EQ(bars[0], 0.25);
  EXPECT_TRUE(bars[1].is_null());
}

design::Polished polished() {
  design::Polished polished;
  polished.parameters = Eigen::Vector2d(0.125, 0.5);
  design::SampledTarget target;
  target.samples.x = {0, 1, 2};
  target.y = Eigen::Vector3d(3, 4, 5);
  target.weights = Eigen::Vector3d(0.25, 0.5, 0.25);
  target.bands = Eigen::Vector3d::Zero();
  target.scale = 2;
  polished.targets = {target};
  polished.simulated = {Eigen::Vector3d(3, 4, 6)};
  polished.model = {Eigen::Vector3d(3, 5, 6)};
  polished.target_error = 0.25;
  polished.rounds = {{design::Proposal::search, Eigen::Vector2d(0.25, 0.5), 0.125, std::nullopt, false, "No path.", 2},
                     {design::Proposal::step, Eigen::Vector2d(0.125, 0.5), 0.125, 0.25, true, "", 3}};
  polished.stopped = design::PolishTermination::time_limit;
  return polished;
}

TEST(DesignAnswers, CompareTheSimulationWithModelAndTarget) {
  auto designs = found();
  designs.verification = polished();
  const auto verified = written(designs)["profile"]["verified"];
  EXPECT_NEAR(verified["relative_rms"].get<double>(), 1 / std::sqrt(61.0), 1e-15);
  EXPECT_EQ(verified["target_error"], 0.25);
  EXPECT_TRUE(verified["discretization_error"].is_null()) << "nobody estimated it";
  EXPECT_EQ(verified["target"], (json{3.0, 4.0, 5.0}));
  EXPECT_EQ(verified["model"], (json{3.0, 5.0, 6.0}));
}

TEST(DesignAnswers, LetTheModelDecideOnlyWhereItIsTrusted) {
  auto designs = found();
  auto verdict = written(designs)["verdict"];
  EXPECT_EQ(verdict["grade"], "unknown") << "one of two samples is not trusted";
  EXPECT_EQ(verdict["source"], "model");
  EXPECT_EQ(verdict["deviation"], 1.5);
  EXPECT_NE(verdict["sentence"].get<std::string>().find("not trusted at 1 of 2 samples"), std::string::npos);
  designs.ranking[0].design.profiles[0].in_range = {1, 1};
  EXPECT_EQ(written(designs)["verdict"]["grade"], "missed");
  designs.ranking[0].design.profiles[0].achieved = Eigen::Vector2d(1, 2);
  EXPECT_EQ(written(designs)["verdict"]["grade"], "reached");
  designs.ranking[0].design.measures.reset();
  verdict = written(designs)["verdict"];
  EXPECT_EQ(verdict["grade"], "unknown");
  EXPECT_EQ(verdict["sentence"].get<std::string>().rfind("There is no such structure.", 0), 0U);
}

TEST(DesignAnswers, LetTheSimulationDecideWhereThereIsOne) {
  auto designs = found();
  designs.ranking[0].design.profiles[0].achieved = Eigen::Vector2d(1, 2);
  designs.verification = polished();
  const auto answer = written(designs);
  EXPECT_EQ(answer["verdict"]["grade"], "missed") << "although the model meets the target";
  EXPECT_EQ(answer["verdict"]["source"], "simulation");
  EXPECT_EQ(answer["verdict"]["deviation"], 0.25);
  EXPECT_EQ(answer["profile"]["ranges"], json::parse(R"([{"from": 0.0, "to": 1.5, "reached": true, "deviation": 0.0},
                            {"from": 1.5, "to": 2.0, "reached": false, "deviation": 0.5}])"));
  designs.verification->simulated = {Eigen::Vector3d(3, 4, missing)};
  const auto incomplete = written(designs);
  EXPECT_EQ(incomplete["verdict"]["grade"], "unknown");
  EXPECT_TRUE(incomplete["verdict"]["deviation"].is_null());
  EXPECT_TRUE(incomplete["profile"]["ranges"][1]["deviation"].is_null());
}

TEST(DesignAnswers, SayWhatTheMeshOfTheSimulationErrsBy) {
  auto designs = found();
  designs.verification = polished();
  designs.discretization_error = {0.0078125};
  EXPECT_EQ(written(designs)["profile"]["verified"]["discretization_error"], 0.0078125);
  designs.discretization_error = {std::nullopt};
  EXPECT_TRUE(written(designs)["profile"]["verified"]["discretization_error"].is_null());
}

TEST(DesignAnswers, CompareWithTheSimulationWhereItGotTo) {
  auto designs = found();
  designs.verification = polished();
  designs.verification->simulated = {Eigen::Vector3d(3, 4, missing)};
  const auto verified = written(designs)["profile"]["verified"];
  EXPECT_NEAR(verified["relative_rms"].get<double>(), 0.2, 1e-15);
  EXPECT_TRUE(verified["y"][2].is_null() && verified["target_error"].is_null());
}

TEST(DesignAnswers, TellWhatEachRoundOfPolishCameTo) {
  auto designs = found();
  designs.verification = polished();
  const auto polish = written(designs)["polish"];
  EXPECT_EQ(polish["target_error"], 0.25);
  EXPECT_EQ(polish["stopped"], "time_limit");
  EXPECT_EQ(polish["rounds"][0], (json{{"proposal", "search"},
                                       {"parameters", {0.25, 0.5}},
                                       {"orientation", 0.125},
                                       {"target_error", nullptr},
                                       {"accepted", false},
                                       {"reason", "No path."},
                                       {"seconds", 2.0}}));
  EXPECT_EQ(polish["rounds"][1]["target_error"], 0.25);
  EXPECT_EQ(polish["rounds"][1]["proposal"], "step");
  const auto partial = json::parse(write_partial_round("heel", {"IH21", "ih21", "bb"}, polished().rounds[0]));
  EXPECT_EQ(partial["round"], polish["rounds"][0]);
  EXPECT_EQ(partial["name"], "heel");
  EXPECT_EQ(partial["family"], "IH21");
}

TEST(DesignAnswers, StandInRegionsWithTheirNames) {
  auto designs = found();
  designs.spec.name = "heel";
  const auto answer = written(designs, true);
  EXPECT_EQ(answer["regions"][0]["name"], "heel");
  EXPECT_FALSE(answer.contains("family"));
}

TEST(DesignAnswers, PartialOnesCarryTheProfileSoFar) {
  const Eigen::Vector2d parameters(0.1, 0.2);
  const Eigen::VectorXd values = Eigen::Vector2d(1, 2);
  const Eigen::VectorXd all = parameters;
  const design::ProfileSamples samples{design::Task::poisson, 0, 0.05, design::StrainMeasure::green, {0, 1.5}};
  const auto partial =
      json::parse(write_partial_design("", {"IH21", "ih21", "bb"}, {0, all, 0.75, samples, values, {0.5, 1}, 4}));
  EXPECT_EQ(partial["achieved"], (json{1.0, 2.0}));
  EXPECT_EQ(partial["x"], (json{0.0, 1.5}));
  EXPECT_EQ(partial["iteration"], 4);
  EXPECT_EQ(partial["orientation"], 0.75);
  EXPECT_FALSE(partial.contains("name"));
}

}  // namespace
}  // namespace supple::json
