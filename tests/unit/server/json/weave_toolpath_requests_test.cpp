#include "supple/json/weave_toolpath_requests.h"

#include <gtest/gtest.h>

#include "support/expect_error.h"

namespace supple::json {
namespace {

using Pointers = std::vector<std::string>;

WeaveToolpathRequest toolpath_with(const std::string& fields) {
  return parse_weave_toolpath(R"({"weave":{"pattern":"actuated_rings"})" + fields + "}", {});
}

Pointers faults_of_toolpath(const std::string& fields) {
  return ::supple::testing::places(
      ::supple::testing::expect_error("request.invalid", [&] { toolpath_with("," + fields); }));
}

Pointers faults_of_report(const std::string& body) {
  return ::supple::testing::places(
      ::supple::testing::expect_error("request.invalid", [&] { parse_gcode_report(body, {}); }));
}

TEST(WeaveToolpathRequests, ReadEveryFieldOfAPrinter) {
  const auto printer =
      toolpath_with(
          R"(,"printer":{"name":"Own","bed":[200,190,180],"nozzle_diameter":0.6,"filament_diameter":2.85,
          "nozzle_temperature":210,"bed_temperature":50,"strand_width":0.7,"bead_area":0.3,"lifted_flow":0.9,
          "channel_flow":0.4,"strand_height":0.3,"travel_clearance":2,"retraction":0.8,
          "lift":{"height":1,"top":0.8,"run":3,"bridge":4},
          "channel":{"shape":"arc","half_width":1.5,"longer":0.1,"apex":1.25},
          "strand_speed":700,"lifted_speed":500,"channel_speed":200,"travel_speed":6000,"retraction_speed":1800,
          "startup_gcode":"M107","footer_gcode":"M300"})")
          .printer;
  EXPECT_EQ(printer.name, "Own");
  EXPECT_EQ(printer.bed, Eigen::Vector3d(200, 190, 180));
  EXPECT_EQ(printer.nozzle_diameter, 0.6);
  EXPECT_EQ(printer.filament_diameter, 2.85);
  EXPECT_EQ(printer.nozzle_temperature, 210);
  EXPECT_EQ(printer.bed_temperature, 50);
  EXPECT_EQ(printer.strand_width, 0.7);
  EXPECT_EQ(printer.bead_area, 0.3);
  EXPECT_EQ(printer.lifted_flow, 0.9);
  EXPECT_EQ(printer.channel_flow, 0.4);
  EXPECT_EQ(printer.strand_height, 0.3);
  EXPECT_EQ(printer.travel_clearance, 2);
  EXPECT_EQ(printer.retraction, 0.8);
  EXPECT_EQ(printer.lift.height, 1);
  EXPECT_EQ(printer.lift.top, 0.8);
  EXPECT_EQ(printer.lift.run, 3);
  EXPECT_EQ(printer.lift.bridge, 4);
  EXPECT_EQ(printer.channel.shape, weave::ChannelShape::arc);
  EXPECT_EQ(printer.channel.half_width, 1.5);
  EXPECT_EQ(printer.channel.longer, 0.1);
  EXPECT_EQ(printer.channel.apex, 1.25);
  EXPECT_EQ(printer.strand_speed, 700);
  EXPECT_EQ(printer.lifted_speed, 500);
  EXPECT_EQ(printer.channel_speed, 200);
  EXPECT_EQ(printer.travel_speed, 6000);
  EXPECT_EQ(printer.retraction_speed, 1800);
  EXPECT_EQ(printer.startup_gcode, "M107");
  EXPECT_EQ(printer.footer_gcode, "M300");
}

TEST(WeaveToolpathRequests, ReadEveryOption) {
  const auto request = toolpath_with(
      R"(,"origin":[50,-3],"order":[2,0,1],"overrun":{"start":24},"overruns":[{"strand":4,"end":6},{"strand":1}],
          "loop_overlap":1.6,"frame":{"lead_in":16},"grips":[{"from":[0,1],"to":[2,3],"width":4},{"from":[5,5],"to":[6,6]}],
          "chord_error":0.01,"include":["moves","svg"],"deadline":9)");
  const auto& options = request.options;
  EXPECT_EQ(options.origin, Eigen::Vector2d(50, -3));
  EXPECT_EQ(options.order, (std::vector<int>{2, 0, 1}));
  EXPECT_EQ(options.overrun.start, 24);
  EXPECT_EQ(options.overrun.end, 0);
  ASSERT_EQ(options.overruns.size(), 2U);
  EXPECT_EQ(options.overruns.at(4).end, 6);
  EXPECT_EQ(request.overrun_strands, (std::vector<int>{4, 1}));
  EXPECT_EQ(options.loop_overlap, 1.6);
  ASSERT_TRUE(options.frame);
  EXPECT_EQ(options.frame->margin, 0);
  EXPECT_EQ(options.frame->lead_in, 16);
  ASSERT_EQ(options.grips.size(), 2U);
  EXPECT_EQ(options.grips[0].to, Eigen::Vector2d(2, 3));
  EXPECT_EQ(options.grips[0].width, 4);
  EXPECT_EQ(options.grips[1].width, 10);
  EXPECT_EQ(options.chord_error, 0.01);
  EXPECT_FALSE(request.include.gcode);
  EXPECT_TRUE(request.include.svg);
  EXPECT_TRUE(request.include.moves);
  EXPECT_EQ(request.deadline, 9);
}

TEST(WeaveToolpathRequests, LeaveToTheEngineWhatIsNotGiven) {
  const auto request = toolpath_with("");
  const weave::PrinterProfile printer;
  EXPECT_EQ(request.printer.name, printer.name);
  EXPECT_EQ(request.printer.bed, printer.bed);
  EXPECT_FALSE(request.printer.bead_area);
  EXPECT_FALSE(request.options.origin);
  EXPECT_FALSE(request.options.frame);
  EXPECT_TRUE(request.options.order.empty());
  EXPECT_TRUE(request.include.gcode);
  EXPECT_FALSE(request.include.svg);
  const auto nothing = toolpath_with(R"(,"include":[])").include;
  EXPECT_FALSE(nothing.gcode || nothing.svg || nothing.moves);
}

TEST(WeaveToolpathRequests, PointToEachFieldAtFault) {
  EXPECT_EQ(
      faults_of_toolpath(
          R"("printer":{"name":3,"bed":[1,2],"bead_area":0,"lift":{"run":-1},"channel":{"shape":"box"},"travel_speed":0,"nozzle":1})"),
      (Pointers{"/printer/name", "/printer/bed", "/printer/bead_area", "/printer/lift/run", "/printer/channel/shape",
                "/printer/travel_speed", "/printer/nozzle"}));
  EXPECT_EQ(faults_of_toolpath(R"("origin":[1],"order":[0,-1,0.5],"overrun":{"start":-1},"loop_overlap":1001)"),
            (Pointers{"/origin", "/order/1", "/order/2", "/overrun/start", "/loop_overlap"}));
  EXPECT_EQ(faults_of_toolpath(R"("overruns":[{"strand":1},{"end":2},{"strand":1}])"),
            (Pointers{"/overruns/1/strand", "/overruns/2/strand"}));
  EXPECT_EQ(
      faults_of_toolpath(R"("frame":{"margin":"wide"},"grips":[{"from":[0,0]},{"from":1,"to":[1,1],"width":-1}])"),
      (Pointers{"/frame/margin", "/grips/0/to", "/grips/1/from", "/grips/1/width"}));
  EXPECT_EQ(faults_of_toolpath(R"("chord_error":0,"include":["gcode","stl","gcode"])"),
            (Pointers{"/chord_error", "/include/1", "/include/2"}));
}

TEST(GcodeReportRequests, ReadTheFileAndEveryLimit) {
  const auto request = parse_gcode_report(
      R"({"gcode":"G28\nG1 X1","limits":{"bed":[200,190,180],"filament_diameter":2.85,"bead_area":0.3,"least_bead_area":0.2,
          "least_free_area":0.1,"tolerance":0.05,"cold":190,"print_speed":1000,"travel_speed":5000,"retraction":0.8,
          "free_travel":2,"strand_width":0.7},"deadline":4})",
      {});
  EXPECT_EQ(request.gcode, "G28\nG1 X1");
  EXPECT_EQ(request.limits.bed, Eigen::Vector3d(200, 190, 180));
  EXPECT_EQ(request.limits.filament_diameter, 2.85);
  EXPECT_EQ(request.limits.bead_area, 0.3);
  EXPECT_EQ(request.limits.min_bead_area, 0.2);
  EXPECT_EQ(request.limits.min_lifted_area, 0.1);
  EXPECT_EQ(request.limits.tolerance, 0.05);
  EXPECT_EQ(request.limits.cold, 190);
  EXPECT_EQ(request.limits.print_speed, 1000);
  EXPECT_EQ(request.limits.travel_speed, 5000);
  EXPECT_EQ(request.limits.retraction, 0.8);
  EXPECT_EQ(request.limits.free_travel, 2);
  EXPECT_EQ(request.limits.strand_width, 0.7);
  EXPECT_EQ(request.deadline, 4);
}

TEST(GcodeReportRequests, PointToEachFieldAtFault) {
  EXPECT_EQ(faults_of_report("{}"), Pointers{"/gcode"});
  EXPECT_EQ(faults_of_report(R"({"gcode":["G28"],"limits":{"tolerance":2,"bed":3,"speed":1}})"),
            (Pointers{"/gcode", "/limits/bed", "/limits/tolerance", "/limits/speed"}));
}

TEST(GcodeReportRequests, LimitTheNumberOfLines) {
  Limits limits;
  limits.max_gcode_lines = 3;
  EXPECT_EQ(parse_gcode_report(R"({"gcode":"G28\nG28\nG28\n"})", limits).gcode.size(), 12U);
  ::supple::testing::expect_error("request.limit_exceeded",
                                  [&] { parse_gcode_report(R"({"gcode":"G28\nG28\nG28\n\r"})", limits); });
}

}  // namespace
}  // namespace supple::json
