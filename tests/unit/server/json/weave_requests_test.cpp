#include "supple/json/weave_requests.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/expect_error.h"

namespace supple::json {
namespace {

using Pointers = std::vector<std::string>;

Pointers faults_of_weave(const std::string& weave) {
  return ::supple::testing::places(
      ::supple::testing::expect_error("request.invalid", [&] { parse_weave_layout("{\"weave\":" + weave + "}", {}); }));
}

Pointers faults_of_homogenization(const std::string& fields) {
  return ::supple::testing::places(::supple::testing::expect_error(
      "request.invalid", [&] { parse_weave_homogenization(R"({"weave":{"pattern":"regular"},)" + fields + "}", {}); }));
}

Pointers faults_of_weave_simulation(const std::string& fields) {
  return ::supple::testing::places(::supple::testing::expect_error("request.invalid", [&] {
    parse_weave_simulation(R"({"weave":{"pattern":"actuated_rings"},)" + fields + "}", {});
  }));
}

TEST(WeaveRequests, ReadEveryFieldOfARegularWeave) {
  const auto request = parse_weave_layout(
      R"({"weave":{"pattern":"regular","connections":[["fused","slides_x"],["slides_y","fused"]],"pitch":3,
          "sheet":{"columns":5,"rows":4,"fused_border":2},"radius":0.4,"material":{"youngs_modulus":2000,"poisson_ratio":0.3},
          "overrides":[{"crossing":7,"slides":[0,1],"backward":1.5,"forward":null},{"crossing":8,"slides":[]}],
          "sliding_share":0.5},"svg":true,"deadline":9})",
      {});
  const auto& regular = std::get<RegularSpec>(request.weave.source);
  using weave::Connection;
  EXPECT_EQ(
      regular.connections,
      (weave::ConnectionBlock{{{Connection::fused, Connection::slides_x}, {Connection::slides_y, Connection::fused}}}));
  EXPECT_EQ(regular.pitch, 3);
  ASSERT_TRUE(regular.sheet);
  EXPECT_EQ(regular.sheet->columns, 5);
  EXPECT_EQ(regular.sheet->rows, 4);
  EXPECT_EQ(regular.sheet->fused_border, 2);
  EXPECT_EQ(request.weave.radius, 0.4);
  EXPECT_EQ(request.weave.material.youngs_modulus, 2000);
  EXPECT_EQ(request.weave.material.poisson_ratio, 0.3);
  ASSERT_EQ(request.weave.overrides.size(), 2U);
  EXPECT_EQ(request.weave.overrides[0].crossing, 7);
  EXPECT_EQ(request.weave.overrides[0].slides, (std::vector<int>{0, 1}));
  EXPECT_EQ(request.weave.overrides[0].range.backward, 1.5);
  EXPECT_TRUE(std::isinf(*request.weave.overrides[0].range.forward));
  EXPECT_TRUE(request.weave.overrides[1].slides.empty());
  EXPECT_FALSE(request.weave.overrides[1].range.backward);
  EXPECT_EQ(request.weave.sliding_fraction, 0.5);
  EXPECT_TRUE(request.svg);
  EXPECT_EQ(request.deadline, 9);
}

TEST(WeaveRequests, ReadTheOtherPatternsAndOneConnectionForAllCrossings) {
  const auto source = [](const std::string& weave) {
    return parse_weave_layout("{\"weave\":" + weave + "}", {}).weave.source;
  };
  const auto squares = std::get<SquaresSpec>(
      source(R"({"pattern":"interlacing_squares","type":4,"side":10,"overlap":2,"sheet":{"columns":2,"rows":3}})"));
  EXPECT_EQ(squares.type, weave::SquareType::one_corner_fused);
  EXPECT_EQ(squares.side, 10);
  EXPECT_EQ(squares.overlap, 2);
  EXPECT_EQ(squares.sheet->rows, 3);
  const auto circles =
      std::get<CirclesSpec>(source(R"({"pattern":"interlacing_circles","type":2,"circle_radius":6,"distance":11})"));
  EXPECT_EQ(circles.type, weave::CircleType::all_slide);
  EXPECT_EQ(circles.radius, 6);
  EXPECT_EQ(circles.distance, 11);
  EXPECT_FALSE(circles.sheet);
  EXPECT_TRUE(std::holds_alternative<RingsSpec>(source(R"({"pattern":"actuated_rings"})")));
  const auto regular = std::get<RegularSpec>(source(R"({"pattern":"regular","connections":"slides_y"})"));
  EXPECT_EQ(regular.connections, weave::uniform_block(weave::Connection::slides_y));
}

TEST(WeaveRequests, ReadALayout) {
  const auto request = parse_weave_layout(
      R"({"weave":{"strands":[{"points":[[0,1],[2,3]]},{"points":[[0,0]],"ends":"periodic","translation":[8,0],"radius":0.5}],
          "crossings":[{"members":[{"strand":0,"coordinate":1.25},
                                   {"strand":1,"coordinate":2,"shift":[1,-1],"slides":true,"backward":0.5}]}],
          "lattice":[[8,1],[0,6]]}})",
      {});
  const auto& layout = std::get<LayoutSpec>(request.weave.source);
  ASSERT_EQ(layout.strands.size(), 2U);
  EXPECT_EQ(layout.strands[0].points[1], Eigen::Vector2d(2, 3));
  EXPECT_FALSE(layout.strands[0].radius);
  EXPECT_EQ(layout.strands[1].ends, weave::Ends::periodic);
  EXPECT_EQ(layout.strands[1].translation, Eigen::Vector2d(8, 0));
  EXPECT_EQ(layout.strands[1].radius, 0.5);
  ASSERT_TRUE(layout.crossings);
  const auto& members = layout.crossings->front();
  EXPECT_EQ(members[0].coordinate, 1.25);
  EXPECT_FALSE(members[0].slides);
  EXPECT_EQ(members[1].shift, Eigen::Vector2i(1, -1));
  EXPECT_TRUE(members[1].slides);
  EXPECT_EQ(members[1].range.backward, 0.5);
  EXPECT_FALSE(members[1].range.forward);
  // The translations are rows on the wire and columns in the engine.
  EXPECT_EQ(*layout.lattice, (Eigen::Matrix2d{{8, 0}, {1, 6}}));
  EXPECT_FALSE(
      std::get<LayoutSpec>(parse_weave_layout(R"({"weave":{"strands":[{"points":[[0,1],[2,3]]}]}})", {}).weave.source)
          .crossings);
}

TEST(WeaveRequests, PointToEachFieldOfAWeaveAtFault) {
  EXPECT_EQ(faults_of_weave("{}"), Pointers{"/weave"});
  EXPECT_EQ(faults_of_weave(R"({"pattern":"regular","strands":[]})"), Pointers{"/weave"});
  EXPECT_EQ(faults_of_weave(R"({"pattern":"hexagons"})"), Pointers{"/weave/pattern"});
  EXPECT_EQ(faults_of_weave("3"), Pointers{"/weave"});
  EXPECT_EQ(faults_of_weave(R"({"pattern":"regular","connections":"glued"})"), Pointers{"/weave/connections"});
  EXPECT_EQ(faults_of_weave(R"({"pattern":"regular","connections":[["fused","x"],["fused",1]]})"),
            (Pointers{"/weave/connections/0/1", "/weave/connections/1/1"}));
  EXPECT_EQ(faults_of_weave(R"({"pattern":"regular","pitch":0,"sheet":{"columns":0}})"),
            (Pointers{"/weave/pitch", "/weave/sheet/columns", "/weave/sheet/rows"}));
  EXPECT_EQ(faults_of_weave(R"({"pattern":"interlacing_squares"})"), Pointers{"/weave/type"});
  EXPECT_EQ(faults_of_weave(R"({"pattern":"interlacing_circles","type":3,"side":3})"),
            (Pointers{"/weave/type", "/weave/side"}));
  EXPECT_EQ(faults_of_weave(R"({"pattern":"actuated_rings","sheet":{"columns":1,"rows":1}})"),
            Pointers{"/weave/sheet"});
  EXPECT_EQ(
      faults_of_weave(
          R"({"pattern":"regular","overrides":[{"slides":[0]},{"crossing":1},{"crossing":1,"slides":[-1,"a"],"forward":-1}]})"),
      (Pointers{"/weave/overrides/0/crossing", "/weave/overrides/1/slides", "/weave/overrides/2/slides/0",
                "/weave/overrides/2/slides/1", "/weave/overrides/2/forward"}));
  EXPECT_EQ(faults_of_weave(R"({"pattern":"regular","sliding_share":0,"radius":-1,"material":{"poisson_ratio":0.6}})"),
            (Pointers{"/weave/radius", "/weave/material/poisson_ratio", "/weave/sliding_share"}));
}

TEST(WeaveRequests, PointToEachFieldOfALayoutAtFault) {
  EXPECT_EQ(faults_of_weave(R"({"strands":[{"points":[[0,1],[2]]},{"points":3},{"ends":"loose","points":[[0,0]]}]})"),
            (Pointers{"/weave/strands/0/points/1", "/weave/strands/1/points", "/weave/strands/2/ends"}));
  EXPECT_EQ(
      faults_of_weave(R"({"strands":[{"points":[[0,1]],"ends":"periodic"},{"points":[[0,1]],"translation":[1,0]}]})"),
      (Pointers{"/weave/strands/0/translation", "/weave/strands/1/translation"}));
  EXPECT_EQ(
      faults_of_weave(
          R"({"strands":[{"points":[[0,1],[1,1]]}],"crossings":[{"members":[{"strand":0}]},{"members":[{"coordinate":1},{"strand":0,"coordinate":-1,"shift":[0.5,0]}]}],"lattice":[[1,0],[1]]})"),
      (Pointers{"/weave/crossings/0/members", "/weave/crossings/1/members/0/strand",
                "/weave/crossings/1/members/1/coordinate", "/weave/crossings/1/members/1/shift/0",
                "/weave/lattice/1"}));
}

TEST(WeaveRequests, SpreadDirectionsOverHalfATurnUnlessTheyAreGiven) {
  const auto directions = [](const std::string& more) {
    return parse_weave_homogenization(R"({"weave":{"pattern":"regular"})" + more + "}", {}).options.directions;
  };
  EXPECT_EQ(directions("").size(), 200U);
  const auto four = directions(R"(,"directions":4)");
  ASSERT_EQ(four.size(), 4U);
  EXPECT_DOUBLE_EQ(four[3], 3 * std::numbers::pi / 4);
  EXPECT_EQ(directions(R"(,"directions":[0.5,-1])"), (std::vector<double>{0.5, -1}));
}

TEST(WeaveRequests, ReadEveryOptionOfAHomogenization) {
  const auto request = parse_weave_homogenization(
      R"({"weave":{"pattern":"regular"},"strain":0.3,"directions":3,"shear":"suppressed","thickness":0.5,"deformed":[2,0],
          "accuracy":{"segments":8,"tolerance":1e-8,"max_iterations":7,"load_steps":3,"limit_tolerance":1e-4},
          "sliding":{"least_distance":0.2,"barrier_range":0.05,"regularization":1e-5},
          "effects":{"out_of_plane":"off","buckling":"on"}})",
      {});
  const auto& options = request.options;
  EXPECT_EQ(options.strain, 0.3);
  EXPECT_FALSE(options.shear_free);
  EXPECT_EQ(options.thickness, 0.5);
  EXPECT_EQ(options.deformed, (std::vector<int>{2, 0}));
  EXPECT_EQ(options.equilibrium.segments, 8);
  EXPECT_EQ(options.equilibrium.tolerance, 1e-8);
  EXPECT_EQ(options.equilibrium.max_iterations, 7);
  EXPECT_EQ(options.equilibrium.load_steps, 3);
  EXPECT_EQ(options.equilibrium.limit_tolerance, 1e-4);
  EXPECT_EQ(options.equilibrium.least_distance, 0.2);
  EXPECT_EQ(options.equilibrium.barrier_range, 0.05);
  EXPECT_EQ(options.equilibrium.sliding_regularization, 1e-5);
  EXPECT_EQ(options.equilibrium.out_of_plane, weave::Switch::off);
  EXPECT_EQ(options.equilibrium.buckling, weave::Switch::on);
}

TEST(WeaveRequests, PointToEachFieldOfAHomogenizationAtFault) {
  EXPECT_EQ(faults_of_homogenization(R"("strain":0)"), Pointers{"/strain"});
  EXPECT_EQ(faults_of_homogenization(R"("strain":3,"thickness":0,"shear":"maybe")"),
            (Pointers{"/strain", "/shear", "/thickness"}));
  EXPECT_EQ(faults_of_homogenization(R"("directions":0)"), Pointers{"/directions"});
  EXPECT_EQ(faults_of_homogenization(R"("directions":"all")"), Pointers{"/directions"});
  EXPECT_EQ(faults_of_homogenization(R"("directions":[0,"x"])"), Pointers{"/directions/1"});
  EXPECT_EQ(faults_of_homogenization(R"("directions":2,"deformed":[1,2])"), Pointers{"/deformed/1"});
  EXPECT_EQ(
      faults_of_homogenization(R"("accuracy":{"segments":0},"sliding":{"barrier_range":0},"effects":{"twist":"on"})"),
      (Pointers{"/accuracy/segments", "/sliding/barrier_range", "/effects/twist"}));
  EXPECT_EQ(faults_of_homogenization(R"("accuracy":{"limit_tolerance":2},"sliding":{"regularization":"x"})"),
            (Pointers{"/accuracy/limit_tolerance", "/sliding/regularization"}));
  // Lengths and stiffnesses that a request leaves out are left to the engine, which knows the weave.
  const auto left_out = parse_weave_homogenization(R"({"weave":{"pattern":"regular"}})", {}).options.equilibrium;
  EXPECT_FALSE(left_out.least_distance || left_out.barrier_range || left_out.sliding_regularization);
}

TEST(WeaveRequests, ReadDeformationGradientsByRows) {
  const auto read = [](const std::string& more) {
    return parse_weave_deformation(R"({"weave":{"pattern":"regular"},)" + more + "}", {});
  };
  const auto request = read(R"("deformation_gradients":[[[1.1,0.2],[0,0.9]],[[1,0],[0,1]]],"deformed":[1])");
  ASSERT_EQ(request.gradients.size(), 2U);
  EXPECT_EQ(request.gradients[0], (Eigen::Matrix2d{{1.1, 0.2}, {0, 0.9}}));
  EXPECT_EQ(request.deformed, std::vector<int>{1});
  const auto faults = [&](const std::string& more) {
    return ::supple::testing::places(::supple::testing::expect_error("request.invalid", [&] { read(more); }));
  };
  EXPECT_EQ(faults(R"("deformed":[])"), Pointers{"/deformation_gradients"});
  EXPECT_EQ(faults(R"("deformation_gradients":[[[1,0],[0,-1]],[1,0],[[1,0],[0,11]],[[1,0],[0]]],"deformed":[4])"),
            (Pointers{"/deformation_gradients/0", "/deformation_gradients/1/0", "/deformation_gradients/1/1",
                      "/deformation_gradients/2/1/1", "/deformation_gradients/3/1", "/deformed/0"}));
}

TEST(WeaveRequests, NameASheetThatHasBeenPrinted) {
  const auto request = parse_weave_layout(R"({"weave":{"pattern":"printed_sample","sample":"squares_3"}})", {});
  EXPECT_EQ(std::get<SampleSpec>(request.weave.source).sample, weave::Sample::squares_3);
}

TEST(WeaveRequests, ReadSupportsAndForcesAtEveryKindOfPlace) {
  const auto request = parse_weave_simulation(
      R"({"weave":{"pattern":"actuated_rings"},"states":4,"deformed":"vtu",
          "supports":[{"at":{"crossing":3}},
                      {"at":{"strand":1,"coordinate":2.5},"held":[true,false,true],"displacement":[1,2,3],"clamped":true,"rotation":[0,0,0.5]},
                      {"at":{"box":[[0,1],[2,3]]}}],
          "forces":[{"at":{"strand":2,"share":0.5},"force":[0,-1,0]}]})",
      {});
  EXPECT_EQ(request.states, 4);
  EXPECT_EQ(request.deformed, DeformedStrands::vtu);
  ASSERT_EQ(request.supports.size(), 3U);
  EXPECT_EQ(std::get<AtCrossing>(request.supports[0].at).crossing, 3);
  EXPECT_EQ(request.supports[0].support.held, (std::array<bool, 3>{true, true, true}));
  EXPECT_FALSE(request.supports[0].support.clamped);
  const auto& moved = request.supports[1];
  EXPECT_EQ(std::get<StrandCoordinate>(moved.at).coordinate, 2.5);
  EXPECT_EQ(moved.support.held, (std::array<bool, 3>{true, false, true}));
  EXPECT_EQ(moved.support.displacement, Eigen::Vector3d(1, 2, 3));
  EXPECT_TRUE(moved.support.clamped);
  EXPECT_EQ(moved.support.rotation, Eigen::Vector3d(0, 0, 0.5));
  EXPECT_EQ(std::get<InBox>(request.supports[2].at).upper, Eigen::Vector2d(2, 3));
  ASSERT_EQ(request.forces.size(), 1U);
  EXPECT_EQ(std::get<StrandFraction>(request.forces[0].at).share, 0.5);
  EXPECT_EQ(request.forces[0].force, Eigen::Vector3d(0, -1, 0));
}

TEST(WeaveRequests, PointToEachFieldOfASimulationAtFault) {
  EXPECT_EQ(faults_of_weave_simulation(R"("states":1)"), Pointers{"/supports"});
  EXPECT_EQ(faults_of_weave_simulation(R"("supports":[])"), Pointers{"/supports"});
  EXPECT_EQ(faults_of_weave_simulation(R"("supports":[{"at":{"strand":1}},{"held":[true]},{"at":{"share":2}}])"),
            (Pointers{"/supports/0/at", "/supports/1/at", "/supports/1/held", "/supports/2/at/strand",
                      "/supports/2/at/share"}));
  EXPECT_EQ(
      faults_of_weave_simulation(
          R"("supports":[{"at":{"crossing":0,"box":[[0,0],[1,1]]}}],"forces":[{"at":{"crossing":1}},{"at":{"box":[[0,0],1]},"force":[1]}])"),
      (Pointers{"/supports/0/at", "/forces/0/force", "/forces/1/at/box/1", "/forces/1/force"}));
  EXPECT_EQ(faults_of_weave_simulation(R"("supports":[{"at":{"crossing":0}}],"states":1001,"deformed":"stl")"),
            (Pointers{"/states", "/deformed"}));
}

TEST(WeaveRequests, LimitTheSizeOfALayout) {
  Limits limits;
  limits.max_strands = 1;
  limits.max_strand_points = 5;
  const auto exceeds = [&](const std::string& strands) {
    ::supple::testing::expect_error("request.limit_exceeded",
                                    [&] { parse_weave_layout(R"({"weave":{"strands":[)" + strands + "]}}", limits); });
  };
  exceeds(R"({"points":[[0,0],[1,1]]},{"points":[[0,0],[1,1]]})");
  exceeds(R"({"points":[[0,0],[1,1],[2,2],[3,3],[4,4],[5,5]]})");
  limits.max_strands = 2;
  exceeds(R"({"points":[[0,0],[1,1],[2,2]]},{"points":[[0,0],[1,1],[2,2]]})");
}

}  // namespace
}  // namespace supple::json
