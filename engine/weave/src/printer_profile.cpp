#include "supple/weave/printer_profile.h"
#include "own_gcode.h"
#include "supple/base/faults.h"
#include "supple/base/number_text.h"
#include "supple/weave/weave_error.h"

#include <cmath>
#include <numbers>
#include <string>

namespace supple::weave {
namespace {

constexpr std::size_t max_text_length = 20'000;
constexpr double max_bed_size = 10'000;  ///< mm
constexpr double max_length = 100;       ///< limit of the sizes of beads, lifts and channels, mm
constexpr double max_speed = 100'000;    ///< mm/min
constexpr double max_temperature = 500;  ///< degrees Celsius

/// Requires a value within [low, high], or (low, high] if it must be `positive`.
void check_range(Faults& faults, double value, const char* where, double low, double high, const char* unit,
                 bool positive = false) {
  faults.require(value >= low && value <= high && !(positive && value <= 0), where,
                 std::string("must lie within ") + (positive ? "(" : "[") + number_text(low) + ", " +
                     number_text(high) + "] " + unit + ", got " + number_text(value));
}

bool printable(const std::string& text) {
  if (text.size() > max_text_length) return false;
  for (const char c : text)
    if (c != '\n' && (c < ' ' || c > '~')) return false;
  return true;
}

}  // namespace

void validate(const PrinterProfile& profile) {
  Faults faults;
  const auto length = [&](double value, const char* where) {
    check_range(faults, value, where, 0, max_length, "mm", true);
  };
  const auto speed = [&](double value, const char* where) {
    check_range(faults, value, where, 0, max_speed, "mm/min", true);
  };
  faults.require(profile.name.find('\n') == std::string::npos && printable(profile.name), "name",
                 "must be one line of printable ASCII");
  faults.require(profile.bed.allFinite() && profile.bed.minCoeff() > 0 && profile.bed.maxCoeff() <= max_bed_size, "bed",
                 "must lie within (0, " + std::to_string(static_cast<int>(max_bed_size)) + "] mm in x, y and z");
  length(profile.nozzle_diameter, "nozzle_diameter");
  length(profile.filament_diameter, "filament_diameter");
  check_range(faults, profile.nozzle_temperature, "nozzle_temperature", 0, max_temperature, "degrees");
  check_range(faults, profile.bed_temperature, "bed_temperature", 0, max_temperature, "degrees");
  length(profile.strand_width, "strand_width");
  if (profile.bead_area) check_range(faults, *profile.bead_area, "bead_area", 0, max_length, "mm^2", true);
  check_range(faults, profile.lifted_flow, "lifted_flow", 0, 2, "", true);
  check_range(faults, profile.channel_flow, "channel_flow", 0, 2, "", true);
  length(profile.strand_height, "strand_height");
  length(profile.travel_clearance, "travel_clearance");
  check_range(faults, profile.retraction, "retraction", 0, max_length, "mm");
  check_range(faults, profile.priming_length, "priming_length", 0, max_bed_size, "mm");
  length(profile.lift.height, "lift/height");
  length(profile.lift.top, "lift/top");
  check_range(faults, profile.lift.run, "lift/run", profile.lift.top, max_length, "mm", true);
  check_range(faults, profile.lift.bridge, "lift/bridge", 0, max_length, "mm");
  length(profile.channel.half_width, "channel/half_width");
  check_range(faults, profile.channel.longer, "channel/longer", 0, 2, "");
  length(profile.channel.apex, "channel/apex");
  speed(profile.strand_speed, "strand_speed");
  speed(profile.lifted_speed, "lifted_speed");
  speed(profile.channel_speed, "channel_speed");
  speed(profile.travel_speed, "travel_speed");
  speed(profile.retraction_speed, "retraction_speed");
  const std::string text = "must be printable ASCII of at most " + std::to_string(max_text_length) + " characters";
  const auto own_lines = [&](const std::string& lines, const char* where) {
    faults.require(lines.size() <= max_text_length, where, text);
    if (lines.size() > max_text_length) return;
    if (const auto fault = fault_of_own_gcode(lines)) faults.add(where, *fault);
  };
  own_lines(profile.startup_gcode, "startup_gcode");
  own_lines(profile.footer_gcode, "footer_gcode");
  faults.throw_if_any<InvalidOption>("weave.invalid_option");
}

double bead_area(const PrinterProfile& profile, double radius) {
  return profile.bead_area.value_or(std::numbers::pi * radius * radius);
}

double filament_per_mm(const PrinterProfile& profile, double area) {
  return area / (std::numbers::pi * profile.filament_diameter * profile.filament_diameter / 4);
}

}  // namespace supple::weave
