#include "supple/weave/gcode.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <string>
#include <utility>

#include "own_gcode.h"
#include "supple/weave/gcode_check.h"

namespace supple::weave {
namespace {

constexpr double park_height = 30;  ///< above the print, as far as the bed's height allows, mm

/// The shortest text of a number with at most this many decimals. It does not depend on the locale.
std::string decimal(double value, int decimals) {
  std::array<char, 64> text{};
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, decimals).ptr;
  std::string result(text.data(), end);
  if (result.find('.') != std::string::npos) {
    result.erase(result.find_last_not_of('0') + 1);
    if (result.back() == '.') result.pop_back();
  }
  return result == "-0" ? "0" : result;
}

class GcodeWriter {
 public:
  explicit GcodeWriter(const PrinterProfile& profile) : profile_(profile) {}

  void line(const std::string& text) { text_ += text + "\n"; }
  void own_lines(const std::string& text) { text_ += own_gcode_lines(text); }

  void travel(const Move& move) {
    push_filament_to(filament_ - profile_.retraction);
    for (std::size_t i = 1; i < move.points.size(); ++i)
      move_to("G0", move.points[i - 1], move.points[i], move.speed, "");
    push_filament_to(filament_);
  }

  void extrude(const Move& move) {
    const double filament_per_length = filament_per_mm(profile_, move.area);
    for (std::size_t i = 1; i < move.points.size(); ++i) {
      filament_ += filament_per_length * (move.points[i] - move.points[i - 1]).norm();
      move_to("G1", move.points[i - 1], move.points[i], move.speed, " E" + decimal(filament_, 5));
    }
  }

  /// Moves up from the print and out of its way, and switches everything off.
  void finish(double height) {
    const std::string speed = " F" + decimal(profile_.travel_speed, 1);
    push_filament_to(filament_ - profile_.retraction);
    line("G0 Z" + decimal(height, 3) + speed);
    if (profile_.park) line("G0 X0 Y" + decimal(profile_.bed[1], 3) + speed + " ; park");
    own_lines(profile_.footer_gcode);
    for (const char* off : {"M104 S0 ; nozzle off", "M140 S0 ; bed off", "M107 ; fan off", "M84 ; motors off"})
      line(off);
  }

  std::string take() { return std::move(text_); }

 private:
  void push_filament_to(double filament) {
    if (profile_.retraction > 0) line("G1 E" + decimal(filament, 5) + " F" + decimal(profile_.retraction_speed, 1));
  }

  void move_to(const char* command, const Eigen::Vector3d& from, const Eigen::Vector3d& to, double speed,
               const std::string& extrusion) {
    if (from == to) return;
    constexpr std::array letters{" X", " Y", " Z"};
    text_ += command;
    for (int axis = 0; axis < 3; ++axis)
      if (from[axis] != to[axis]) text_ += letters[static_cast<std::size_t>(axis)] + decimal(to[axis], 3);
    text_ += extrusion + " F" + decimal(speed, 1) + "\n";
  }

  const PrinterProfile& profile_;
  std::string text_;
  double filament_ = 0;
};

}  // namespace

std::string to_gcode(const Toolpath& toolpath, const PrinterProfile& profile) {
  validate(profile);
  GcodeWriter writer(profile);
  const ToolpathStatistics& s = toolpath.statistics;
  const std::string nozzle = decimal(profile.nozzle_temperature, 1);
  const std::string bed = decimal(profile.bed_temperature, 1);
  writer.line("; " + profile.name);
  writer.line("; extruded " + decimal(s.extruded_length, 1) + " mm, filament " + decimal(s.filament, 1) + " mm, " +
              std::to_string(s.channels) + " channels, " + decimal(s.minutes, 1) + " min");
  writer.line("G21 ; millimetres");
  writer.line("G90 ; absolute positions");
  writer.line("M82 ; absolute extrusion");
  writer.line("M104 S" + nozzle + " ; heat the nozzle");
  writer.line("M140 S" + bed + " ; heat the bed");
  writer.line("M190 S" + bed + " ; wait for the bed");
  writer.line("M109 S" + nozzle + " ; wait for the nozzle");
  writer.line("G28 ; home");
  if (!profile.startup_gcode.empty()) {
    writer.line(std::string(own_lines_begin));
    writer.own_lines(profile.startup_gcode);
    writer.line(std::string(own_lines_end));
    // The owner's lines may have changed the modes.
    writer.line("G21 ; millimetres");
    writer.line("G90 ; absolute positions");
    writer.line("M82 ; absolute extrusion");
  }
  writer.line("G92 E0");
  if (!toolpath.moves.empty()) {
    const Eigen::Vector3d& start = toolpath.moves.front().points.front();
    writer.line("G0 Z" + decimal(start[2], 3) + " F" + decimal(profile.travel_speed, 1));
    writer.line("G0 X" + decimal(start[0], 3) + " Y" + decimal(start[1], 3) + " F" + decimal(profile.travel_speed, 1));
  }
  for (const Move& move : toolpath.moves) {
    std::string comment = "; " + std::string(to_string(move.kind));
    if (move.strand >= 0) comment += (move.kind == MoveKind::strand ? " " : " strand ") + std::to_string(move.strand);
    if (move.crossing >= 0) comment += " crossing " + std::to_string(move.crossing);
    writer.line(comment);
    if (move.kind == MoveKind::travel)
      writer.travel(move);
    else
      writer.extrude(move);
  }
  writer.finish(std::min(profile.bed[2], s.highest[2] + park_height));
  return writer.take();
}

}  // namespace supple::weave
