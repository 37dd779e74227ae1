#include "supple/json/weave_toolpath_answers.h"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace supple::json {
namespace {

using Json = nlohmann::json;

weave::Toolpath one_channel() {
  weave::Toolpath path;
  path.moves.push_back({weave::MoveKind::travel, {{0, 0, 2}, {1, 2, 0.5}}, 0, 3000});
  path.moves.push_back({weave::MoveKind::channel, {{1, 2, 0.5}, {2, 2, 1.5}, {3, 2, 0.5}}, 0.1, 300, 4, 7});
  path.statistics.strand_length = 1;
  path.statistics.lifted_length = 2;
  path.statistics.channel_length = 3;
  path.statistics.support_length = 4;
  path.statistics.priming_length = 4.5;
  path.statistics.travel_length = 5;
  path.statistics.extruded_length = 6;
  path.statistics.filament = 7;
  path.statistics.travels = 8;
  path.statistics.channels = 9;
  path.statistics.heights = {0.5, 1.5};
  path.statistics.minutes = 10;
  path.statistics.highest = {1, 2, 3};
  return path;
}

weave::GcodeReport one_violation() {
  weave::GcodeReport report;
  report.lines = 12;
  report.filament = 0.25;
  report.minutes = 1.5;
  report.channels.push_back({3, {0, 0, 0.5}, {1, 0, 1.5}, {2, 0, 0.5}, 2.5});
  report.violations.push_back({weave::ViolationKind::too_fast, 11, "quick"});
  report.violation_count = 1;
  return report;
}

TEST(WeaveToolpathAnswers, HaveStatisticsAndCheckAndWhatElseWasAskedFor) {
  const std::string gcode = "G28\n";
  const std::string svg = "<svg/>";
  const auto all = Json::parse(write_weave_toolpath(one_channel(), {&gcode, &svg, true}, one_violation(), {}));
  EXPECT_EQ(all["gcode"], gcode);
  EXPECT_EQ(all["svg"], svg);
  EXPECT_EQ(all["statistics"], Json::parse(R"({"strand_length":1.0,"lifted_length":2.0,"channel_length":3.0,
      "support_length":4.0,"priming_length":4.5,"travel_length":5.0,"extruded_length":6.0,"filament":7.0,"travels":8,"channels":9,
      "heights":[0.5,1.5],"minutes":10.0,"lowest":[0.0,0.0,0.0],"highest":[1.0,2.0,3.0]})"));
  EXPECT_EQ(all["check"]["violation_count"], 1);
  const auto few = Json::parse(write_weave_toolpath(one_channel(), {}, one_violation(), {}));
  for (const char* part : {"gcode", "svg", "moves"}) EXPECT_FALSE(few.contains(part)) << part;
  EXPECT_EQ(few["statistics"], all["statistics"]);
}

TEST(WeaveToolpathAnswers, TypeTheirMoves) {
  const auto answer = Json::parse(write_weave_toolpath(one_channel(), {nullptr, nullptr, true}, {}, {}));
  EXPECT_EQ(answer["moves"], Json::parse(R"([
      {"kind":"travel","points":[[0.0,0.0,2.0],[1.0,2.0,0.5]],"area":0.0,"speed":3000.0,"strand":null,"crossing":null},
      {"kind":"channel","points":[[1.0,2.0,0.5],[2.0,2.0,1.5],[3.0,2.0,0.5]],"area":0.1,"speed":300.0,"strand":4,"crossing":7}])"));
}

TEST(GcodeReportAnswers, ListChannelsAndViolationsWithTheirLines) {
  const auto report = Json::parse(write_gcode_report(one_violation(), {}))["report"];
  EXPECT_EQ(report["lines"], 12);
  EXPECT_EQ(report["filament"], 0.25);
  EXPECT_EQ(report["minutes"], 1.5);
  EXPECT_EQ(report["channels"],
            Json::parse(R"([{"line":3,"start":[0.0,0.0,0.5],"apex":[1.0,0.0,1.5],"end":[2.0,0.0,0.5],
                                                 "length":2.5}])"));
  EXPECT_EQ(report["violations"], Json::parse(R"([{"kind":"too_fast","line":11,"message":"quick"}])"));
}

TEST(GcodeReportAnswers, SayNothingOfADurationThatIsNotFinite) {
  weave::GcodeReport report;
  report.minutes = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(Json::parse(write_gcode_report(report, {}))["report"]["minutes"].is_null());
}

}  // namespace
}  // namespace supple::json
