#include "supple/json/voronoi_requests.h"

#include <gtest/gtest.h>

#include "supple/problem/problem.h"
#include "support/expect_error.h"

namespace supple::json {
namespace {

using Where = std::vector<std::string>;

std::string voronoi_body(const std::string& fields) {
  return R"({"mesh":")" + std::string(64, 'a') + "\"," + fields + "}";
}

/// The body of a request with two sites and further fields.
std::string two_sites_and(const std::string& fields) {
  return voronoi_body(R"("sites":[{"vertex":0},{"face":1,"barycentric":[0.5,0.25,0.25]}])" +
                      (fields.empty() ? "" : "," + fields));
}

Where faults_of_diagram(const std::string& body) {
  return ::supple::testing::places(
      ::supple::testing::expect_error("request.invalid", [&] { parse_voronoi_diagram(body, {}); }));
}

Where faults_of_optimization(const std::string& body) {
  return ::supple::testing::places(
      ::supple::testing::expect_error("request.invalid", [&] { parse_voronoi_optimization(body, {}); }));
}

TEST(VoronoiRequests, HaveTheDefaultsOfTheContract) {
  const auto request = parse_voronoi_diagram(two_sites_and(""), {});
  ASSERT_EQ(std::get<0>(request.sites).size(), 2U);
  EXPECT_TRUE(std::get<0>(request.sites)[0].by_vertex);
  EXPECT_EQ(request.options.method, voronoi::DiagramMethod::exact);
  EXPECT_EQ(request.options.border_deviation, 1e-5);
  EXPECT_FALSE(request.include.points);
  EXPECT_FALSE(request.include.pieces);
  EXPECT_TRUE(request.statistics);
  EXPECT_EQ(request.panel_scale, 1);
  EXPECT_EQ(request.deadline, 600);
}

TEST(VoronoiRequests, ReadEveryFieldOfADiagram) {
  const auto request = parse_voronoi_diagram(voronoi_body(R"("sites":{"count":12,"seed":7},
      "accuracy":{"method":"bounded","relative_error":0.25,"border_deviation":0.001},"points":true,"pieces":true,"statistics":false,
      "panel_scale":250,"deadline":5)"),
                                             {});
  EXPECT_EQ(std::get<RandomSites>(request.sites).count, 12);
  EXPECT_EQ(std::get<RandomSites>(request.sites).seed, 7U);
  EXPECT_EQ(request.options.method, voronoi::DiagramMethod::bounded);
  EXPECT_EQ(request.options.relative_error, 0.25);
  EXPECT_EQ(request.options.border_deviation, 0.001);
  EXPECT_TRUE(request.include.points);
  EXPECT_TRUE(request.include.pieces);
  EXPECT_FALSE(request.statistics);
  EXPECT_EQ(request.panel_scale, 250);
  EXPECT_EQ(request.deadline, 5);
}

TEST(VoronoiRequests, ReadEveryFieldOfAnOptimization) {
  const auto request = parse_voronoi_optimization(two_sites_and(R"("objectives":{"edge_length":1,"planarity":2,
      "regularity":3,"centroidal":4,"equal_area":5},"target_length":0.5,"fixed_sites":[1,0],"method":"lbfgs",
      "accuracy":{"tolerance":0.125,"border_deviation":0.01},"max_iterations":7,"points":true,"pieces":true,"panel_scale":2,"deadline":9)"),
                                                  {});
  const auto& options = request.options;
  EXPECT_EQ(options.weights.edge_length, 1);
  EXPECT_EQ(options.weights.planarity, 2);
  EXPECT_EQ(options.weights.regularity, 3);
  EXPECT_EQ(options.weights.centroidal, 4);
  EXPECT_EQ(options.weights.equal_area, 5);
  EXPECT_EQ(options.edge_length, 0.5);
  EXPECT_EQ(options.fixed_sites, (std::vector<std::int32_t>{1, 0}));
  EXPECT_EQ(options.method, voronoi::OptimizationMethod::lbfgs);
  EXPECT_EQ(options.tolerance, 0.125);
  EXPECT_EQ(options.border_deviation, 0.01);
  EXPECT_EQ(options.max_iterations, 7);
  EXPECT_TRUE(request.include.points && request.include.pieces);
  EXPECT_EQ(request.panel_scale, 2);
  EXPECT_EQ(request.deadline, 9);
}

TEST(VoronoiRequests, CollectEveryFault) {
  EXPECT_EQ(faults_of_diagram(voronoi_body(R"("site":[])")), (Where{"/sites", "/site"}));
  EXPECT_EQ(faults_of_diagram(voronoi_body(R"("sites":[])")), (Where{"/sites"}));
  EXPECT_EQ(faults_of_diagram(voronoi_body(R"("sites":{"count":0,"seed":-1,"radius":1})")),
            (Where{"/sites/count", "/sites/seed", "/sites/radius"}));
  EXPECT_EQ(faults_of_diagram(voronoi_body(R"("sites":{"seed":1})")), (Where{"/sites/count"}));
  EXPECT_EQ(faults_of_diagram(two_sites_and(
                R"("accuracy":{"method":"fast","relative_error":0},"points":1,"panel_scale":0,"deadline":0)")),
            (Where{"/accuracy/method", "/accuracy/relative_error", "/accuracy/relative_error", "/points",
                   "/panel_scale", "/deadline"}));
  EXPECT_EQ(faults_of_optimization(two_sites_and(R"("fixed_sites":[-1],"method":"newton","max_iterations":0)")),
            (Where{"/objectives", "/fixed_sites/0", "/method", "/max_iterations"}));
  EXPECT_EQ(
      faults_of_optimization(two_sites_and(
          R"("objectives":{"area":1,"planarity":-1},"target_length":0,"accuracy":{"tolerance":2},"statistics":true)")),
      (Where{"/objectives/planarity", "/objectives/area", "/target_length", "/accuracy/tolerance", "/statistics"}));
}

TEST(VoronoiRequests, AskForNoMoreIterationsThanTheEngineDoes) {
  const std::string most = std::to_string(voronoi::max_optimization_iterations);
  const std::string more = std::to_string(voronoi::max_optimization_iterations + 1);
  const auto asking = [](const std::string& number) {
    return two_sites_and(R"("objectives":{"planarity":1},"max_iterations":)" + number);
  };
  EXPECT_EQ(parse_voronoi_optimization(asking(most), {}).options.max_iterations, voronoi::max_optimization_iterations);
  EXPECT_EQ(faults_of_optimization(asking(more)), (Where{"/max_iterations"}));
}

TEST(VoronoiRequests, NeedAnObjectiveByItsName) {
  EXPECT_EQ(faults_of_optimization(two_sites_and(R"("objectives":{})")), (Where{"/objectives"}));
  // The engine checks whether a weight is above 0.
  EXPECT_NO_THROW(parse_voronoi_optimization(two_sites_and(R"("objectives":{"planarity":0})"), {}));
}

TEST(VoronoiRequests, TakeARelativeErrorWithTheMethodThatHasOneOnly) {
  EXPECT_EQ(faults_of_diagram(two_sites_and(R"("accuracy":{"relative_error":0.1})")),
            (Where{"/accuracy/relative_error"}));
  EXPECT_EQ(faults_of_diagram(two_sites_and(R"("accuracy":{"method":"edges","relative_error":0.1})")),
            (Where{"/accuracy/relative_error"}));
}

TEST(VoronoiRequests, DrawBordersNoFinerThanTheEngineDoes) {
  for (const char* deviation : {"0", "0.99e-7", "1.01", "\"fine\""})
    EXPECT_EQ(faults_of_diagram(two_sites_and(R"("accuracy":{"border_deviation":)" + std::string(deviation) + "}")),
              (Where{"/accuracy/border_deviation"}))
        << deviation;
  for (const char* deviation : {"1e-7", "1"})
    EXPECT_NO_THROW(
        parse_voronoi_diagram(two_sites_and(R"("accuracy":{"border_deviation":)" + std::string(deviation) + "}"), {}));
}

TEST(VoronoiRequests, RefuseMoreSitesThanTheLimitByItsSetting) {
  Limits limits;
  limits.max_points = 1;
  const auto refusal = [&](const std::string& body) -> problem::Problem {
    try {
      parse_voronoi_diagram(body, limits);
    } catch (const problem::ProblemError& error) {
      return error.problem();
    }
    ADD_FAILURE() << "taken: " << body;
    return {};
  };
  for (const auto& [body, where, count] : std::vector<std::tuple<std::string, std::string, double>>{
           {two_sites_and(""), "/sites", 2}, {voronoi_body(R"("sites":{"count":10000000})"), "/sites/count", 1e7}}) {
    const auto problem = refusal(body);
    EXPECT_EQ(problem.code, "request.limit_exceeded");
    ASSERT_EQ(problem.errors.size(), 1U);
    EXPECT_EQ(problem.errors[0].where, where);
    ASSERT_TRUE(problem.limit);
    EXPECT_EQ(problem.limit->setting, "--max-points");
    EXPECT_EQ(problem.limit->limit, 1);
    EXPECT_EQ(problem.limit->value, count);
  }
}

}  // namespace
}  // namespace supple::json
