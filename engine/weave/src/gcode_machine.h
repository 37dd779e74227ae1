#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "gcode_channels.h"
#include "gcode_words.h"
#include "supple/weave/gcode_check.h"

namespace supple::weave {

/// A simulated printer that executes G-code line by line. It tracks position, extruder and temperature, and reports
/// violations of the limits.
class GcodeMachine {
 public:
  explicit GcodeMachine(const GcodeLimits& limits) : limits_(limits) {}

  /// Executes the line with this number.
  void execute(const GcodeLine& line, int number);

  /// Sets whether the following lines are the owner's. They may leave the bed a little, and what they deposit (a line
  /// that fills the nozzle) is no bead of the print.
  void set_own_lines(bool own) { own_lines_ = own; }

  void add_violation(ViolationKind kind, int line, std::string message);

  const std::vector<Bead>& beads() const { return beads_; }
  /// The report without heights, boxes and channels, which are computed from the beads.
  GcodeReport& report() { return report_; }

 private:
  void command(const GcodeWord& command, const std::vector<GcodeWord>& parameters);
  void general_command(int code, const std::vector<GcodeWord>& parameters);
  void machine_command(int code, const std::vector<GcodeWord>& parameters);
  void move(const std::vector<GcodeWord>& parameters);
  void home(const std::vector<GcodeWord>& parameters);
  void set_position(const std::vector<GcodeWord>& parameters);
  void set_temperature(const std::vector<GcodeWord>& parameters, bool nozzle, bool waits);
  void select_tool(const GcodeWord& command);
  void set_unit(bool inches);
  void set_factor(const std::vector<GcodeWord>& parameters, double& factor);
  /// Records a command that the printer gets as it is and whose effect is not tracked.
  void record_unchecked(std::string command);
  void dwell(const std::vector<GcodeWord>& parameters);
  void check_parameters(const std::vector<GcodeWord>& parameters, const char* allowed);
  void check_position(const Eigen::Vector3d& target);
  void extrude_to(const Eigen::Vector3d& target, double deposited);
  void travel_to(const Eigen::Vector3d& target);
  void check_speed(bool extrudes);
  double retracted() const { return max_filament_ - filament_; }

  GcodeLimits limits_;
  GcodeReport report_;
  std::vector<Bead> beads_;
  int line_ = 0;

  Eigen::Vector3d position_{0, 0, 0};  ///< of the machine, mm
  Eigen::Vector3d offset_{0, 0, 0};    ///< machine coordinates minus coordinates of the G-code, mm
  std::array<bool, 3> homed_{false, false, false};
  bool own_lines_ = false;
  Eigen::Array<bool, 3, 1> left_by_own_lines_{false, false, false};  ///< axes still where own lines left them
  double unit_ = 1;          ///< length of one unit of the G-code, mm; 25.4 after G20
  double flow_factor_ = 1;   ///< set by M221
  double speed_factor_ = 1;  ///< set by M220
  bool absolute_ = true;
  bool absolute_extrusion_ = true;
  double extruder_ = 0;      ///< position in the G-code's coordinates, mm
  double filament_ = 0;      ///< filament pushed so far minus retractions, mm
  double max_filament_ = 0;  ///< maximum of `filament_` so far, mm; filament beyond it is deposited
  double speed_ = 0;         ///< mm/min; 0 if unknown
  double temperature_ = 0;   ///< degrees Celsius that the nozzle has certainly reached
  int run_ = 0;              ///< number of the current run of beads
  double travelled_ = 0;     ///< distance in the plane since the last bead, mm
  bool moved_ = true;        ///< whether the nozzle has moved since the last bead
  bool reported_travel_ = false;
  bool reported_cold_ = false;
  bool reported_home_ = false;
  bool reported_speed_ = false;
};

}  // namespace supple::weave
