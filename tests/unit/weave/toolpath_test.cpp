#include "supple/weave/toolpath.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include "layouts.h"
#include "supple/weave/gcode.h"
#include "supple/weave/gcode_check.h"
#include "supple/weave/patterns.h"
#include "supple/weave/weave_error.h"
#include "support/expect_error.h"

namespace supple::weave {
namespace {

using ::supple::testing::expect_error;
using ::supple::testing::places;

/// A strand along y that slides across one along x. They cross in the middle of both.
Weave sliding_cross(double half = 10) {
  Weave weave;
  weave.strands = {line({-half, 0}, {half, 0}), line({0, -half}, {0, half})};
  weave.crossings = find_crossings(weave.strands);
  weave.crossings[0].members[1].slides = true;
  return weave;
}

std::vector<const Move*> of_kind(const Toolpath& path, MoveKind kind) {
  std::vector<const Move*> found;
  for (const Move& move : path.moves)
    if (move.kind == kind) found.push_back(&move);
  return found;
}

/// A profile without the priming line.
PrinterProfile unprimed() {
  PrinterProfile profile;
  profile.priming_length = 0;
  return profile;
}

double highest(const Move& move) {
  double z = 0;
  for (const Eigen::Vector3d& p : move.points) z = std::max(z, p[2]);
  return z;
}

TEST(Toolpath, WeldsFusedStrandsInOneLayerWithoutTravelsThatDrag) {
  const Toolpath path = toolpath(regular_sheet(3, 3, uniform_block(Connection::fused)), unprimed());
  EXPECT_TRUE(of_kind(path, MoveKind::lifted).empty());
  EXPECT_EQ(path.statistics.heights, std::vector<double>{0.5});
  EXPECT_NEAR(path.statistics.extruded_length, 6 * 12, 1e-9);
  EXPECT_NEAR(path.statistics.filament, 6 * 12 * 0.25 * 0.25 / (0.875 * 0.875), 1e-9);
  EXPECT_EQ(path.statistics.travels, 6);
  for (const Move* travel : of_kind(path, MoveKind::travel))
    for (std::size_t i = 1; i < travel->points.size(); ++i) {
      const Eigen::Vector3d& a = travel->points[i - 1];
      const Eigen::Vector3d& b = travel->points[i];
      // The nozzle travels across only above everything that is printed.
      EXPECT_TRUE((a - b).head<2>().norm() < 1e-9 || (a[2] >= 1.5 - 1e-9 && b[2] >= 1.5 - 1e-9));
    }
}

TEST(Toolpath, PrintsTheLowerStrandThenTheSlidingOneThenTheChannel) {
  const Weave weave = sliding_cross();
  const PrinterProfile profile = unprimed();
  const Toolpath path = toolpath(weave, profile);
  std::vector<std::pair<MoveKind, int>> kinds;
  for (const Move& move : path.moves)
    if (move.kind != MoveKind::travel) kinds.emplace_back(move.kind, move.strand);
  const std::vector<std::pair<MoveKind, int>> expected{{MoveKind::strand, 0},
                                                       {MoveKind::strand, 1},
                                                       {MoveKind::lifted, 1},
                                                       {MoveKind::strand, 1},
                                                       {MoveKind::channel, 0}};
  EXPECT_EQ(kinds, expected);

  const Eigen::Vector2d centre = profile.bed.head<2>() / 2;
  const Move& lifted = *of_kind(path, MoveKind::lifted)[0];
  ASSERT_EQ(lifted.points.size(), 4U);
  const std::vector<double> along{2, 0.75, -0.75, -2};
  const double sign = lifted.points[0][1] > centre[1] ? 1 : -1;
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(lifted.points[i][1] - centre[1], sign * along[i], 1e-9);
    EXPECT_NEAR(lifted.points[i][2], i == 0 || i == 3 ? 0.5 : 1.5, 1e-9);
  }

  const Move& channel = *of_kind(path, MoveKind::channel)[0];
  EXPECT_EQ(channel.crossing, 0);
  EXPECT_EQ(channel.speed, 300);
  ASSERT_EQ(channel.points.size(), 3U);
  EXPECT_LT((channel.points[0] - Eigen::Vector3d(centre[0] - 1.2, centre[1], 0.5)).norm(), 1e-9);
  EXPECT_LT((channel.points[1] - Eigen::Vector3d(centre[0], centre[1], 2.5)).norm(), 1e-9);
  EXPECT_LT((channel.points[2] - Eigen::Vector3d(centre[0] + 1.44, centre[1], 0.5)).norm(), 1e-9);
}

TEST(Toolpath, PrimesTheNozzleAlongTheFirstEdgeThatIsClear) {
  const Weave weave = sliding_cross();
  const PrinterProfile profile;
  const Toolpath plain = toolpath(weave, unprimed());
  ToolpathOptions options;
  const Toolpath path = toolpath(weave, profile);
  const auto priming = of_kind(path, MoveKind::priming);
  ASSERT_EQ(priming.size(), 1U);
  EXPECT_EQ(priming[0], &path.moves[1]) << "after the way to it";
  EXPECT_EQ(priming[0]->points, (std::vector<Eigen::Vector3d>{{5, 5, 0.5}, {65, 5, 0.5}}));
  EXPECT_NEAR(path.statistics.priming_length, 60, 1e-12);
  EXPECT_NEAR(path.statistics.extruded_length, plain.statistics.extruded_length + 60, 1e-9);
  EXPECT_EQ(path.statistics.travels, plain.statistics.travels + 1);
  EXPECT_EQ(path.statistics.lowest, plain.statistics.lowest) << "the box is that of the print";
  EXPECT_EQ(path.statistics.highest, plain.statistics.highest);
  for (std::size_t i = 1; i < path.moves.size(); ++i)
    EXPECT_LT((path.moves[i].points.front() - path.moves[i - 1].points.back()).norm(), 1e-12) << "no jump, move " << i;

  // The next edge is used if the print is too near to the first one.
  options.origin = Eigen::Vector2d(35, 19.9);
  Toolpath moved = toolpath(weave, profile, options);
  EXPECT_EQ(of_kind(moved, MoveKind::priming)[0]->points[0], Eigen::Vector3d(5, 205, 0.5)) << "4.9 mm are too near";
  options.origin = Eigen::Vector2d(35, 20);
  moved = toolpath(weave, profile, options);
  EXPECT_EQ(of_kind(moved, MoveKind::priming)[0]->points[0], Eigen::Vector3d(5, 5, 0.5)) << "5 mm are clear";
  const auto primed_in = [&](const Eigen::Vector2d& bed) {
    PrinterProfile small = profile;
    small.bed.head<2>() = bed;
    const Toolpath result = toolpath(weave, small);
    const auto lines = of_kind(result, MoveKind::priming);
    EXPECT_EQ(result.statistics.priming_length > 0, !lines.empty());
    return lines.empty() ? Eigen::Vector4d(-1, -1, -1, -1)
                         : Eigen::Vector4d(lines[0]->points[0][0], lines[0]->points[0][1], lines[0]->points[1][0],
                                           lines[0]->points[1][1]);
  };
  EXPECT_EQ(primed_in({40, 30}), Eigen::Vector4d(5, 5, 5, 25)) << "left, as long as the bed allows";
  EXPECT_EQ(primed_in({30, 40}), Eigen::Vector4d(5, 5, 25, 5));
  EXPECT_EQ(primed_in({39, 39}), Eigen::Vector4d(-1, -1, -1, -1)) << "no edge is clear";
}

TEST(Gcode, ParksTheNozzleWhereTheProfileSaysSo) {
  PrinterProfile profile;
  const Toolpath path = toolpath(sliding_cross(), profile);
  EXPECT_NE(to_gcode(path, profile).find("G0 X0 Y210 F3000 ; park\nM104 S0"), std::string::npos);
  EXPECT_TRUE(check_gcode(to_gcode(path, profile), limits_of(profile, sliding_cross())).violations.empty());
  profile.park = false;
  EXPECT_EQ(to_gcode(path, profile).find("park"), std::string::npos);
}

TEST(Toolpath, DrawsArcsThroughTheSameFeetAndApexAsTriangles) {
  PrinterProfile profile;
  profile.channel.shape = ChannelShape::arc;
  const Move channel = *of_kind(toolpath(sliding_cross(), profile), MoveKind::channel)[0];
  EXPECT_GT(channel.points.size(), 10U);
  EXPECT_NEAR(highest(channel), 2.5, 1e-9);
  EXPECT_NEAR((channel.points.front() - channel.points.back()).norm(), 1.2 * 2.2, 1e-9);
}

TEST(Toolpath, TurnsTheLongerHalfOfAChannelToWhereThereIsRoom) {
  Weave weave = sliding_cross();
  weave.strands[0] = line({-10, 0}, {1.3, 0});
  weave.crossings[0].members[0].coordinate = 10;
  const Move channel = *of_kind(toolpath(weave), MoveKind::channel)[0];
  EXPECT_NEAR(channel.points[0][0] - channel.points[1][0], 1.2, 1e-9);
  EXPECT_NEAR(channel.points[1][0] - channel.points[2][0], 1.44, 1e-9);
}

TEST(Toolpath, ComesDownAtFusedCrossingsAndStaysUpBetweenNearOnesThatSlide) {
  Weave weave;
  weave.strands.push_back(line({-12, 0}, {12, 0}));
  for (const double x : {-8.0, -4.0, 0.0, 4.0, 8.0}) weave.strands.push_back(line({x, -6}, {x, 6}));
  weave.crossings = find_crossings(weave.strands);
  for (const std::size_t c : {0U, 1U, 3U, 4U}) weave.crossings[c].members[0].slides = true;
  const Toolpath path = toolpath(weave);
  const auto lifted = of_kind(path, MoveKind::lifted);
  ASSERT_EQ(lifted.size(), 2U) << "one across the two crossings on either side of the fused one";
  EXPECT_NEAR((lifted[0]->points.front() - lifted[0]->points.back()).norm(), 8, 1e-9);
}

TEST(Toolpath, ClosesLoopsAndBeginsThemOnTheBed) {
  Weave weave = interlacing_circles_sheet(CircleType::all_slide, 2, 2);
  PrinterProfile profile;
  profile.lift.bridge = 1;
  profile.lift.run = 1.5;
  const Toolpath path = toolpath(weave, profile);
  Eigen::Vector3d begin{0, 0, 0};
  int strand = -1;
  int loops = 0;
  for (std::size_t i = 0; i < path.moves.size(); ++i) {
    const Move& move = path.moves[i];
    if (move.kind != MoveKind::strand && move.kind != MoveKind::lifted) continue;
    if (move.strand != strand) {
      strand = move.strand;
      begin = move.points.front();
      EXPECT_EQ(move.kind, MoveKind::strand);
    }
    const bool last = i + 1 == path.moves.size() || path.moves[i + 1].strand != strand;
    if (!last) continue;
    EXPECT_LT((move.points.back() - begin).norm(), 1e-6);
    ++loops;
  }
  EXPECT_EQ(loops, 4);
  EXPECT_NEAR(toolpath(interlacing_circles_sheet(CircleType::all_fused, 2, 2)).statistics.strand_length,
              4 * 2 * std::numbers::pi * 8, 0.2);
}

TEST(Toolpath, KeepsCurvedStrandsWithinTheChordError) {
  Weave weave;
  weave.strands.push_back(circle(20));
  ToolpathOptions options;
  options.origin = Eigen::Vector2d(100, 100);
  for (const double error : {0.05, 0.005, 0.0005}) {
    options.chord_error = error;
    const Toolpath path = toolpath(weave, {}, options);
    for (const Move* move : of_kind(path, MoveKind::strand))
      for (std::size_t i = 1; i < move->points.size(); ++i) {
        const Eigen::Vector3d middle = (move->points[i - 1] + move->points[i]) / 2;
        EXPECT_LT(20 - (middle.head<2>() - *options.origin).norm(), 1.05 * error);
      }
  }
}

TEST(Toolpath, PrintsStrandsOnBeyondTheirEndsAndFramesAndGripsAround) {
  ToolpathOptions options;
  options.origin = Eigen::Vector2d(50, 40);
  options.overrun = {5, 3};
  options.overruns[1] = {0, 1};
  options.frame = Frame{2, 4};
  options.grips.push_back({{-6, 20}, {-6, 0}, 2});
  const Toolpath path = toolpath(regular_sheet(2, 2, uniform_block(Connection::fused), 10), {}, options);
  EXPECT_NEAR(path.statistics.strand_length, 3 * 28 + 21, 1e-9);
  EXPECT_NEAR(path.statistics.support_length, 4 * 24 + 4 + 4 * 20 + 3 * 0.5, 1e-9);
  EXPECT_NEAR(path.statistics.lowest[0], 50 - 7.5, 1e-9) << "the grip's last pass, to the right of its direction";
  EXPECT_NEAR(path.statistics.lowest[1], 40 - 5, 1e-9);
}

TEST(Toolpath, TakesARequestedOrderThatPutsLowerStrandsFirst) {
  const Weave weave = sliding_cross();
  ToolpathOptions options;
  options.order = {0, 1};
  EXPECT_NO_THROW(toolpath(weave, {}, options));
  options.order = {1, 0};
  EXPECT_EQ(places(expect_error<NotPrintable>("weave.not_printable", [&] { toolpath(weave, {}, options); })),
            std::vector<std::string>{"crossings/0"});
  options.order = {0, 0};
  EXPECT_EQ(places(expect_error<InvalidOption>("weave.invalid_option", [&] { toolpath(weave, {}, options); })),
            std::vector<std::string>{"order"});
}

TEST(Toolpath, RefusesStrandsThatWouldLieBelowEachOther) {
  // Two strands along x and two along y, each of which slides across the next one of the four.
  Weave weave;
  weave.strands = {line({-10, -5}, {10, -5}), line({5, -10}, {5, 10}), line({10, 5}, {-10, 5}),
                   line({-5, 10}, {-5, -10})};
  weave.crossings = find_crossings(weave.strands);
  for (Crossing& c : weave.crossings) {
    const int a = c.members[0].strand;
    const int b = c.members[1].strand;
    c.members[(a + 1) % 4 == b ? 0 : 1].slides = true;
  }
  const Error error = expect_error<NotPrintable>("weave.not_printable", [&] { toolpath(weave); });
  EXPECT_EQ(error.details().size(), 4U);
}

TEST(Toolpath, NamesTheCrossingAndTheLengthThatItLacks) {
  const auto fault = [](const Weave& weave, const PrinterProfile& profile = {}) {
    const Error error = expect_error<NotPrintable>("weave.not_printable", [&] { toolpath(weave, profile); });
    return error.details().empty() ? Error::Detail{} : error.details()[0];
  };
  // The crossing is too near to the end of the lifted strand, and then too near to the end of the strand below.
  Weave weave = sliding_cross();
  weave.strands[1] = line({0, -10}, {0, 1});
  EXPECT_EQ(fault(weave).where, "crossings/0");
  EXPECT_NE(fault(weave).message.find("lifted 1.0000 mm"), std::string::npos) << fault(weave).message;
  const auto room = fault(weave).shortage;
  ASSERT_TRUE(room);
  EXPECT_NEAR(room->needed, 1, 1e-4);
  EXPECT_LT(room->available, room->needed);
  weave = sliding_cross();
  weave.strands[0] = line({-10, 0}, {1, 0});
  EXPECT_NE(fault(weave).message.find("1.0000 mm to the end of strands/0"), std::string::npos) << fault(weave).message;
  ASSERT_TRUE(fault(weave).shortage);
  EXPECT_NEAR(fault(weave).shortage->available, 1, 1e-12);
  EXPECT_NEAR(fault(weave).shortage->needed,
              PrinterProfile().channel.half_width * (1 + PrinterProfile().channel.longer), 1e-12);
  // A neighbour slides where a foot must stand.
  weave.strands = {line({-10, 0}, {10, 0}), line({0, -10}, {0, 10}), line({1.5, -10}, {1.5, 10})};
  weave.crossings = find_crossings(weave.strands);
  for (Crossing& crossing : weave.crossings) crossing.members[1].slides = true;
  EXPECT_NE(fault(weave).message.find("strand that slides at crossings/"), std::string::npos) << fault(weave).message;
  // The channel is too low, and then too narrow, for the strand inside it.
  PrinterProfile profile;
  profile.channel.apex = 1;
  EXPECT_NE(fault(sliding_cross(), profile).message.find("channel/apex must be at least"), std::string::npos);
  profile.channel.half_width = 0.2;
  EXPECT_NE(fault(sliding_cross(), profile).message.find("channel/half_width"), std::string::npos);
  // Two strands slide through each other.
  weave.strands = {line({-10, 0}, {10, 0}), line({0, -10}, {0, 10}), line({-10, -10}, {10, 10})};
  weave.crossings = find_crossings(weave.strands);
  weave.crossings[0].members[0].slides = weave.crossings[0].members[1].slides = true;
  EXPECT_NE(fault(weave).message.find("2 strands that slide"), std::string::npos);
  EXPECT_FALSE(fault(weave).shortage) << "no room would help";
  // The strands are nearly parallel.
  weave.strands = {line({-10, 0}, {10, 0}), line({-10, -1}, {10, 1})};
  weave.crossings = find_crossings(weave.strands);
  weave.crossings[0].members[0].slides = true;
  EXPECT_NE(fault(weave).message.find("10 degrees"), std::string::npos);
}

TEST(Toolpath, RefusesPeriodicLayoutsAndWhatIsLargerThanTheBed) {
  EXPECT_EQ(places(expect_error<NotPrintable>("weave.not_printable",
                                              [] { toolpath(interlacing_squares(SquareType::all_fused)); })),
            std::vector<std::string>{"lattice"});
  const Weave sheet = regular_sheet(20, 20, uniform_block(Connection::fused), 12);
  EXPECT_EQ(places(expect_error<NotPrintable>("weave.not_printable", [&] { toolpath(sheet); })),
            std::vector<std::string>{"bed"});
  ToolpathOptions options;
  options.origin = Eigen::Vector2d(5, -1);
  const Weave small = regular_sheet(2, 2, uniform_block(Connection::fused));
  const Error error = expect_error<NotPrintable>("weave.not_printable", [&] { toolpath(small, {}, options); });
  EXPECT_NE(std::string(error.what()).find(" in y, "), std::string::npos);
}

TEST(Toolpath, RefusesProfilesAndOptionsOutOfRange) {
  PrinterProfile profile;
  profile.filament_diameter = 0;
  profile.lift.run = 0.1;
  profile.startup_gcode = "G1 X1\v";
  EXPECT_EQ(places(expect_error<InvalidOption>("weave.invalid_option", [&] { toolpath(sliding_cross(), profile); })),
            (std::vector<std::string>{"filament_diameter", "lift/run", "startup_gcode"}));
  ToolpathOptions options;
  options.overrun.start = -1;
  options.overruns[7] = {};
  options.chord_error = 0;
  EXPECT_EQ(
      places(expect_error<InvalidOption>("weave.invalid_option", [&] { toolpath(sliding_cross(), {}, options); })),
      (std::vector<std::string>{"overrun/start", "overruns/7", "chord_error"}));
}

TEST(Toolpath, NamesEachLengthAndSpeedOfAProfileThatIsNone) {
  const std::vector<std::pair<std::string, double PrinterProfile::*>> fields{
      {"nozzle_diameter", &PrinterProfile::nozzle_diameter},
      {"filament_diameter", &PrinterProfile::filament_diameter},
      {"strand_width", &PrinterProfile::strand_width},
      {"lifted_flow", &PrinterProfile::lifted_flow},
      {"channel_flow", &PrinterProfile::channel_flow},
      {"strand_height", &PrinterProfile::strand_height},
      {"travel_clearance", &PrinterProfile::travel_clearance},
      {"strand_speed", &PrinterProfile::strand_speed},
      {"lifted_speed", &PrinterProfile::lifted_speed},
      {"channel_speed", &PrinterProfile::channel_speed},
      {"travel_speed", &PrinterProfile::travel_speed},
      {"retraction_speed", &PrinterProfile::retraction_speed}};
  for (const auto& [name, field] : fields)
    for (const double value : {0.0, -1.0, 1e9}) {
      PrinterProfile profile;
      profile.*field = value;
      EXPECT_EQ(
          places(expect_error<InvalidOption>("weave.invalid_option", [&] { toolpath(sliding_cross(), profile); })),
          std::vector<std::string>{name})
          << value;
    }
}

TEST(Toolpath, BeginsALoopInTheMiddleOfItsLongestWayOnTheBed) {
  // The circle passes over the line at two places above its centre. The longer part of it between them is the one
  // below.
  for (const double side : {1.0, -1.0}) {
    Weave weave;
    weave.strands = {line({-12, 5 * side}, {12, 5 * side}), circle(8)};
    weave.crossings = find_crossings(weave.strands);
    ASSERT_EQ(weave.crossings.size(), 2U);
    for (Crossing& crossing : weave.crossings) crossing.members[1].slides = true;
    ToolpathOptions options;
    options.origin = Eigen::Vector2d(100, 100);
    const Toolpath path = toolpath(weave, {}, options);
    const auto first = std::find_if(path.moves.begin(), path.moves.end(),
                                    [](const Move& move) { return move.kind == MoveKind::strand && move.strand == 1; });
    ASSERT_NE(first, path.moves.end());
    EXPECT_LT((first->points.front().head<2>() - Eigen::Vector2d(100, 100 - 8 * side)).norm(), 0.05);
  }
}

TEST(Toolpath, RefusesGripsOfMorePassesThanCanBePrinted) {
  // Each grip is 100 mm wide and has 10 000 passes of lines 0.01 mm wide. A hundred of them reach the limit of a
  // million passes.
  PrinterProfile profile;
  profile.strand_width = 0.01;
  ToolpathOptions options;
  options.grips.assign(100, {{-6, 20}, {-6, 0}, 100.01});
  EXPECT_EQ(
      places(expect_error<InvalidOption>("weave.invalid_option", [&] { toolpath(sliding_cross(), profile, options); })),
      std::vector<std::string>{"grips"});
  options.grips.push_back({{-6, 20}, {-6, 0}, 1});
  const Error more =
      expect_error<InvalidOption>("weave.invalid_option", [&] { toolpath(sliding_cross(), profile, options); });
  EXPECT_EQ(places(more), (std::vector<std::string>{"grips", "grips"}));
}

TEST(Toolpath, DrawsEachMoveInItsPicture) {
  const Toolpath path = toolpath(sliding_cross());
  const std::string svg = to_svg(path);
  std::size_t drawn = 0;
  for (std::size_t at = svg.find("<path"); at != std::string::npos; at = svg.find("<path", at + 1)) ++drawn;
  EXPECT_EQ(drawn, path.moves.size());
  EXPECT_NE(svg.find("class=\"channel\""), std::string::npos);
}

TEST(Toolpath, DrawsEachKindOfMoveInAColourOfItsOwnAsWideAsItsBead) {
  Toolpath path;
  const std::vector<MoveKind> kinds{MoveKind::priming, MoveKind::strand,  MoveKind::lifted,
                                    MoveKind::channel, MoveKind::support, MoveKind::travel};
  for (const MoveKind kind : kinds) {
    Move move;
    move.kind = kind;
    move.area = std::numbers::pi / 4;
    move.points = {{1, 2, 0}, {4, 6, 0}};
    path.moves.push_back(move);
  }
  const std::string svg = to_svg(path);
  std::set<std::string> colours;
  for (const MoveKind kind : kinds) {
    const std::string shown =
        std::string("<path class=\"") + std::string(to_string(kind)) + "\" fill=\"none\" stroke=\"";
    const auto at = svg.find(shown);
    ASSERT_NE(at, std::string::npos) << to_string(kind);
    const std::string colour = svg.substr(at + shown.size(), 7);
    EXPECT_EQ(colour.find_first_not_of("#0123456789abcdef"), std::string::npos) << colour;
    EXPECT_TRUE(colours.insert(colour).second) << colour;
    const std::string rest = svg.substr(at + shown.size() + 7, svg.find('\n', at) - at - shown.size() - 7);
    EXPECT_EQ(rest, std::string("\" stroke-width=\"") + (kind == MoveKind::travel ? "0.080" : "1.000") +
                        "\" d=\"M1.000 -2.000L4.000 -6.000\"/>");
  }
  EXPECT_NE(svg.find("viewBox=\"-1.000 -8.000 7.000 8.000\" width=\"7.000mm\" height=\"8.000mm\""), std::string::npos)
      << "two millimetres around";
}

TEST(Gcode, OfWavyStrandsThatSlidePassesTheCheckAndIsTheSameEachTime) {
  const Weave weave = wavy();
  const PrinterProfile profile;
  const Toolpath path = toolpath(weave, profile);
  const std::string gcode = to_gcode(path, profile);
  EXPECT_EQ(gcode, to_gcode(toolpath(weave, profile), profile));
  const GcodeReport report = check_gcode(gcode, limits_of(profile, weave));
  EXPECT_EQ(report.violation_count, 0);
  for (const Violation& v : report.violations) ADD_FAILURE() << v.line << ": " << v.message;
  EXPECT_EQ(static_cast<int>(report.channels.size()), path.statistics.channels);
  EXPECT_GT(report.channels.size(), 0U);
}

TEST(Gcode, CarriesTheProfilesTemperaturesAndOwnLines) {
  PrinterProfile profile;
  profile.nozzle_temperature = 205;
  profile.startup_gcode = "G92 E0 ; mine";
  profile.footer_gcode = "M106 S255";
  const std::string gcode = to_gcode(toolpath(sliding_cross(), profile), profile);
  EXPECT_NE(gcode.find("M109 S205 "), std::string::npos);
  EXPECT_LT(gcode.find("G28"), gcode.find("; mine"));
  EXPECT_LT(gcode.find("M106 S255\n"), gcode.find("M104 S0"));
}

/// Start lines as owners of printers write them, with a name for each. After none of them has the program a fault.
const std::vector<std::pair<std::string, std::string>> start_lines{
    {"relative extrusion", "M83"},
    {"of a Prusa", "M862.3 P \"MK3S\"\nM115 U3.13.2\nM900 K0.05\nM221 S95"},
    {"Windows' line ends", "M83\r\nG92 E0\r\n"},
    {"relative positions", "G91\nG1 Z5 F600\nG1 Z-2"},
    {"inches", "G20"},
    {"macros", "START_PRINT BED_TEMP=60 EXTRUDER_TEMP=205\nBED_MESH_CALIBRATE"},
    {"line numbers", "N1 M110 N1*125\nN2 M83*17\nn3 G28 *20"},
    {"lower case", "g28\nm83\ng92 e0"},
    {"first tool, levelling and time", "T0\nG29\nM73 P0\nG80"},
    {"a thick line beside the bed",
     "G1 Y-3.0 F1000.0 ; outside the print area\nG1 Z0.2\nM83\nG1 X60.0 E9.0 F1000.0\nG1 X100.0 E12.5 F9000.0\nG92 "
     "E0.0"},
    {"placeholders in comments", "M300 ; [not replaced] {here}\nM117 \"[ok]\""},
};

TEST(Gcode, PrintsTheSameAfterAnyStartLines) {
  const Weave weave = sliding_cross();
  PrinterProfile profile;
  profile.nozzle_temperature = 205;
  profile.priming_length = 0;
  const Toolpath path = toolpath(weave, profile);
  const GcodeReport plain = check_gcode(to_gcode(path, profile), limits_of(profile, weave));
  for (const auto& [name, lines] : start_lines) {
    SCOPED_TRACE(name);
    profile.startup_gcode = lines;
    const std::string gcode = to_gcode(path, profile);
    EXPECT_EQ(gcode.find('\r'), std::string::npos);
    const GcodeReport report = check_gcode(gcode, limits_of(profile, weave));
    for (const Violation& v : report.violations) ADD_FAILURE() << v.line << ": " << v.message;
    EXPECT_EQ(report.highest, plain.highest);
    EXPECT_EQ(report.lowest, plain.lowest);
    EXPECT_EQ(report.channels.size(), plain.channels.size());
  }
}

TEST(Gcode, ThatAFactorOfTheFlowHalvesIsFound) {
  PrinterProfile profile;
  profile.startup_gcode = "M221 S50";
  const Weave weave = sliding_cross();
  const auto report = check_gcode(to_gcode(toolpath(weave, profile), profile), limits_of(profile, weave));
  ASSERT_GT(report.violation_count, 0);
  EXPECT_EQ(report.violations[0].kind, ViolationKind::under_extrusion);
}

TEST(Gcode, NamesPlaceholdersThatWereNotReplaced) {
  for (const auto& [line, shown] : std::vector<std::pair<std::string, std::string>>{
           {"M104 S[first_layer_temperature]", "[first_layer_temperature]"},
           {"M190 S{material_bed_temperature}", "{material_bed_temperature}"},
           {"{if first_layer_bed_temperature[0] > 50}M140 S60{endif}", "{if first_layer_bed_temperature[0] > 50}"},
           {"M140 S{broken", "{broken"}}) {
    PrinterProfile profile;
    profile.startup_gcode = "M83 ; [fine]\r\n" + line;
    const Error error = expect_error<InvalidOption>("weave.invalid_option", [&] { validate(profile); });
    EXPECT_EQ(places(error), std::vector<std::string>{"startup_gcode"});
    EXPECT_NE(std::string(error.what()).find("line 2: the placeholder " + shown), std::string::npos) << error.what();
  }
  PrinterProfile profile;
  profile.footer_gcode = "M117 [done]";
  EXPECT_EQ(places(expect_error<InvalidOption>("weave.invalid_option", [&] { validate(profile); })),
            std::vector<std::string>{"footer_gcode"});
  profile.footer_gcode = "; caf\xc3\xa9";
  EXPECT_NE(std::string(expect_error<InvalidOption>("weave.invalid_option", [&] { validate(profile); }).what())
                .find("line 1"),
            std::string::npos);
}

TEST(Gcode, NamesEachMovesStrandOnce) {
  const std::string gcode = to_gcode(toolpath(sliding_cross(), PrinterProfile{}), PrinterProfile{});
  EXPECT_NE(gcode.find("; strand 0\n"), std::string::npos);
  EXPECT_EQ(gcode.find("strand strand"), std::string::npos);
}

}  // namespace
}  // namespace supple::weave
