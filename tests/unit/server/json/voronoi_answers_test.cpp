#include "supple/json/voronoi_answers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <numeric>

#include "supple/problem/problem.h"
#include "supple/surface/triangle_mesh.h"
#include "support/expect_error.h"

namespace supple::json {
namespace {

using nlohmann::json;
using voronoi::DiagramPoint;

/// Two sites on a square of two faces, whose border runs from its lower to its upper side across the diagonal.
struct SmallDiagram {
  surface::TriangleMesh mesh =
      surface::TriangleMesh::build({{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}}, {{0, 1, 2}, {0, 2, 3}});
  VoronoiDiagramRequest request;
  voronoi::Diagram diagram;
  voronoi::DiagramStatistics statistics;

  SmallDiagram() {
    request.mesh = std::string(64, 'a');
    diagram.sites = {{FaceId{1}, {0, 0, 1}}, {FaceId{0}, {0, 1, 0}}};
    diagram.points = {
        {DiagramPoint::Kind::crossing, {FaceId{0}, {0.5, 0.5, 0}}, {1, 0, 0}, 1},
        {DiagramPoint::Kind::vertex, {FaceId{0}, {0.5, 0, 0.5}}, {1, 1, 0}, 1.5},
        {DiagramPoint::Kind::crossing, {FaceId{1}, {0, 0.5, 0.5}}, {1, 2, 0}, 1},
    };
    diagram.vertices = {{1, {0, 1, 1}}};
    diagram.edges = {{{0, 1}, {-1, 0}, {0, 1}, 1}};
    diagram.cells.resize(2);
    diagram.cells[0].area = 2.5;
    diagram.cells[0].boundary = {{0, 1, 2}};
    diagram.cells[0].neighbours = {1};
    diagram.cells[1].area = 1.5;
    diagram.cells[1].neighbours = {0};
    diagram.dual = {{0, 1, 1}};
    diagram.vertex_sites = {0, 1, 1, -1};
    diagram.face_sites = {-1, -2};
    diagram.pieces = {{1, 0, 1, 3, 0.75}};
    diagram.corners = {{1, 0, 0}, {0.5, 0.5, 0}, {0, 1, 0}, {0, 0, 1}};
    diagram.unreached_area = 0.25;
    diagram.warnings = {"One."};
    statistics.area = {2, 1.5, 2.5, 0.5};
  }

  json written() const { return json::parse(write_voronoi_diagram(request, mesh, diagram, &statistics, {}, {})); }
};

TEST(VoronoiAnswers, TellCellsVerticesEdgesAndTheDual) {
  const SmallDiagram small;
  const auto answer = small.written();
  EXPECT_EQ(answer.at("sites").at(1), json::parse(R"({"face":0,"barycentric":[0,1,0]})"));
  EXPECT_EQ(answer.at("site_positions"), json::parse("[[0,2,0],[2,0,0]]"));
  EXPECT_EQ(answer.at("cells"), json::parse(R"([{"site":0,"area":2.5,"boundary":[[0,1,2]],"neighbours":[1]},
                                                {"site":1,"area":1.5,"boundary":[],"neighbours":[0]}])"));
  EXPECT_EQ(answer.at("vertices"), json::parse(R"([{"point":{"face":0,"barycentric":[0.5,0,0.5]},"position":[1,1,0],
                                                    "sites":[0,1,1],"distance":1.5,"index":1}])"));
  EXPECT_EQ(answer.at("edges"), json::parse(R"([{"sites":[0,1],"vertices":[null,0],"length":1,"points":[0,1]}])"));
  EXPECT_EQ(answer.at("dual"), json::parse("[[0,1,1]]"));
  EXPECT_EQ(answer.at("positions"), json::parse("[[1,0,0],[1,1,0],[1,2,0]]"));
  EXPECT_EQ(answer.at("unreached_area"), 0.25);
  EXPECT_EQ(answer.at("warnings"), json::parse(R"(["One."])"));
  EXPECT_EQ(answer.at("statistics").at("area"),
            json::parse(R"({"mean":2,"least":1.5,"greatest":2.5,"deviation":0.5})"));
}

TEST(VoronoiAnswers, HaveSurfacePointsPiecesAndStatisticsWhereTheyAreAskedFor) {
  SmallDiagram small;
  for (const char* field : {"points", "pieces"}) EXPECT_FALSE(small.written().contains(field)) << field;
  EXPECT_FALSE(json::parse(write_voronoi_diagram(small.request, small.mesh, small.diagram, nullptr, {}, {}))
                   .contains("statistics"));
  small.request.include = {true, true};
  const auto answer = small.written();
  EXPECT_EQ(answer.at("points").at(0), json::parse(R"({"face":0,"barycentric":[0.5,0.5,0]})"));
  EXPECT_EQ(answer.at("pieces"), json::parse(R"({"vertex_sites":[0,1,1,null],"face_sites":[null,null],
      "cut_faces":[{"site":1,"face":0,"area":0.75,"corners":[[1,0,0],[2,0,0],[2,2,0]]}]})"));
}

TEST(VoronoiAnswers, TellWhatErrorsOfDistancesAreBoundedBy) {
  SmallDiagram small;
  EXPECT_EQ(small.written().at("accuracy"),
            json::parse(R"({"method":"exact","relative_error":0,"relative_error_bound":0,"border_deviation":1e-5})"));
  small.request.options = {voronoi::DiagramMethod::bounded, 0.25, 0.5};
  EXPECT_EQ(
      small.written().at("accuracy"),
      json::parse(R"({"method":"bounded","relative_error":0.25,"relative_error_bound":0.25,"border_deviation":0.5})"));
  small.request.options.method = voronoi::DiagramMethod::edges;
  EXPECT_EQ(small.written().at("accuracy"),
            json::parse(R"({"method":"edges","relative_error":0,"relative_error_bound":null,"border_deviation":0.5})"));
}

TEST(VoronoiAnswers, RefuseBordersAndPiecesOfMorePointsThanOneAnswerHolds) {
  SmallDiagram small;
  Limits limits;
  limits.max_border_points = 2;
  const auto error = ::supple::testing::expect_error("request.limit_exceeded", [&] {
    write_voronoi_diagram(small.request, small.mesh, small.diagram, nullptr, {}, limits);
  });
  EXPECT_EQ(::supple::testing::places(error), (std::vector<std::string>{"/sites"}));
  limits = {};
  limits.max_piece_corners = 3;
  EXPECT_NO_THROW(write_voronoi_diagram(small.request, small.mesh, small.diagram, nullptr, {}, limits));
  small.request.include.pieces = true;
  const auto pieces = ::supple::testing::expect_error("request.limit_exceeded", [&] {
    write_voronoi_diagram(small.request, small.mesh, small.diagram, nullptr, {}, limits);
  });
  EXPECT_EQ(::supple::testing::places(pieces), (std::vector<std::string>{"/pieces"}));
}

TEST(VoronoiAnswers, TellWhereAnOptimizationEndedAndHowItGotThere) {
  const SmallDiagram small;
  VoronoiOptimizationRequest request;
  request.mesh = small.request.mesh;
  request.options.tolerance = 0.5;
  voronoi::Optimization optimization;
  optimization.diagram = small.diagram;
  optimization.terms = {{"centroidal", 3}};
  optimization.energy = 3;
  optimization.gradient_norm = 0.25;
  optimization.gradient_tolerance = 0.125;
  optimization.iterations = 1;
  optimization.history = {{4, 1, 0}, {3, 0.25, 0.5}};
  optimization.stopped = voronoi::OptimizationTermination::iteration_limit;
  optimization.before.area.mean = 7;
  optimization.after = small.statistics;
  const auto answer = json::parse(write_voronoi_optimization(request, small.mesh, optimization, {}, {}));
  EXPECT_EQ(answer.at("terms"), json::parse(R"([{"name":"centroidal","energy":3}])"));
  EXPECT_EQ(answer.at("history").at(1), json::parse(R"({"energy":3,"gradient_norm":0.25,"step_length":0.5})"));
  EXPECT_EQ(
      answer.at("accuracy"),
      json::parse(R"({"tolerance":0.5,"gradient_tolerance":0.125,"gradient_norm":0.25,"border_deviation":1e-5})"));
  EXPECT_EQ(answer.at("statistics").at("before").at("area").at("mean"), 7);
  EXPECT_EQ(answer.at("statistics").at("after").at("area").at("mean"), 2);
  EXPECT_EQ(answer.at("stopped"), "iteration_limit");
  EXPECT_EQ(answer.at("cells").size(), 2U);
  EXPECT_EQ(answer.at("warnings").size(), 1U);
  EXPECT_FALSE(answer.contains("site_moves"));
  optimization.site_moves = {4, 2, 1600, 3, 5, 0.25};
  EXPECT_EQ(json::parse(write_voronoi_optimization(request, small.mesh, optimization, {}, {})).at("site_moves"),
            json::parse(R"({"held_searches":4,"passes":2,"tried":1600,"taken":3,"energy_before":5,"last_gain":0.25})"));
  optimization.energy = std::numeric_limits<double>::infinity();
  ::supple::testing::expect_error("computation.non_finite",
                                  [&] { write_voronoi_optimization(request, small.mesh, optimization, {}, {}); });
}

TEST(VoronoiAnswers, ShowADiagramOnItsWayUnlessItIsLarge) {
  SmallDiagram small;
  const auto partial = json::parse(write_partial_optimization(3, {2, 1, 0.5}, small.mesh, small.diagram));
  EXPECT_EQ(partial, json::parse(R"({"iteration":3,"energy":2,"gradient_norm":1,"step_length":0.5,
      "site_positions":[[0,2,0],[2,0,0]],"sites":[{"face":1,"barycentric":[0,0,1]},{"face":0,"barycentric":[0,1,0]}],
      "positions":[[1,0,0],[1,1,0]],"vertices":[1],"borders":[[0,1]]})"));
  small.diagram.points.resize(max_partial_border_points + 1);
  small.diagram.edges[0].points.resize(max_partial_border_points + 1);
  std::iota(small.diagram.edges[0].points.begin(), small.diagram.edges[0].points.end(), 0);
  small.diagram.sites.resize(max_partial_sites + 1, small.diagram.sites[0]);
  const auto large = json::parse(write_partial_optimization(3, {2, 1, 0.5}, small.mesh, small.diagram));
  EXPECT_EQ(large.size(), 4U);
}

TEST(VoronoiAnswers, ShowBordersOnTheirWayStraightWithinAFace) {
  SmallDiagram small;
  // One border has a crossing, an inner point, a crossing and the vertex; the other one lies within a face.
  small.diagram.points[2].kind = DiagramPoint::Kind::inner;
  small.diagram.points.push_back({DiagramPoint::Kind::crossing, {FaceId{0}, {0.5, 0, 0.5}}, {1, 1.5, 0}, 1});
  small.diagram.points.push_back({DiagramPoint::Kind::inner, {FaceId{0}, {0.5, 0, 0.5}}, {1.5, 1, 0}, 1});
  small.diagram.edges[0].points = {0, 2, 3, 1};
  small.diagram.edges.push_back({{0, 1}, {-1, -1}, {2, 4, 2}, 1});
  const auto partial = json::parse(write_partial_optimization(3, {2, 1, 0.5}, small.mesh, small.diagram));
  EXPECT_EQ(partial.at("positions"), json::parse("[[1,0,0],[1,1.5,0],[1,1,0],[1,2,0],[1.5,1,0]]"));
  EXPECT_EQ(partial.at("borders"), json::parse("[[0,1,2],[3,4,3]]"));
  EXPECT_EQ(partial.at("vertices"), json::parse("[2]"));
}

}  // namespace
}  // namespace supple::json
