#include "supple/weave/gcode_check.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "layouts.h"
#include "supple/weave/gcode.h"
#include "supple/weave/patterns.h"
#include "support/expect_error.h"

namespace supple::weave {
namespace {

/// A file written by hand: a square of 40 mm, and a channel over nothing that slides. It has 0.08 mm of filament for
/// each mm.
const std::vector<std::string> good{
    "; a file written by hand",       //  1
    "G21",                            //  2
    "G90",                            //  3
    "M82",                            //  4
    "M104 S200",                      //  5
    "M140 S60",                       //  6
    "M190 S60",                       //  7
    "M109 S200",                      //  8
    "G28 W",                          //  9
    "G92 E0",                         // 10
    "G1 Z2 F3000",                    // 11
    "N12 G0 X50 Y50 F3000 *71",       // 12
    "G1 Z0.5",                        // 13
    "G1 X90 E3.2 F600",               // 14
    "G1 Y90 E6.4 (right side)",       // 15
    "g1 x50 e9.6",                    // 16
    "G1 Y50 E12.8",                   // 17
    "G1 E12.4 F2100",                 // 18
    "G0 X68 F3000",                   // 19
    "G1 E12.8 F2100",                 // 20
    "G1 X70 Z2.5 E13.02627417 F300",  // 21
    "G1 X72 Z0.5 E13.25254834",       // 22
    "G1 E12.85 F2100",                // 23
    "G0 Z20 F3000",                   // 24
    "M104 S0",                        // 25
    "M84",                            // 26
};

GcodeLimits limits() {
  GcodeLimits result;
  result.print_speed = 600;
  result.travel_speed = 3000;
  return result;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + "\n";
  return text;
}

/// The file `good` with a line, counted from 1, replaced.
std::string with(std::size_t line, const std::string& replacement) {
  std::vector<std::string> lines = good;
  lines[line - 1] = replacement;
  return joined(lines);
}

TEST(GcodeCheck, ReportsWhatAFilePrints) {
  const GcodeReport report = check_gcode(joined(good), limits());
  for (const Violation& v : report.violations)
    ADD_FAILURE() << v.line << ": " << to_string(v.kind) << ": " << v.message;
  EXPECT_EQ(report.lines, 26);
  EXPECT_NEAR(report.extruded_length, 160 + 2 * std::sqrt(8.0), 1e-9);
  EXPECT_NEAR(report.filament, 13.25254834, 1e-9);
  EXPECT_EQ(report.travels, 2);
  EXPECT_EQ(report.retractions, 2);
  EXPECT_EQ(report.heights, std::vector<double>{0.5});
  EXPECT_LT((report.lowest - Eigen::Vector3d(50, 50, 0.5)).norm(), 1e-12);
  EXPECT_LT((report.highest - Eigen::Vector3d(90, 90, 2.5)).norm(), 1e-12);
  ASSERT_EQ(report.channels.size(), 1U);
  EXPECT_EQ(report.channels[0].line, 21);
  EXPECT_LT((report.channels[0].apex - Eigen::Vector3d(70, 50, 2.5)).norm(), 1e-12);
  EXPECT_NEAR(report.channel_length, 2 * std::sqrt(8.0), 1e-9);
  const double travel = 2 + std::hypot(50.0, 50.0) + 1.5 + 18 + 19.5;
  EXPECT_NEAR(report.travel_length, travel, 1e-9);
  EXPECT_NEAR(report.minutes,
              travel / 3000 - 1.5 / 3000 + 1.5 / 3000 + 160.0 / 600 + 2 * std::sqrt(8.0) / 300 +
                  (0.4 + 0.4 + 0.40254834) / 2100,
              1e-6);
}

struct Mutation {
  const char* name;
  std::size_t line;
  const char* replacement;
  ViolationKind kind;
  int found_at;
};

class GcodeMutations : public ::testing::TestWithParam<Mutation> {};

TEST_P(GcodeMutations, AreFoundAtTheirLine) {
  const Mutation& m = GetParam();
  const GcodeReport report = check_gcode(with(m.line, m.replacement), limits());
  ASSERT_GE(report.violation_count, 1);
  bool found = false;
  for (const Violation& v : report.violations) found = found || (v.kind == m.kind && v.line == m.found_at);
  EXPECT_TRUE(found) << report.violations[0].line << ": " << to_string(report.violations[0].kind) << ": "
                     << report.violations[0].message;
}

const std::vector<Mutation> mutations{
    {"LeftOfTheBed", 12, "G0 X-1 Y50 F3000", ViolationKind::outside_bed, 12},
    {"RightOfTheBed", 14, "G1 X251 E16.08 F600", ViolationKind::outside_bed, 14},
    {"BehindTheBed", 12, "G0 X50 Y210.1 F3000", ViolationKind::outside_bed, 12},
    {"AboveTheBed", 24, "G0 Z211 F3000", ViolationKind::outside_bed, 24},
    {"InFrontOfTheBed", 12, "G0 X50 Y-3 F3000", ViolationKind::y_below_zero, 12},
    {"BelowTheBed", 13, "G1 Z-0.1", ViolationKind::z_below_zero, 13},
    {"NozzleNotWaitedFor", 8, "M104 S200", ViolationKind::cold_extrusion, 14},
    {"NozzleTooCold", 8, "M109 S150", ViolationKind::cold_extrusion, 14},
    {"NozzleSwitchedOff", 13, "M104 S0", ViolationKind::cold_extrusion, 14},
    {"TooMuchFilament", 15, "G1 Y90 E7.2", ViolationKind::over_extrusion, 15},
    {"TooLittleFilament", 15, "G1 Y90 E6.0", ViolationKind::under_extrusion, 15},
    {"ThinChannel", 21, "G1 X70 Z2.5 E12.87 F300", ViolationKind::under_extrusion, 21},
    {"BlobAtRest", 20, "G1 E13.2 F2100", ViolationKind::over_extrusion, 20},
    {"NoRetraction", 18, "; nothing", ViolationKind::travel_without_retraction, 19},
    {"SmallRetraction", 18, "G1 E12.7 F2100", ViolationKind::travel_without_retraction, 19},
    {"StillRetracted", 20, "; nothing", ViolationKind::under_extrusion, 21},
    {"PrintedTooFast", 14, "G1 X90 E3.2 F601", ViolationKind::too_fast, 14},
    {"MovedTooFast", 19, "G0 X68 F4000", ViolationKind::too_fast, 19},
    {"NoSpeed", 11, "G1 Z2", ViolationKind::no_speed, 11},
    {"SpeedOfZero", 14, "G1 X90 E3.2 F0", ViolationKind::no_speed, 14},
    {"NegativeSpeed", 14, "G1 X90 E3.2 F-600", ViolationKind::no_speed, 14},
    {"NotHomed", 9, "; nothing", ViolationKind::not_homed, 11},
    {"HomedInPart", 9, "G28 X Y", ViolationKind::not_homed, 11},
    {"MotorsOff", 18, "M84", ViolationKind::not_homed, 19},
    {"UnknownGCommand", 3, "G17", ViolationKind::unknown_command, 3},
    {"Inches", 2, "G20", ViolationKind::outside_bed, 12},
    {"EndsThePrint", 4, "M0", ViolationKind::unknown_command, 4},
    {"VolumetricExtrusion", 4, "M200 D1.75", ViolationKind::unknown_command, 4},
    {"HalfTheFlow", 13, "M221 S50", ViolationKind::under_extrusion, 14},
    {"NoFlow", 4, "M221 S0", ViolationKind::malformed_word, 4},
    {"DoubleSpeed", 13, "M220 S200", ViolationKind::too_fast, 14},
    {"MoveByAKindOfACommand", 3, "G0.1", ViolationKind::unknown_command, 3},
    {"UnknownMCommand", 4, "M600", ViolationKind::unknown_command, 4},
    {"OtherTool", 4, "T1", ViolationKind::unknown_command, 4},
    {"BrokenCommand", 3, "G1.5", ViolationKind::unknown_command, 3},
    {"LetterWithoutNumber", 14, "G1 X E3.2 F600", ViolationKind::malformed_word, 14},
    {"NumberWithTwoPoints", 14, "G1 X9.0.0 E3.2 F600", ViolationKind::malformed_word, 14},
    {"OnlyASign", 14, "G1 X- E3.2 F600", ViolationKind::malformed_word, 14},
    {"NotANumber", 14, "G1 Xnan E3.2 F600", ViolationKind::malformed_word, 14},
    {"HugeNumber", 14, "G1 X1000001 E3.2 F600", ViolationKind::malformed_word, 14},
    {"OtherBytes", 14, "G1 X90 \xff E3.2 F600", ViolationKind::malformed_word, 14},
    {"TwiceTheSameLetter", 14, "G1 X90 X91 E3.2 F600", ViolationKind::malformed_word, 14},
    {"OtherLetter", 14, "G1 X90 Q1 E3.2 F600", ViolationKind::malformed_word, 14},
    {"NoCommand", 14, "X90 E3.2 F600", ViolationKind::malformed_word, 14},
    {"NoTemperature", 8, "M109", ViolationKind::malformed_word, 8},
    {"BrokenChecksum", 12, "N12 G0 X50 Y50 F3000 *", ViolationKind::malformed_word, 12},
    {"BrokenLineNumber", 12, "N1.5 G0 X50 Y50 F3000", ViolationKind::malformed_word, 12},
};
INSTANTIATE_TEST_SUITE_P(Of, GcodeMutations, ::testing::ValuesIn(mutations),
                         [](const auto& mutation) { return std::string(mutation.param.name); });

TEST(GcodeCheck, FollowsRelativeMovesResetsAndRelativeExtrusion) {
  const std::string text =
      "G28\nM109 S200\nG1 F600\nG91\nM83\nG0 X10 Y10 Z0.5\nG92 X0\nG1 X10 E0.8\nG90\nM83\nG1 X20 E0.8\nM82\nG92 E5\n"
      "G1 X30 E5.8\n";
  const GcodeReport report = check_gcode(text, limits());
  for (const Violation& v : report.violations) ADD_FAILURE() << v.line << ": " << v.message;
  EXPECT_NEAR(report.extruded_length, 30, 1e-12);
  EXPECT_NEAR(report.filament, 2.4, 1e-12);
  EXPECT_NEAR(report.highest[0], 40, 1e-12) << "of the machine, whatever the file calls it";
}

TEST(GcodeCheck, PassesOnWhatPrintersKnowAndSaysSo) {
  const std::vector<std::string> known{"M862.3 P \"MK3S\"",
                                       "M115 U3.13.2",
                                       "M900 K0.05",
                                       "START_PRINT BED=60",
                                       "_CLEAN_NOZZLE",
                                       "SET_PRESSURE_ADVANCE ADVANCE=0.05",
                                       "M117 it's 100% {ok}",
                                       "G29.1",
                                       "G29 P1 A",
                                       "M73 P0 R12",
                                       "M1002 judge_flag x",
                                       "m900 k0.05"};
  std::string text;
  for (const std::string& line : known) text += line + "\n";
  text += "T0\nG80\nM221 S95\n" + joined(good);
  const GcodeReport report = check_gcode(text, limits());
  for (const Violation& v : report.violations) ADD_FAILURE() << v.line << ": " << v.message;
  ASSERT_EQ(report.unchecked.size(), known.size());
  EXPECT_EQ(report.unchecked_count, static_cast<int>(known.size()));
  EXPECT_EQ(report.unchecked[0].command, "M862.3");
  EXPECT_EQ(report.unchecked[3].command, "START_PRINT");
  EXPECT_EQ(report.unchecked[3].line, 4);
  EXPECT_EQ(report.unchecked[7].command, "G29.1");
  EXPECT_NEAR(report.filament, 0.95 * check_gcode(joined(good), limits()).filament, 1e-9);
}

TEST(GcodeCheck, FollowsInches) {
  const std::string text = "G28\nM109 S200\nG20\nG1 F20\nG0 X1 Y1 Z0.02\nG1 X2 E0.08\nG21\nG1 X60.8 E2.832\n";
  const GcodeReport report = check_gcode(text, limits());
  for (const Violation& v : report.violations) ADD_FAILURE() << v.line << ": " << v.message;
  EXPECT_NEAR(report.extruded_length, 35.4, 1e-9);
  EXPECT_NEAR(report.filament, 2.832, 1e-9);
}

TEST(GcodeCheck, CountsLinesOfEveryEnding) {
  EXPECT_EQ(check_gcode("").lines, 0);
  EXPECT_EQ(check_gcode("G21\rG90\r\nG21\n\nG90").lines, 5);
  const GcodeReport report = check_gcode("G21\r\n\r\nG17\r\n");
  ASSERT_EQ(report.violations.size(), 1U);
  EXPECT_EQ(report.violations[0].line, 3);
}

TEST(GcodeCheck, NamesEveryKindOfViolation) {
  using enum ViolationKind;
  const std::vector<std::pair<ViolationKind, std::string>> names = {
      {not_homed, "not_homed"},
      {outside_bed, "outside_bed"},
      {y_below_zero, "y_below_zero"},
      {z_below_zero, "z_below_zero"},
      {cold_extrusion, "cold_extrusion"},
      {over_extrusion, "over_extrusion"},
      {under_extrusion, "under_extrusion"},
      {travel_without_retraction, "travel_without_retraction"},
      {too_fast, "too_fast"},
      {no_speed, "no_speed"}};
  for (const auto& [kind, name] : names) EXPECT_EQ(to_string(kind), name);
}

TEST(GcodeCheck, AddsDwellsToTheTime) { EXPECT_NEAR(check_gcode("G4 S30\nG4 P1500").minutes, 31.5 / 60, 1e-12); }

TEST(GcodeCheck, TakesNoLiftedStrandForAChannel) {
  // A lifted strand rises and falls over others, but it starts from the bed and continues there.
  const Weave weave = regular_sheet(6, 6, uniform_block(Connection::slides_x));
  const PrinterProfile profile;
  Toolpath path = toolpath(weave, profile);
  std::erase_if(path.moves, [](const Move& move) { return move.kind == MoveKind::channel; });
  EXPECT_TRUE(check_gcode(to_gcode(path, profile), limits_of(profile, weave)).channels.empty());
  // A hump on the bed has no bead below its ends.
  const std::string hump = "G28\nM109 S200\nG0 X10 Y10 Z0.5 F600\nG1 X12 Z2.5 E0.22\nG1 X14 Z0.5 E0.44\n";
  EXPECT_TRUE(check_gcode(hump).channels.empty());
}

TEST(GcodeCheck, KeepsTheFirstThousandViolationsAndCountsAll) {
  std::string text;
  for (int i = 0; i < 3000; ++i) text += "G17\n";
  const GcodeReport report = check_gcode(text);
  EXPECT_EQ(report.violations.size(), 1000U);
  EXPECT_EQ(report.violation_count, 3000);
}

TEST(GcodeCheck, ReadsSixtyFourKibibytesOfALine) {
  const auto violations = [](const std::string& line) { return check_gcode(line + "\nG28 W\n").violation_count; };
  const std::string blanks(1 << 16, ' ');
  EXPECT_EQ(violations(blanks), 0);
  EXPECT_EQ(violations(blanks + "?"), 1);
  EXPECT_EQ(violations("; " + blanks + "?"), 0) << "a remark";
  const GcodeReport report = check_gcode(blanks + "?");
  ASSERT_FALSE(report.violations.empty());
  EXPECT_EQ(report.violations[0].message, "a line of 65537 bytes, of which 65536 were read");
}

TEST(GcodeCheck, AnswersInPrintableTextWhateverTheBytes) {
  std::string bytes;
  for (int i = 0; i < 4096; ++i) bytes += static_cast<char>((i * 167 + i / 7) % 256);
  bytes += "\nG1 X" + std::string(5000, '9') + "\nG1 X-" + std::string(5000, '0') + ".5 Y.\nG" + std::string(400, '1');
  const GcodeReport report = check_gcode(bytes);
  EXPECT_GT(report.violation_count, 0);
  for (const Violation& v : report.violations)
    for (const char c : v.message) EXPECT_TRUE(c >= ' ' && c <= '~');
  EXPECT_TRUE(report.lowest.allFinite() && report.highest.allFinite() && std::isfinite(report.minutes));
}

TEST(GcodeCheck, TellsHowFarItIsAndStopsWhenAsked) {
  std::string text = joined(good);
  for (int i = 0; i < 5000; ++i) text += "; nothing\n";
  struct Listener : ProgressSink {
    void report(double fraction, std::string_view /*stage*/) override {
      fractions.push_back(fraction);
      if (fractions.size() == stop_after) token.request(StopReason::cancelled);
    }
    CancellationToken token;
    std::vector<double> fractions;
    std::size_t stop_after = 0;
  } listener;
  Execution execution;
  execution.progress = &listener;
  execution.cancellation = listener.token;
  EXPECT_EQ(check_gcode(text, limits(), execution).lines, 5026);
  ASSERT_GE(listener.fractions.size(), 5U);
  EXPECT_TRUE(std::is_sorted(listener.fractions.begin(), listener.fractions.end()));
  listener.fractions.clear();
  listener.stop_after = 2;
  ::supple::testing::expect_cancelled(StopReason::cancelled, [&] { check_gcode(text, limits(), execution); });
  EXPECT_EQ(listener.fractions.size(), 2U);
}

}  // namespace
}  // namespace supple::weave
