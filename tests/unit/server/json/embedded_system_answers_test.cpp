#include "supple/json/embedded_system_answers.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "supple/surface/triangle_mesh.h"
#include "support/expect_error.h"

namespace supple::json {
namespace {

/// A triangle, two points in it and a spring between them.
struct SmallNetwork {
  surface::TriangleMesh mesh = surface::TriangleMesh::build({{0, 0, 0}, {2, 0, 0}, {0, 2, 0}}, {{0, 1, 2}});
  EmbeddedSystemRequest request;
  embedded::Network network;
  embedded::Relaxation relaxation;

  SmallNetwork() {
    request.mesh = std::string(64, 'a');
    request.options.tolerance = 0.5;
    network.points = {{FaceId{0}, {1, 0, 0}}, {FaceId{0}, {0, 1, 0}}};
    network.springs = {{0, 1, 3, 4}};
    relaxation.points = {{FaceId{0}, {1, 0, 0}}, {FaceId{0}, {0.5, 0.5, 0}}};
    relaxation.springs.resize(1);
    relaxation.springs[0] = {1, 16, true, false, {}};
    relaxation.springs[0].path = {{relaxation.points[0], {0, 0, 0}}, {relaxation.points[1], {1, 0, 0}}};
    relaxation.energy = relaxation.network_energy = 16;
    relaxation.gradient_tolerance = 0.125;
    relaxation.gradient_norm = 0.25;
    relaxation.iterations = 1;
    relaxation.history = {{20, 2, 0, 0}, {16, 0.25, 1, 0.5}};
    relaxation.stopped = embedded::RelaxationTermination::iteration_limit;
    relaxation.at_vertices = {0};
    relaxation.loose_points = {1};
    relaxation.warnings = {"One."};
  }
  nlohmann::json written(const std::vector<std::array<std::int32_t, 3>>* triangles = nullptr) const {
    return nlohmann::json::parse(write_embedded_system(request, mesh, network, relaxation, triangles, {}));
  }
};

TEST(EmbeddedSystemAnswers, TellTheNetworkAndHowItWasFound) {
  const SmallNetwork small;
  const auto answer = small.written();
  EXPECT_EQ(answer.at("positions"), nlohmann::json::parse("[[0,0,0],[1,0,0]]"));
  EXPECT_EQ(answer.at("points").at(1), nlohmann::json::parse(R"({"face":0,"barycentric":[0.5,0.5,0]})"));
  EXPECT_EQ(
      answer.at("springs"),
      nlohmann::json::parse(R"([{"between":[0,1],"length":1,"energy":16,"compressed":true,"at_cut_locus":false}])"));
  EXPECT_EQ(answer.at("terms"), nlohmann::json::parse(R"([{"name":"geodesic_springs","energy":16}])"));
  EXPECT_EQ(answer.at("history").size(), 2U);
  EXPECT_EQ(answer.at("history").at(1).at("regularization"), 0.5);
  EXPECT_EQ(answer.at("stopped"), "iteration_limit");
  EXPECT_EQ(answer.at("at_vertices"), nlohmann::json::parse("[0]"));
  EXPECT_EQ(answer.at("loose_points"), nlohmann::json::parse("[1]"));
  EXPECT_EQ(answer.at("warnings"), nlohmann::json::parse(R"(["One."])"));
  EXPECT_FALSE(answer.contains("triangles"));
}

TEST(EmbeddedSystemAnswers, GiveTheToleranceAsAskedForAndAsABoundOfTheGradient) {
  const SmallNetwork small;
  EXPECT_EQ(small.written().at("accuracy").at("tolerance"), 0.5);
  EXPECT_EQ(small.written().at("accuracy").at("gradient_tolerance"), 0.125);
}

TEST(EmbeddedSystemAnswers, TellOfAHostThatGaveWay) {
  SmallNetwork small;
  EXPECT_FALSE(small.written().contains("host")) << "of a rigid one there is nothing to tell";
  small.relaxation.energy = 15;
  embedded::HostState& host = small.relaxation.host;
  host.terms = {{"solid", 2}, {"gravity", -3}};
  host.vertices = {{0, 0, 0}, {2, 0, 0.5}, {0, 2, 0}};
  host.largest_displacement = 0.5;
  const auto open = small.written();
  EXPECT_EQ(open.at("host"),
            nlohmann::json::parse(R"({"vertices":[[0,0,0],[2,0,0.5],[0,2,0]],"largest_displacement":0.5})"));
  EXPECT_EQ(open.at("energy"), 15);
  EXPECT_EQ(open.at("terms"), nlohmann::json::parse(R"([{"name":"geodesic_springs","energy":16},
                                                       {"name":"solid","energy":2},{"name":"gravity","energy":-3}])"));
  host.volume_ratio = 0.75;
  host.tetrahedra = {{0, 1, 2, 3}};
  host.inside = {{1, 1, 1}};
  const auto filled = small.written().at("host");
  EXPECT_EQ(filled.at("volume_ratio"), 0.75);
  EXPECT_EQ(filled.at("tetrahedra"), 1);
  EXPECT_EQ(filled.at("nodes"), 4);
}

TEST(EmbeddedSystemAnswers, HaveTheVerticesOfAMovingHostOnTheWay) {
  const SmallNetwork small;
  const auto partial = nlohmann::json::parse(
      write_partial_relaxation(3, small.relaxation.history[1], small.mesh, small.relaxation.points, true));
  EXPECT_EQ(partial.at("vertices"), nlohmann::json::parse("[[0,0,0],[2,0,0],[0,2,0]]"));
}

TEST(EmbeddedSystemAnswers, HavePathsTrianglesAndTheTermThatWereAskedFor) {
  SmallNetwork small;
  small.request.options.paths = true;
  small.request.options.spring_length = embedded::SpringLength::euclidean;
  const std::vector<std::array<std::int32_t, 3>> triangles{{2, 0, 1}};
  const auto answer = small.written(&triangles);
  EXPECT_EQ(answer.at("springs").at(0).at("path").size(), 2U);
  EXPECT_EQ(answer.at("triangles"), nlohmann::json::parse("[[2,0,1]]"));
  EXPECT_EQ(answer.at("terms").at(0).at("name"), "euclidean_springs");
}

TEST(EmbeddedSystemAnswers, TellTheMembraneAndItsShareOfTheEnergy) {
  SmallNetwork small;
  small.network.triangles = {{{0, 1, 2}, {1, 1, 1}}};
  small.network.material = {20, 0.3, 0.5};
  small.relaxation.triangles = {{6, {1.5, 0.75}, true}};
  const std::vector<std::array<std::int32_t, 3>> corners{{0, 1, 2}};
  const auto both = small.written(&corners);
  EXPECT_EQ(both.at("membrane"), nlohmann::json::parse(R"([{"energy":6,"stretches":[1.5,0.75],"at_cut_locus":true}])"));
  EXPECT_EQ(both.at("terms"),
            nlohmann::json::parse(R"([{"name":"geodesic_springs","energy":10},{"name":"membrane","energy":6}])"));
  small.network.springs.clear();
  small.relaxation.springs.clear();
  EXPECT_EQ(small.written(&corners).at("terms"), nlohmann::json::parse(R"([{"name":"membrane","energy":16}])"));
}

TEST(EmbeddedSystemAnswers, AreRefusedWhereANumberIsNotFinite) {
  SmallNetwork small;
  small.relaxation.energy = std::numeric_limits<double>::infinity();
  ::supple::testing::expect_error("computation.non_finite", [&] { small.written(); });
}

TEST(EmbeddedSystemAnswers, LeavePositionsOfLargeNetworksOutOfIntermediateStates) {
  const SmallNetwork small;
  const auto partial = [&](std::size_t count) {
    const std::vector<surface::SurfacePoint> points(count, small.relaxation.points[1]);
    return nlohmann::json::parse(write_partial_relaxation(3, small.relaxation.history[1], small.mesh, points, false));
  };
  EXPECT_EQ(partial(1),
            nlohmann::json::parse(R"({"iteration":3,"energy":16,"gradient_norm":0.25,"positions":[[1,0,0]]})"));
  EXPECT_EQ(partial(max_partial_positions).at("positions").size(), max_partial_positions);
  EXPECT_FALSE(partial(max_partial_positions + 1).contains("positions"));
}

}  // namespace
}  // namespace supple::json
