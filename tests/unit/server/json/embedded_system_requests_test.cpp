#include "supple/json/embedded_system_requests.h"

#include <gtest/gtest.h>

#include "supple/problem/problem.h"
#include "support/expect_error.h"

namespace supple::json {
namespace {

using Where = std::vector<std::string>;

std::string network_body(const std::string& fields) {
  return R"({"mesh":")" + std::string(64, 'a') + "\"," + fields + "}";
}

/// The body of a request for a network of two points and a spring, with further fields.
std::string two_points_and(const std::string& fields) {
  return network_body(R"("points":[{"vertex":0},{"vertex":1}],"springs":[{"between":[0,1]}])" +
                      (fields.empty() ? "" : "," + fields));
}

Where faults_of_network(const std::string& body) {
  return ::supple::testing::places(
      ::supple::testing::expect_error("request.invalid", [&] { parse_embedded_system(body, {}); }));
}

TEST(EmbeddedSystemRequests, HaveTheDefaultsOfTheContract) {
  const auto request = parse_embedded_system(two_points_and(""), {});
  EXPECT_EQ(std::get<0>(request.points).size(), 2U);
  const auto& springs = std::get<0>(request.springs);
  ASSERT_EQ(springs.size(), 1U);
  EXPECT_EQ(springs[0].from, 0);
  EXPECT_EQ(springs[0].to, 1);
  EXPECT_EQ(springs[0].rest_length, 0);
  EXPECT_EQ(springs[0].weight, 1);
  EXPECT_TRUE(request.fixed_points.empty());
  EXPECT_EQ(request.options.method, embedded::RelaxationMethod::newton);
  EXPECT_EQ(request.options.spring_length, embedded::SpringLength::geodesic);
  EXPECT_EQ(request.options.tolerance, 1e-9);
  EXPECT_EQ(request.options.mollifier_length, 1e-6);
  EXPECT_EQ(request.options.max_iterations, 200);
  EXPECT_EQ(request.options.mollifier, Switch::automatic);
  EXPECT_EQ(request.options.kept_strips, Switch::automatic);
  EXPECT_FALSE(request.options.paths);
  EXPECT_EQ(request.deadline, 600);
}

TEST(EmbeddedSystemRequests, ReadEveryField) {
  const auto request =
      parse_embedded_system(network_body(R"("points":[{"vertex":3},{"face":1,"barycentric":[0.5,0.25,0.25]}],
                      "springs":[{"between":[1,0],"rest_length":0.5,"weight":2}],"fixed_points":[1,0],
                      "host":{"kind":"rigid"},"method":"gradient_descent","spring_length":"euclidean",
                      "accuracy":{"tolerance":1e-6,"mollifier_length":0.1},"max_iterations":7,"paths":true,
                      "effects":{"mollifier":"on","kept_strips":"off"},"deadline":5)"),
                            {});
  EXPECT_FALSE(std::get<0>(request.points)[1].by_vertex);
  const auto& spring = std::get<0>(request.springs)[0];
  EXPECT_EQ(spring.from, 1);
  EXPECT_EQ(spring.rest_length, 0.5);
  EXPECT_EQ(spring.weight, 2);
  EXPECT_EQ(request.fixed_points, (std::vector<std::int32_t>{1, 0}));
  EXPECT_EQ(request.options.method, embedded::RelaxationMethod::gradient_descent);
  EXPECT_EQ(request.options.spring_length, embedded::SpringLength::euclidean);
  EXPECT_EQ(request.options.tolerance, 1e-6);
  EXPECT_EQ(request.options.mollifier_length, 0.1);
  EXPECT_EQ(request.options.max_iterations, 7);
  EXPECT_TRUE(request.options.paths);
  EXPECT_EQ(request.options.mollifier, Switch::on);
  EXPECT_EQ(request.options.kept_strips, Switch::off);
  EXPECT_EQ(request.deadline, 5);
}

TEST(EmbeddedSystemRequests, ReadBuildersInPlaceOfArrays) {
  const auto in_faces = parse_embedded_system(network_body(R"("points":{"kind":"per_face","barycentric":[0.2,0.3,0.5]},
                      "springs":{"kind":"adjacent_faces","rest_length":3,"weight":0.5})"),
                                              {});
  EXPECT_EQ(std::get<embedded::PointsInFaces>(in_faces.points).barycentric, Eigen::Vector3d(0.2, 0.3, 0.5));
  EXPECT_EQ(std::get<embedded::NeighbourSprings>(in_faces.springs).kind,
            embedded::NeighbourSprings::Kind::adjacent_faces);
  EXPECT_EQ(std::get<embedded::NeighbourSprings>(in_faces.springs).rest_length, 3);
  EXPECT_EQ(std::get<embedded::NeighbourSprings>(in_faces.springs).weight, 0.5);
  const auto random = parse_embedded_system(
      network_body(R"("points":{"kind":"poisson_disk","radius":0.25,"seed":9},"springs":{"kind":"voronoi_dual"})"), {});
  EXPECT_EQ(std::get<embedded::PoissonDiskPoints>(random.points).radius, 0.25);
  EXPECT_EQ(std::get<embedded::PoissonDiskPoints>(random.points).seed, 9U);
  EXPECT_EQ(std::get<embedded::NeighbourSprings>(random.springs).kind, embedded::NeighbourSprings::Kind::voronoi_dual);
  EXPECT_EQ(std::get<embedded::NeighbourSprings>(random.springs).weight, 1);
}

TEST(EmbeddedSystemRequests, ReadMembranes) {
  const auto none = parse_embedded_system(two_points_and(""), {});
  EXPECT_TRUE(std::get<0>(none.triangles).empty());
  EXPECT_EQ(none.material.youngs_modulus, 1);
  EXPECT_EQ(none.material.poisson_ratio, 0.3);
  EXPECT_EQ(none.material.thickness, 1);
  EXPECT_EQ(none.rest_scale, 1);
  const auto given = parse_embedded_system(two_points_and(R"("triangles":[[0,1,2],[2,1,3]],
                     "membrane":{"youngs_modulus":7,"poisson_ratio":-0.5,"thickness":0.1,"rest_scale":0.9})"),
                                           {});
  EXPECT_EQ(std::get<0>(given.triangles), (std::vector<std::array<std::int32_t, 3>>{{0, 1, 2}, {2, 1, 3}}));
  EXPECT_EQ(given.material.youngs_modulus, 7);
  EXPECT_EQ(given.material.poisson_ratio, -0.5);
  EXPECT_EQ(given.material.thickness, 0.1);
  EXPECT_EQ(given.rest_scale, 0.9);
  EXPECT_EQ(parse_embedded_system(two_points_and(R"("triangles":{"kind":"voronoi_dual"})"), {}).triangles.index(), 1U);
}

TEST(EmbeddedSystemRequests, PointToEachFaultyFieldOfAMembrane) {
  EXPECT_EQ(faults_of_network(two_points_and(R"("triangles":[[0,1],7,[0,1,-2]])")),
            (Where{"/triangles/0", "/triangles/1", "/triangles/2/2"}));
  EXPECT_EQ(faults_of_network(two_points_and(R"("triangles":{"kind":"delaunay"})")), Where{"/triangles/kind"});
  EXPECT_EQ(faults_of_network(two_points_and(R"("triangles":{})")), Where{"/triangles/kind"});
  EXPECT_EQ(faults_of_network(two_points_and(
                R"("membrane":{"youngs_modulus":0,"poisson_ratio":0.5,"thickness":-1,"rest_scale":0,"mass":1})")),
            (Where{"/membrane/youngs_modulus", "/membrane/poisson_ratio", "/membrane/thickness", "/membrane/rest_scale",
                   "/membrane/mass"}));
}

TEST(EmbeddedSystemRequests, ReadHosts) {
  EXPECT_TRUE(std::holds_alternative<embedded::RigidHost>(parse_embedded_system(two_points_and(""), {}).options.host));
  const auto shell = std::get<embedded::ShellHost>(
      parse_embedded_system(
          two_points_and(R"("host":{"kind":"shell","thickness":0.5,"youngs_modulus":7,"poisson_ratio":0.2,
        "volume_weight":3,"volume_scale":1.5,"fixed_vertices":[4,0]},"effects":{"bending":"off"})"),
          {})
          .options.host);
  EXPECT_EQ(shell.thickness, 0.5);
  EXPECT_EQ(shell.youngs_modulus, 7);
  EXPECT_EQ(shell.poisson_ratio, 0.2);
  EXPECT_EQ(shell.volume_weight, 3);
  EXPECT_EQ(shell.volume_scale, 1.5);
  EXPECT_EQ(shell.fixed_vertices, (std::vector<std::int32_t>{4, 0}));
  EXPECT_FALSE(shell.bending);
  const auto solid = std::get<embedded::SolidHost>(
      parse_embedded_system(
          two_points_and(R"("host":{"kind":"solid","youngs_modulus":7,"element_size":2,"gravity":[0,0,-9],
        "fixed_vertices":[1],"regions":[{"lower":[0,1,2],"upper":[3,4,5],"youngs_modulus":70}]})"),
          {})
          .options.host);
  EXPECT_EQ(solid.poisson_ratio, 0.3) << "the contract's default";
  EXPECT_EQ(solid.element_size, 2);
  EXPECT_EQ(solid.gravity, Eigen::Vector3d(0, 0, -9));
  ASSERT_EQ(solid.regions.size(), 1U);
  EXPECT_EQ(solid.regions[0].lower, Eigen::Vector3d(0, 1, 2));
  EXPECT_EQ(solid.regions[0].upper, Eigen::Vector3d(3, 4, 5));
  EXPECT_EQ(solid.regions[0].youngs_modulus, 70);
}

TEST(EmbeddedSystemRequests, ReadPositionsOfAMovingHost) {
  const auto moving = std::get<embedded::MovingHost>(
      parse_embedded_system(
          two_points_and(R"("host":{"kind":"moving","positions":[[[0,1,2],[3,4,5]],[[6,7,8],[9,10,11]]]})"), {})
          .options.host);
  ASSERT_EQ(moving.positions.size(), 2U);
  EXPECT_EQ(moving.positions[1], (std::vector<Eigen::Vector3d>{{6, 7, 8}, {9, 10, 11}}));
  EXPECT_EQ(faults_of_network(two_points_and(R"("host":{"kind":"moving"})")), Where{"/host/positions"});
  EXPECT_EQ(faults_of_network(two_points_and(R"("host":{"kind":"moving","positions":[]})")), Where{"/host/positions"});
  EXPECT_EQ(faults_of_network(two_points_and(R"("host":{"kind":"moving","positions":[[[0,0,0],[1,2]],3]})")),
            (Where{"/host/positions/0/1", "/host/positions/1"}));
}

TEST(EmbeddedSystemRequests, PointToEachFaultyFieldOfAHost) {
  EXPECT_EQ(faults_of_network(two_points_and(R"("host":{"kind":"shell"})")),
            (Where{"/host/thickness", "/host/youngs_modulus"}));
  EXPECT_EQ(faults_of_network(two_points_and(
                R"("host":{"kind":"shell","thickness":0,"youngs_modulus":1,"poisson_ratio":0.5,"gravity":[0,0,1]})")),
            (Where{"/host/thickness", "/host/poisson_ratio", "/host/gravity"}));
  EXPECT_EQ(
      faults_of_network(two_points_and(
          R"("host":{"kind":"solid","youngs_modulus":1,"gravity":[1,2],"fixed_vertices":[-1],"regions":[{"lower":[0,0,0]}]})")),
      (Where{"/host/gravity", "/host/fixed_vertices/0", "/host/regions/0/upper", "/host/regions/0/youngs_modulus"}));
}

TEST(EmbeddedSystemRequests, PointToEachFaultyEntry) {
  const auto springs = [](const std::string& entries) {
    return network_body(R"("points":[{"vertex":0},{"vertex":1}],"springs":[)" + entries + "]");
  };
  EXPECT_EQ(faults_of_network(network_body(R"("springs":[])")), Where{"/points"});
  EXPECT_EQ(faults_of_network(network_body(R"("points":[{"vertex":0}])")), Where{"/springs"});
  EXPECT_EQ(faults_of_network(network_body(R"("points":[],"springs":[])")), Where{"/points"});
  EXPECT_EQ(faults_of_network(network_body(R"("points":"all","springs":7)")), (Where{"/points", "/springs"}));
  EXPECT_EQ(faults_of_network(springs(R"({"between":[0,1]},{"between":[0,-1]},{})")),
            (Where{"/springs/1/between/1", "/springs/2/between"}));
  EXPECT_EQ(faults_of_network(springs(R"({"between":[0,1,2]},{"between":[0,1],"weigth":2})")),
            (Where{"/springs/0/between", "/springs/1/weigth"}));
  EXPECT_EQ(faults_of_network(springs(R"({"between":[0,1],"weight":-1},{"between":[0,1],"rest_length":-0.5})")),
            (Where{"/springs/0/weight", "/springs/1/rest_length"}));
  EXPECT_EQ(faults_of_network(two_points_and(R"("fixed_points":[0,1.5])")), Where{"/fixed_points/1"});
  EXPECT_EQ(faults_of_network(two_points_and(R"("host":{"kind":"elastic"})")), Where{"/host/kind"});
  EXPECT_EQ(faults_of_network(two_points_and(R"("host":{})")), Where{"/host/kind"});
  EXPECT_EQ(faults_of_network(two_points_and(R"("accuracy":{"tolerance":0,"mollifier_length":1})")),
            (Where{"/accuracy/tolerance", "/accuracy/mollifier_length"}));
  EXPECT_EQ(faults_of_network(two_points_and(R"("max_iterations":0,"paths":1,"method":"magic")")),
            (Where{"/method", "/max_iterations", "/paths"}));
  EXPECT_EQ(faults_of_network(two_points_and(R"("effects":{"mollifier":true})")), Where{"/effects/mollifier"});
}

TEST(EmbeddedSystemRequests, PointToTheFaultsOfBuilders) {
  const auto built = [](const std::string& points, const std::string& springs) {
    return faults_of_network(network_body("\"points\":" + points + ",\"springs\":" + springs));
  };
  const std::string centres = R"({"kind":"per_face","barycentric":[0.2,0.3,0.5]})";
  const std::string dual = R"({"kind":"voronoi_dual"})";
  EXPECT_EQ(built("{}", dual), Where{"/points/kind"});
  EXPECT_EQ(built(R"({"kind":"everywhere","radius":1})", dual), Where{"/points/kind"});
  EXPECT_EQ(built(R"({"kind":"per_face"})", dual), Where{"/points/barycentric"});
  EXPECT_EQ(built(R"({"kind":"per_face","barycentric":[1,0]})", dual), Where{"/points/barycentric"});
  EXPECT_EQ(built(R"({"kind":"per_face","barycentric":[1,0,0],"radius":1})", dual), Where{"/points/radius"});
  EXPECT_EQ(built(R"({"kind":"poisson_disk"})", dual), Where{"/points/radius"});
  EXPECT_EQ(built(R"({"kind":"poisson_disk","radius":0})", dual), Where{"/points/radius"});
  EXPECT_EQ(built(R"({"kind":"poisson_disk","radius":1,"seed":-1})", dual), Where{"/points/seed"});
  EXPECT_EQ(built(centres, R"({"kind":"all_pairs"})"), Where{"/springs/kind"});
  EXPECT_EQ(built(centres, R"({"weight":1})"), Where{"/springs/kind"});
  EXPECT_EQ(built(centres, R"({"kind":"voronoi_dual","weight":-1,"rest_length":-1})"),
            (Where{"/springs/rest_length", "/springs/weight"}));
}

TEST(EmbeddedSystemRequests, AreRefusedBeyondTheLimitsWithTheFieldAndTheSetting) {
  Limits limits;
  limits.max_points = 2;
  limits.max_springs = 3;
  const auto limit_of = [&](const std::string& body) -> problem::Problem {
    try {
      parse_embedded_system(body, limits);
    } catch (const problem::ProblemError& error) {
      return error.problem();
    }
    ADD_FAILURE() << "was not refused";
    return {};
  };
  const auto points = limit_of(network_body(R"("points":[{"vertex":0},{"vertex":1},{"vertex":2}],"springs":[])"));
  EXPECT_EQ(points.code, "request.limit_exceeded");
  EXPECT_EQ(points.errors.at(0).where, "/points");
  EXPECT_EQ(points.limit->setting, "--max-points");
  const std::string spring = R"({"between":[0,1]})";
  const auto springs = limit_of(network_body(R"("points":[{"vertex":0},{"vertex":1}],"springs":[)" + spring + "," +
                                             spring + "," + spring + "," + spring + "]"));
  EXPECT_EQ(springs.errors.at(0).where, "/springs");
  EXPECT_EQ(springs.limit->setting, "--max-springs");
  EXPECT_EQ(springs.limit->limit, 3);
  EXPECT_EQ(springs.limit->value, 4);
  EXPECT_EQ(limit_of(two_points_and(R"("fixed_points":[0,1,0])")).errors.at(0).where, "/fixed_points");
}

}  // namespace
}  // namespace supple::json
