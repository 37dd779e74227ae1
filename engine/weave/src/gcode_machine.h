#pragma once

#include <Eigen/Core>
#include <array>
#include <string>
#include <vector>

#include "gcode_channels.h"
#include "gcode_words.h"
#include "supple/weave/gcode_check.h"

namespace supple::weave {

/// A printer that is fed line by line: follows position, extruder and temperature, and notes what breaks the limits.
class GcodeMachine {
 public:
  explicit GcodeMachine(const GcodeLimits& limits) : limits_(limits) {}

  /// Obeys a line of this number.
  void obey(const GcodeLine& line, int number);

  /// Whether the following lines are the owner's: their lines may leave the bed a little, and what they deposit (a
  /// line that fills the nozzle) is no bead of the print.
  void set_own_lines(bool own) { own_lines_ = own; }

  void violate(ViolationKind kind, int line, std::string message);

  const std::vector<Bead>& beads() const { return beads_; }
  /// All but heights, boxes and channels, which come from the beads.
  GcodeReport& report() { return report_; }

 private:
  void command(const GcodeWord& command, const std::vector<GcodeWord>& parameters);
  void general_command(int code, const std::vector<GcodeWord>& parameters);
  void machine_command(int code, const std::vector<GcodeWord>& parameters);
  void move(const std::vector<GcodeWord>& parameters);
  void home(const std::vector<GcodeWord>& parameters);
  void set_position(const std::vector<GcodeWord>& parameters);
  void set_temperature(const std::vector<GcodeWord>& parameters, bool nozzle, bool waits);
  void tool(const GcodeWord& command);
  void set_unit(bool inches);
  void set_factor(const std::vector<GcodeWord>& parameters, double& factor);
  /// Notes a command that is passed on to the printer, whose effect is not followed.
  void pass(std::string command);
  void dwell(const std::vector<GcodeWord>& parameters);
  void check_parameters(const std::vector<GcodeWord>& parameters, const char* allowed);
  void check_position(const Eigen::Vector3d& target);
  void extrude_to(const Eigen::Vector3d& target, double deposited);
  void travel_to(const Eigen::Vector3d& target);
  void check_speed(bool extrudes);
  double retracted() const { return most_filament_ - filament_; }

  GcodeLimits limits_;
  GcodeReport report_;
  std::vector<Bead> beads_;
  int line_ = 0;

  Eigen::Vector3d position_{0, 0, 0};  ///< mm, of the machine
  Eigen::Vector3d offset_{0, 0, 0};    ///< of the machine's coordinates over those of the G-code
  std::array<bool, 3> homed_{false, false, false};
  bool own_lines_ = false;
  Eigen::Array<bool, 3, 1> left_by_owner_{false, false, false};  ///< axes that no later line has moved
  double unit_ = 1;                                              ///< mm of a length in the G-code: 25.4 after G20
  double flow_factor_ = 1;                                       ///< of M221
  double speed_factor_ = 1;                                      ///< of M220
  bool absolute_ = true;
  bool absolute_extrusion_ = true;
  double extruder_ = 0;       ///< in the G-code's coordinates
  double filament_ = 0;       ///< pushed so far, retractions subtracted
  double most_filament_ = 0;  ///< the most it has been: what is beyond is deposited
  double speed_ = 0;          ///< mm/min; 0 while unknown
  double temperature_ = 0;    ///< that the nozzle has reached for certain
  int run_ = 0;
  double travelled_ = 0;  ///< in the plane since the last bead, mm
  bool moved_ = true;     ///< since the last bead
  bool reported_travel_ = false;
  bool reported_cold_ = false;
  bool reported_home_ = false;
  bool reported_speed_ = false;
};

}  // namespace supple::weave
