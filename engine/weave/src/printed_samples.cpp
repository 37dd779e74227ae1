#include "supple/weave/printed_samples.h"

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "supple/weave/patterns.h"

namespace supple::weave {
namespace {

using std::numbers::pi;

/// Area of a bead as slicing programs compute it: a rectangle with half circles at its sides; mm^2.
constexpr double slicer_area(double width, double height) {
  return height * (width - height) + pi * height * height / 4;
}
/// Area of a strand's bead: 1.2 times the nozzle's diameter wide and 0.5 mm high.
constexpr double strand_area = slicer_area(0.48, 0.5);
/// Area of a channel's bead: the same width, 0.2 mm high.
constexpr double channel_area = slicer_area(0.48, 0.2);

PrinterProfile sample_profile() {
  PrinterProfile profile;
  profile.bead_area = strand_area;
  // The published statistics do not include the start and the end.
  profile.priming_length = 0;
  profile.park = false;
  profile.channel_flow = channel_area / strand_area;
  return profile;
}

PrintJob grid(Connection connection) {
  PrintJob job{regular_sheet(20, 20, uniform_block(connection)), sample_profile(), {}};
  job.profile.lifted_flow = 0.55;
  job.profile.channel.longer = 0.4;
  // The overruns, three tenths of a strand each, fasten the strand to the bed.
  job.options.overrun = {24, 24};
  job.options.frame = Frame{0, 16};
  return job;
}

/// The layout without the removed strands. Crossings that are left with one strand are removed too.
Weave without(const Weave& weave, const std::vector<bool>& removed) {
  Weave result;
  result.material = weave.material;
  std::vector<int> number(weave.strands.size(), -1);
  for (std::size_t s = 0; s < weave.strands.size(); ++s) {
    if (removed[s]) continue;
    number[s] = static_cast<int>(result.strands.size());
    result.strands.push_back(weave.strands[s]);
  }
  for (const Crossing& crossing : weave.crossings) {
    Crossing remaining;
    for (CrossingMember member : crossing.members) {
      if (removed[static_cast<std::size_t>(member.strand)]) continue;
      member.strand = number[static_cast<std::size_t>(member.strand)];
      remaining.members.push_back(member);
    }
    if (remaining.members.size() > 1) result.crossings.push_back(std::move(remaining));
  }
  return result;
}

/// Bars on the left and on the right of a sheet that extends from `low` to `high` in y; mm.
std::vector<Grip> grips(double left, double right, double low, double high) {
  return {{{left, high}, {left, low}, 10}, {{right, low}, {right, high}, 10}};
}

PrintJob squares(SquareType type) {
  constexpr int count = 5;
  constexpr double size = 79.2;
  const Weave sheet = interlacing_squares_sheet(type, count, count);
  // The grips replace the outermost sides.
  std::vector<bool> removed(sheet.strands.size(), false);
  for (std::size_t row = 0; row < count; ++row) {
    removed[4 * (row * count) + 3] = true;
    removed[4 * (row * count + count - 1) + 1] = true;
  }
  PrintJob job{without(sheet, removed), sample_profile(), {}};
  job.profile.lift.height = 1.25;
  job.profile.lifted_flow = 0.85;
  job.profile.channel.apex = 2.05;
  job.profile.channel.longer = 0.6;
  job.options.overrun = {0.6, 0.6};
  job.options.grips = grips(0, size, 0, size);
  return job;
}

Strand arc(const Eigen::Vector2d& centre, double radius, double from, double to) {
  constexpr int pieces = 32;
  std::vector<Eigen::Vector2d> points;
  points.reserve(pieces + 1);
  for (int i = 0; i <= pieces; ++i) {
    const double angle = from + (to - from) * i / pieces;
    points.emplace_back(centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return {StrandCurve(points, Ends::open)};
}

PrintJob circles(CircleType type) {
  constexpr int columns = 6;
  constexpr int rows = 5;
  constexpr double radius = 8;
  constexpr double distance = 14.4;
  PrintJob job{interlacing_circles_sheet(CircleType::all_fused, columns, rows, radius, distance), sample_profile(), {}};
  Weave& weave = job.weave;
  for (std::size_t row = 0; row < rows; ++row) {
    const double y = static_cast<double>(row) * distance;
    weave.strands[row * columns] = arc({0, y}, radius, -pi / 2, pi / 2);
    weave.strands[row * columns + columns - 1] = arc({(columns - 1) * distance, y}, radius, pi / 2, 3 * pi / 2);
  }
  weave.crossings = find_crossings(weave.strands);
  if (type == CircleType::all_slide) {
    for (Crossing& crossing : weave.crossings) {
      // Beside each other the left circle slides, above each other the upper one, except at the left grip, where they
      // are fused.
      const int first = crossing.members[0].strand;
      const int second = crossing.members[1].strand;
      const bool beside = first / columns == second / columns;
      if (!beside && first % columns == 0) continue;
      crossing.members[beside == (first < second) ? 0 : 1].slides = true;
    }
  }
  job.profile.lift = {1, 0.75, 2, 1};
  job.profile.lifted_flow = 0.57;
  job.profile.channel.half_width = 1.6;
  job.profile.channel.longer = 0.5;
  job.options.overrun = {1.6, 1.6};
  job.options.loop_overlap = 1.6;
  job.options.grips = grips(0, (columns - 1) * distance, -radius, (rows - 1) * distance + radius);
  return job;
}

PrintJob actuation() {
  constexpr double inner = 12;
  constexpr double outer = 28;
  constexpr double end = 44;
  PrintJob job{{}, sample_profile(), {}};
  Weave& weave = job.weave;
  for (const double radius : {inner, 20.0, outer}) {
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < 72; ++i) {
      const double angle = 2 * pi * i / 72;
      points.emplace_back(radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    weave.strands.push_back({StrandCurve(points, Ends::closed)});
  }
  const auto line = [&](const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
    weave.strands.push_back({StrandCurve({from, to}, Ends::open)});
  };
  // The slanted spokes do not enter the innermost ring: where more than two strands meet, none can slide well.
  for (const double angle : {pi / 4, 3 * pi / 4, 5 * pi / 4, 7 * pi / 4}) {
    const Eigen::Vector2d d(std::cos(angle), std::sin(angle));
    line(inner * d, outer * d);
  }
  line({-outer, 0}, {outer, 0});
  line({0, outer}, {0, -end});
  const auto pushed = static_cast<int>(weave.strands.size()) - 1;
  weave.crossings = find_crossings(weave.strands);
  for (Crossing& crossing : weave.crossings)
    for (CrossingMember& m : crossing.members)
      if (m.strand == pushed && m.coordinate > 1e-6 * outer) m.slides = true;
  job.profile.lift = {1.5, 0.75, 2.5, 2.5};
  job.profile.channel = {ChannelShape::triangle, 1.2, 0.6, 2.35};
  job.options.loop_overlap = 1.75;
  job.options.overruns[pushed] = {15.6, 21.6};
  return job;
}

}  // namespace

std::string_view to_string(Sample sample) {
  switch (sample) {
    case Sample::fused_grid:
      return "fused_grid";
    case Sample::sliding_grid:
      return "sliding_grid";
    case Sample::squares_1:
      return "squares_1";
    case Sample::squares_2:
      return "squares_2";
    case Sample::squares_3:
      return "squares_3";
    case Sample::squares_4:
      return "squares_4";
    case Sample::circles_fused:
      return "circles_fused";
    case Sample::circles_sliding:
      return "circles_sliding";
    case Sample::actuation:
      break;
  }
  return "actuation";
}

PrintJob printed_sample(Sample sample) {
  switch (sample) {
    case Sample::fused_grid:
      return grid(Connection::fused);
    case Sample::sliding_grid:
      return grid(Connection::slides_y);
    case Sample::squares_1:
      return squares(SquareType::all_fused);
    case Sample::squares_2:
      return squares(SquareType::all_slide_x);
    case Sample::squares_3:
      return squares(SquareType::slide_both_ways);
    case Sample::squares_4:
      return squares(SquareType::one_corner_fused);
    case Sample::circles_fused:
      return circles(CircleType::all_fused);
    case Sample::circles_sliding:
      return circles(CircleType::all_slide);
    case Sample::actuation:
      break;
  }
  return actuation();
}

}  // namespace supple::weave
