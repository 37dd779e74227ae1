#include "supple/json/model_requests.h"

#include <gtest/gtest.h>

#include "supple/problem/problem.h"
#include "support/expect_error.h"

namespace supple::json {
namespace {

using Pointers = std::vector<std::string>;

Pointers faults_of_evaluation(const std::string& body) {
  return testing::places(testing::expect_error("request.invalid", [&] { parse_evaluation(body, {}); }));
}

Pointers faults_of_uniaxial(const std::string& fields) {
  return testing::places(testing::expect_error(
      "request.invalid", [&] { parse_uniaxial("{\"parameters\":[1],\"direction\":0," + fields + "}", {}); }));
}

TEST(EvaluationRequests, ReadEveryFieldAndDoubleTheShear) {
  const auto request = parse_evaluation(
      R"({"parameters":[[0.1,0.2],[0.3]],"green_strain":[[0.01,-0.02,0.03],[1,2,3]],"derivatives":2,"deadline":9})",
      {});
  EXPECT_EQ(request.designs, (std::vector<std::vector<double>>{{0.1, 0.2}, {0.3}}));
  ASSERT_EQ(request.strains.cols(), 2);
  EXPECT_EQ(request.strains.col(0), Eigen::Vector3d(0.01, -0.02, 0.06)) << "the engine wants 2 E_xy";
  EXPECT_EQ(request.strains.col(1), Eigen::Vector3d(1, 2, 6));
  EXPECT_EQ(request.order, neural::Order::tangent);
  EXPECT_EQ(request.deadline, 9);
}

TEST(EvaluationRequests, AskForStressesUnlessTheySay) {
  const auto order = [](const std::string& more) {
    return parse_evaluation("{\"parameters\":[[1]],\"green_strain\":[[0,0,0]]" + more + "}", {}).order;
  };
  EXPECT_EQ(order(""), neural::Order::stress);
  EXPECT_EQ(order(R"(,"derivatives":0)"), neural::Order::energy);
}

TEST(EvaluationRequests, PointToEachFieldAtFault) {
  EXPECT_EQ(
      faults_of_evaluation(
          R"({"parameters":[[1,"x"],[],3],"green_strain":[[0,0],[0,0,null],[0,101,0]],"derivatives":3,"strain":1})"),
      (Pointers{"/parameters/0/1", "/parameters/1", "/parameters/2", "/green_strain/0", "/green_strain/1/2",
                "/green_strain/2/1", "/derivatives", "/strain"}));
  EXPECT_EQ(faults_of_evaluation("{}"), (Pointers{"/parameters", "/green_strain"}));
  EXPECT_EQ(faults_of_evaluation(R"({"parameters":[],"green_strain":[]})"), (Pointers{"/parameters", "/green_strain"}));
  EXPECT_EQ(faults_of_evaluation(R"({"parameters":[[1,1,1,1,1,1,1,1,1]],"green_strain":[[0,0,0]]})"),
            Pointers{"/parameters/0"});
  EXPECT_EQ(faults_of_evaluation("[]"), Pointers{""});
}

TEST(EvaluationRequests, NameTheSettingOfTheLimit) {
  Limits limits;
  limits.max_strains = 2;
  for (const char* body : {R"({"parameters":[[1]],"green_strain":[[0,0,0],[0,0,0],[0,0,0]]})",
                           R"({"parameters":[[1],[1],[1]],"green_strain":[[0,0,0]]})"}) {
    try {
      parse_evaluation(body, limits);
      FAIL() << "nothing was thrown";
    } catch (const problem::ProblemError& error) {
      EXPECT_EQ(error.code(), "request.limit_exceeded");
      ASSERT_TRUE(error.problem().limit);
      EXPECT_EQ(error.problem().limit->setting, "--max-strains");
      EXPECT_EQ(error.problem().limit->value, 3);
    }
  }
}

TEST(UniaxialRequests, ReadEveryField) {
  const auto request = parse_uniaxial(
      R"({"parameters":[0.1,0.2],"direction":0.5,"green_strains":[0.01,-0.02],"accuracy":{"tolerance":1e-6,"max_iterations":7},
          "deadline":3})",
      {});
  EXPECT_EQ(request.parameters, (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(request.direction, 0.5);
  EXPECT_EQ(request.green_strains, (std::vector<double>{0.01, -0.02}));
  EXPECT_EQ(request.options.tolerance, 1e-6);
  EXPECT_EQ(request.options.max_iterations, 7);
  EXPECT_EQ(request.deadline, 3);
}

TEST(UniaxialRequests, TurnStretchesIntoStrains) {
  const auto request = parse_uniaxial(R"({"parameters":[1],"direction":0,"stretches":[1,2,0.5]})", {});
  EXPECT_EQ(request.green_strains, (std::vector<double>{0, 1.5, -0.375}));
}

TEST(UniaxialRequests, PointToEachFieldAtFault) {
  EXPECT_EQ(faults_of_uniaxial(R"("stretches":[1.1,0.1,5])"), (Pointers{"/stretches/1", "/stretches/2"}));
  EXPECT_EQ(faults_of_uniaxial(R"("green_strains":[0,-0.5,8])"), (Pointers{"/green_strains/1", "/green_strains/2"}));
  EXPECT_EQ(faults_of_uniaxial(R"("stretches":[1],"green_strains":[0])"), Pointers{""});
  EXPECT_EQ(faults_of_uniaxial(R"("deadline":1)"), Pointers{""});
  EXPECT_EQ(faults_of_uniaxial(R"("stretches":[])"), Pointers{"/stretches"});
  EXPECT_EQ(faults_of_uniaxial(R"("stretches":[1],"accuracy":{"tolerance":1,"max_iterations":0,"steps":3})"),
            (Pointers{"/accuracy/tolerance", "/accuracy/max_iterations", "/accuracy/steps"}));
  const auto missing = testing::expect_error("request.invalid", [] { parse_uniaxial(R"({"stretches":[1]})", {}); });
  EXPECT_EQ(testing::places(missing), (Pointers{"/parameters", "/direction"}));
}

}  // namespace
}  // namespace supple::json
