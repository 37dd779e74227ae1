#include "gcode_machine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <utility>

namespace supple::weave {
namespace {

constexpr std::size_t max_violations = 1000;
constexpr double position_slack = 1e-6;  ///< written positions are rounded by less, mm
constexpr double extruder_slack = 1e-4;  ///< less filament is rounding, mm
constexpr double max_blob = 0.02;        ///< excess or lack of filament that is allowed at one place, mm
constexpr double speed_slack = 1e-3;     ///< relative rounding of written speeds
constexpr double min_feed_rate = 0.01;   ///< a smaller feed rate is no speed, mm/min
constexpr double mm_per_inch = 25.4;
constexpr double own_lines_margin = 10;  ///< own lines may leave the bed by this to clean the nozzle, mm
constexpr std::size_t max_unchecked = 1000;
constexpr const char* axes = "XYZ";

/// Codes of M commands that pause, stop or leave the print, choose another file, or change the meaning of lengths of
/// filament.
constexpr std::array refused_codes{0,   1,   2,   23,  24,  25,  28,  30,  32,  108, 112, 125, 206, 218, 226,
                                   410, 428, 524, 600, 601, 602, 603, 605, 665, 666, 701, 702, 703, 997, 999};
/// Codes of G commands for levelling, probing, parking, cleaning and firmware retraction. The printer executes them and
/// returns.
constexpr std::array preparation_codes{10, 11, 12, 22, 23, 27, 29, 30, 31, 32, 33,
                                       34, 35, 36, 60, 61, 80, 81, 87, 88, 89};

template <class Codes>
bool contains(const Codes& codes, int code) {
  return std::find(codes.begin(), codes.end(), code) != codes.end();
}

std::string readable(double value) {
  std::array<char, 64> text{};
  std::snprintf(text.data(), text.size(), "%.6g", value);
  return text.data();
}

const GcodeWord* find(const std::vector<GcodeWord>& words, char letter) {
  const auto at = std::find_if(words.begin(), words.end(), [&](const GcodeWord& w) { return w.letter == letter; });
  return at == words.end() ? nullptr : &*at;
}

}  // namespace

void GcodeMachine::add_violation(ViolationKind kind, int line, std::string message) {
  ++report_.violation_count;
  if (report_.violations.size() < max_violations) report_.violations.push_back({kind, line, std::move(message)});
}

void GcodeMachine::execute(const GcodeLine& line, int line_number) {
  line_ = line_number;
  for (const std::string& fault : line.faults) add_violation(ViolationKind::malformed_word, line_, fault);
  if (!line.macro.empty()) return record_unchecked(line.macro);
  if (line.words.empty()) return;
  const GcodeWord& first = line.words.front();
  if (std::strchr("GMT", first.letter) == nullptr) {
    add_violation(ViolationKind::malformed_word, line_,
                  std::string("a line must begin with a command, not with ") + first.letter);
    return;
  }
  command(first, {line.words.begin() + 1, line.words.end()});
}

void GcodeMachine::command(const GcodeWord& command, const std::vector<GcodeWord>& parameters) {
  if (command.letter == 'T') return select_tool(command);
  const bool is_code = command.has_value && command.value >= 0;
  const int family = is_code ? static_cast<int>(command.value) : -1;
  const bool whole = is_code && command.value == family;
  // "M862.3" and "G29.1" are variants of M862 and G29.
  if (is_code && !whole && (command.letter == 'M' ? !contains(refused_codes, family) : family == 29))
    return record_unchecked(command.letter + readable(command.value));
  if (!whole) {
    add_violation(ViolationKind::unknown_command, line_,
                  command.letter + (command.has_value ? readable(command.value) : ""));
    return;
  }
  if (command.letter == 'G')
    general_command(family, parameters);
  else
    machine_command(family, parameters);
}

void GcodeMachine::select_tool(const GcodeWord& command) {
  // The first tool is already in use.
  if (command.has_value && command.value == 0) return;
  add_violation(ViolationKind::unknown_command, line_, "T" + (command.has_value ? readable(command.value) : ""));
}

void GcodeMachine::record_unchecked(std::string command) {
  ++report_.unchecked_count;
  if (report_.unchecked.size() < max_unchecked) report_.unchecked.push_back({line_, std::move(command)});
}

void GcodeMachine::set_unit(bool inches) { unit_ = inches ? mm_per_inch : 1; }

void GcodeMachine::set_factor(const std::vector<GcodeWord>& parameters, double& factor) {
  const GcodeWord* percent = find(parameters, 'S');
  if (percent == nullptr) return;
  if (percent->has_value && percent->value > 0)
    factor = percent->value / 100;
  else
    add_violation(ViolationKind::malformed_word, line_, "S is no percentage above 0");
}

void GcodeMachine::general_command(int code, const std::vector<GcodeWord>& parameters) {
  switch (code) {
    case 0:
    case 1:
      return move(parameters);
    case 4:
      return dwell(parameters);
    case 20:
    case 21:
      return set_unit(code == 20);
    case 28:
      return home(parameters);
    case 90:
    case 91:
      absolute_ = absolute_extrusion_ = code == 90;
      return;
    case 92:
      return set_position(parameters);
    default:
      if (contains(preparation_codes, code)) {
        moved_ = true;
        // G80 is mesh levelling without probing on some printers, and the end of a canned cycle on others.
        return code == 80 ? void() : record_unchecked("G" + std::to_string(code));
      }
      add_violation(ViolationKind::unknown_command, line_, "G" + std::to_string(code));
  }
}

void GcodeMachine::machine_command(int code, const std::vector<GcodeWord>& parameters) {
  switch (code) {
    case 18:
    case 84:
      // Without current in the motors, the carriage can be pushed anywhere.
      homed_ = {false, false, false};
      reported_home_ = false;
      return;
    case 82:
    case 83:
      absolute_extrusion_ = code == 82;
      return;
    case 104:
    case 109:
      return set_temperature(parameters, true, code == 109);
    case 140:
    case 190:
      return set_temperature(parameters, false, code == 190);
    case 106:
    case 107:
      return;
    case 200: {
      // With a diameter above 0, E is a volume.
      const GcodeWord* diameter = find(parameters, 'D');
      if (diameter != nullptr && diameter->value > 0) add_violation(ViolationKind::unknown_command, line_, "M200 D");
      return;
    }
    case 220:
      return set_factor(parameters, speed_factor_);
    case 221:
      return set_factor(parameters, flow_factor_);
    default:
      if (!contains(refused_codes, code)) return record_unchecked("M" + std::to_string(code));
      add_violation(ViolationKind::unknown_command, line_, "M" + std::to_string(code));
  }
}

void GcodeMachine::check_parameters(const std::vector<GcodeWord>& parameters, const char* allowed) {
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const GcodeWord& word = parameters[i];
    const std::string letter(1, word.letter);
    if (std::strchr(allowed, word.letter) == nullptr)
      add_violation(ViolationKind::malformed_word, line_, letter + " means nothing here");
    else if (!word.has_value)
      add_violation(ViolationKind::malformed_word, line_, letter + " has no number");
    else if (find(parameters, word.letter) != &word)
      add_violation(ViolationKind::malformed_word, line_, letter + " is there twice");
  }
}

void GcodeMachine::home(const std::vector<GcodeWord>& parameters) {
  const bool all = std::none_of(parameters.begin(), parameters.end(),
                                [](const GcodeWord& w) { return std::strchr(axes, w.letter) != nullptr; });
  for (int axis = 0; axis < 3; ++axis) {
    if (!all && find(parameters, axes[axis]) == nullptr) continue;
    position_[axis] = 0;
    offset_[axis] = 0;
    homed_[static_cast<std::size_t>(axis)] = true;
  }
  moved_ = true;
}

void GcodeMachine::set_position(const std::vector<GcodeWord>& parameters) {
  check_parameters(parameters, "XYZE");
  const bool all = parameters.empty();
  for (int axis = 0; axis < 3; ++axis) {
    const GcodeWord* word = find(parameters, axes[axis]);
    if (all || (word != nullptr && word->has_value)) offset_[axis] = position_[axis] - (all ? 0 : word->value * unit_);
  }
  const GcodeWord* word = find(parameters, 'E');
  if (all || (word != nullptr && word->has_value)) extruder_ = all ? 0 : word->value * unit_;
}

void GcodeMachine::set_temperature(const std::vector<GcodeWord>& parameters, bool nozzle, bool waits) {
  check_parameters(parameters, "SRT");
  const GcodeWord* word = find(parameters, 'S');
  if (word == nullptr && waits) word = find(parameters, 'R');
  if (word == nullptr || !word->has_value) {
    add_violation(ViolationKind::malformed_word, line_, "a temperature is missing");
    return;
  }
  if (!nozzle) return;
  temperature_ = waits ? word->value : std::min(temperature_, word->value);
  if (temperature_ >= limits_.cold) reported_cold_ = false;
}

void GcodeMachine::dwell(const std::vector<GcodeWord>& parameters) {
  check_parameters(parameters, "SP");
  const GcodeWord* seconds = find(parameters, 'S');
  const GcodeWord* milliseconds = find(parameters, 'P');
  if (seconds != nullptr) report_.minutes += std::max(0.0, seconds->value) / 60;
  if (milliseconds != nullptr) report_.minutes += std::max(0.0, milliseconds->value) / 60'000;
}

void GcodeMachine::move(const std::vector<GcodeWord>& parameters) {
  check_parameters(parameters, "XYZEF");
  if (const GcodeWord* f = find(parameters, 'F'); f != nullptr && f->has_value) {
    if (f->value >= min_feed_rate)
      speed_ = f->value * unit_;
    else
      add_violation(ViolationKind::no_speed, line_, "F" + readable(f->value) + " is no speed");
  }
  Eigen::Vector3d target = position_;
  for (int axis = 0; axis < 3; ++axis) {
    const GcodeWord* word = find(parameters, axes[axis]);
    if (word == nullptr || !word->has_value) continue;
    target[axis] = absolute_ ? word->value * unit_ + offset_[axis] : position_[axis] + word->value * unit_;
    if (!homed_[static_cast<std::size_t>(axis)] && !reported_home_) {
      reported_home_ = true;
      add_violation(ViolationKind::not_homed, line_, std::string("moves along ") + axes[axis] + " before G28");
    }
  }
  double pushed = 0;
  if (const GcodeWord* e = find(parameters, 'E'); e != nullptr && e->has_value) {
    const double written = absolute_extrusion_ ? e->value * unit_ - extruder_ : e->value * unit_;
    extruder_ += written;
    pushed = written * flow_factor_;
  }
  check_position(target);
  if (pushed < 0 && retracted() < extruder_slack) ++report_.retractions;
  const double length = (target - position_).norm();
  if (pushed > 0 && length > 0 && retracted() > max_blob)
    add_violation(ViolationKind::under_extrusion, line_,
                  "begins to extrude with " + readable(retracted()) + " mm retracted: the bead has a gap");
  filament_ += pushed;
  const double deposited = filament_ - max_filament_;
  max_filament_ = std::max(max_filament_, filament_);
  if (length > 0 || pushed != 0) check_speed(deposited > extruder_slack && length > 0);
  if (speed_ > 0) report_.minutes += (length > 0 ? length : std::abs(pushed)) / (speed_ * speed_factor_);
  if (deposited > 0) {
    report_.filament += deposited;
    extrude_to(target, deposited);
  } else if (length > 0) {
    travel_to(target);
  }
  position_ = target;
}

void GcodeMachine::check_position(const Eigen::Vector3d& target) {
  const auto at = [&] { return readable(target[0]) + ", " + readable(target[1]) + ", " + readable(target[2]) + " mm"; };
  if (target == position_) return;
  // The position at which the owner's lines left an axis is no fault of the lines that follow.
  const Eigen::Array<bool, 3, 1> changes = target.array() != position_.array();
  for (int axis = 0; axis < 3; ++axis)
    left_by_own_lines_[axis] = own_lines_ || (left_by_own_lines_[axis] && !changes[axis]);
  const Eigen::Array<bool, 3, 1> moves = changes || !left_by_own_lines_;
  const double allowance = own_lines_ ? own_lines_margin : position_slack;
  if (moves[1] && target[1] < -allowance) add_violation(ViolationKind::y_below_zero, line_, "goes to " + at());
  if (moves[2] && target[2] < -position_slack) add_violation(ViolationKind::z_below_zero, line_, "goes to " + at());
  const Eigen::Vector3d upper = limits_.bed + Eigen::Vector3d(allowance, allowance, position_slack);
  const bool inside = (!moves[0] || (target[0] >= -allowance && target[0] <= upper[0])) &&
                      (!moves[1] || target[1] <= upper[1]) && (!moves[2] || target[2] <= upper[2]);
  if (!inside)
    add_violation(ViolationKind::outside_bed, line_,
                  "goes to " + at() + "; the bed ends at " + readable(limits_.bed[0]) + ", " +
                      readable(limits_.bed[1]) + ", " + readable(limits_.bed[2]) + " mm");
}

void GcodeMachine::check_speed(bool extrudes) {
  if (speed_ <= 0) {
    if (!reported_speed_) add_violation(ViolationKind::no_speed, line_, "moves before any feed rate is given");
    reported_speed_ = true;
    return;
  }
  if (own_lines_) return;
  const double speed = speed_ * speed_factor_;
  const double limit = extrudes ? limits_.print_speed : limits_.travel_speed;
  if (speed > limit * (1 + speed_slack))
    add_violation(ViolationKind::too_fast, line_,
                  readable(speed) + " mm/min, at most " + readable(limit) +
                      (extrudes ? " while extruding" : " while travelling"));
}

void GcodeMachine::extrude_to(const Eigen::Vector3d& target, double deposited) {
  if (temperature_ < limits_.cold && !reported_cold_) {
    reported_cold_ = true;
    add_violation(ViolationKind::cold_extrusion, line_,
                  "the nozzle has reached " + readable(temperature_) + " degrees for certain, at least " +
                      readable(limits_.cold) + " are needed");
  }
  if (target == position_) {
    if (deposited > max_blob && !own_lines_)
      add_violation(ViolationKind::over_extrusion, line_,
                    readable(deposited) + " mm of filament while the nozzle rests");
    return;
  }
  if (moved_) {
    ++run_;
    ++report_.travels;
  }
  moved_ = false;
  travelled_ = 0;
  reported_travel_ = false;
  report_.extruded_length += (target - position_).norm();
  if (own_lines_) return;
  beads_.push_back({line_, run_, position_, target, deposited});
}

void GcodeMachine::travel_to(const Eigen::Vector3d& target) {
  moved_ = true;
  report_.travel_length += (target - position_).norm();
  travelled_ += (target - position_).head<2>().norm();
  // Before the first bead, oozing filament does no harm.
  if (beads_.empty() || reported_travel_ || travelled_ <= limits_.free_travel) return;
  // The flow factor applies to retractions too.
  if (retracted() >= limits_.retraction * std::min(1.0, flow_factor_) - extruder_slack) return;
  reported_travel_ = true;
  add_violation(ViolationKind::travel_without_retraction, line_,
                readable(travelled_) + " mm with " + readable(retracted()) + " mm retracted, at least " +
                    readable(limits_.retraction) + " are needed");
}

}  // namespace supple::weave
