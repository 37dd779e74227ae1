#include "supple/weave/gcode_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <numbers>
#include <string>
#include <utility>

#include "gcode_channels.h"
#include "gcode_machine.h"
#include "gcode_words.h"

namespace supple::weave {
namespace {

constexpr double level_tolerance = 1e-3;    ///< beads that rise by less than this are level, mm
constexpr double bed_tolerance = 0.05;      ///< height above the main level up to which beads lie on the bed, mm
constexpr double max_height = 1e12;         ///< limit of heights that are counted in micrometres, mm
constexpr std::size_t max_heights = 1000;   ///< number of heights in a report
constexpr int lines_between_checks = 1000;  ///< between two checks for a stop request
/// Steps to which written positions and filament are rounded, mm.
constexpr double position_step = 1e-3;
constexpr double filament_step = 1e-5;

double length_of(const Bead& bead) { return (bead.to - bead.from).norm(); }

/// Length (mm) of the level beads at each height (micrometres).
std::map<std::int64_t, double> lengths_by_height(const std::vector<Bead>& beads) {
  std::map<std::int64_t, double> result;
  for (const Bead& bead : beads)
    if (std::abs(bead.to[2] - bead.from[2]) <= level_tolerance)
      result[std::llround(std::clamp(bead.to[2], -max_height, max_height) * 1000)] += length_of(bead);
  return result;
}

void check_areas(const std::vector<Bead>& beads, double bed_height, const GcodeLimits& limits, GcodeMachine& machine) {
  const double filament_area = std::numbers::pi * limits.filament_diameter * limits.filament_diameter / 4;
  const double max_area = limits.bead_area * (1 + limits.tolerance);
  for (const Bead& bead : beads) {
    const double length = length_of(bead);
    const double area = bead.filament * filament_area / length;
    const bool is_above_bed = std::max(bead.from[2], bead.to[2]) > bed_height + bed_tolerance;
    const double min_area = (is_above_bed ? limits.min_lifted_area : limits.min_bead_area) * (1 - limits.tolerance);
    const double rounding = (2 * filament_step * filament_area + 2 * position_step * limits.bead_area) / length;
    if (area <= max_area + rounding && area >= min_area - rounding) continue;
    std::array<char, 128> text{};
    std::snprintf(text.data(), text.size(), "a bead of %.4g mm^2, must lie within %.4g and %.4g", area, min_area,
                  max_area);
    machine.add_violation(area > max_area ? ViolationKind::over_extrusion : ViolationKind::under_extrusion, bead.line,
                          text.data());
  }
}

}  // namespace

std::string_view to_string(ViolationKind kind) {
  switch (kind) {
    case ViolationKind::malformed_word:
      return "malformed_word";
    case ViolationKind::unknown_command:
      return "unknown_command";
    case ViolationKind::not_homed:
      return "not_homed";
    case ViolationKind::outside_bed:
      return "outside_bed";
    case ViolationKind::y_below_zero:
      return "y_below_zero";
    case ViolationKind::z_below_zero:
      return "z_below_zero";
    case ViolationKind::cold_extrusion:
      return "cold_extrusion";
    case ViolationKind::over_extrusion:
      return "over_extrusion";
    case ViolationKind::under_extrusion:
      return "under_extrusion";
    case ViolationKind::travel_without_retraction:
      return "travel_without_retraction";
    case ViolationKind::too_fast:
      return "too_fast";
    case ViolationKind::no_speed:
      break;
  }
  return "no_speed";
}

GcodeLimits limits_of(const PrinterProfile& profile, const Weave& weave) {
  GcodeLimits limits;
  limits.bed = profile.bed;
  limits.filament_diameter = profile.filament_diameter;
  // The beads of frames and grips, and of each strand, set the limits.
  const auto area = [&](double radius) { return profile.bead_area.value_or(std::numbers::pi * radius * radius); };
  limits.bead_area = limits.min_bead_area = area(profile.strand_width / 2);
  for (const Strand& strand : weave.strands) {
    limits.bead_area = std::max(limits.bead_area, area(strand.radius));
    limits.min_bead_area = std::min(limits.min_bead_area, area(strand.radius));
  }
  limits.min_lifted_area = limits.min_bead_area * std::min({1.0, profile.lifted_flow, profile.channel_flow});
  limits.bead_area *= std::max({1.0, profile.lifted_flow, profile.channel_flow});
  limits.cold = std::min(limits.cold, profile.nozzle_temperature);
  limits.print_speed = std::max({profile.strand_speed, profile.lifted_speed, profile.channel_speed});
  limits.travel_speed = std::max(profile.travel_speed, profile.retraction_speed);
  limits.retraction = profile.retraction;
  limits.strand_width = profile.strand_width;
  return limits;
}

GcodeReport check_gcode(std::string_view text, const GcodeLimits& limits, const Execution& execution) {
  GcodeMachine machine(limits);
  int lines = 0;
  for (std::size_t begin = 0; begin < text.size();) {
    if (lines % lines_between_checks == 0)
      execution.checkpoint(static_cast<double>(begin) / static_cast<double>(text.size()), "check");
    const std::string_view line = next_gcode_line(text, begin);
    if (line == own_lines_begin || line == own_lines_end) machine.set_own_lines(line == own_lines_begin);
    machine.execute(read_gcode_line(line), ++lines);
  }
  const std::vector<Bead>& beads = machine.beads();
  const std::map<std::int64_t, double> heights = lengths_by_height(beads);
  const auto bed = std::max_element(heights.begin(), heights.end(),
                                    [](const auto& a, const auto& b) { return a.second < b.second; });
  const double bed_height = bed != heights.end() ? static_cast<double>(bed->first) / 1000 : -max_height;
  check_areas(beads, bed_height, limits, machine);

  GcodeReport report = std::move(machine.report());
  report.lines = lines;
  for (const auto& [micrometres, length] : heights) {
    if (report.heights.size() == max_heights) break;
    report.heights.push_back(static_cast<double>(micrometres) / 1000);
  }
  Eigen::AlignedBox3d box;
  for (const Bead& bead : beads) {
    box.extend(bead.from);
    box.extend(bead.to);
  }
  if (!box.isEmpty()) {
    report.lowest = box.min();
    report.highest = box.max();
  }
  report.channels = find_channels(beads, limits.strand_width, execution.cancellation);
  for (const FoundChannel& channel : report.channels) report.channel_length += channel.length;
  std::stable_sort(report.violations.begin(), report.violations.end(),
                   [](const Violation& a, const Violation& b) { return a.line < b.line; });
  return report;
}

}  // namespace supple::weave
