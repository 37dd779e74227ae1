#pragma once

#include <Eigen/Core>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/execution.h"
#include "supple/weave/printer_profile.h"
#include "supple/weave/weave.h"

namespace supple::weave {

/// The limits within which G-code must stay.
struct GcodeLimits {
  Eigen::Vector3d bed{250, 210, 210};  ///< positions lie within (0, 0, 0) and this, mm
  double filament_diameter = 1.75;     ///< mm
  double bead_area = 0.19635;          ///< area of the thickest bead, mm^2
  double min_bead_area = 0.19635;      ///< area of the thinnest bead that lies on the bed, mm^2
  double min_lifted_area = 0.098;      ///< area of the thinnest lifted strand or channel, mm^2
  double tolerance = 0.1;              ///< relative deviation of the area of a bead that is allowed
  double cold = 170;                   ///< lowest temperature at which filament may be extruded, degrees Celsius
  double print_speed = 1500;           ///< highest speed while extruding, mm/min
  double travel_speed = 12000;         ///< highest speed otherwise, mm/min
  double retraction = 0.4;             ///< filament to be retracted before a travel, mm
  double free_travel = 1;              ///< longest travel in the plane that needs no retraction, mm
  double strand_width = 0.5;           ///< mm; channels begin and end within this of a lower strand's centre line
};
/// The limits of a profile (its bed, speeds and temperatures) and of a layout (the beads of its strands).
GcodeLimits limits_of(const PrinterProfile& profile, const Weave& weave);

enum class ViolationKind {
  malformed_word,   ///< a letter without a number, a number out of range, other bytes
  unknown_command,  ///< a command that the checker does not understand
  not_homed,        ///< a move before G28
  outside_bed,      ///< beyond the bed, left of it or above the printer's height
  y_below_zero,
  z_below_zero,
  cold_extrusion,  ///< extrusion before the nozzle is known to have reached GcodeLimits::cold
  over_extrusion,
  under_extrusion,
  travel_without_retraction,
  too_fast,
  no_speed,  ///< a move before any feed rate, or a feed rate that is not positive
};
/// The name of a kind, as it is written above.
std::string_view to_string(ViolationKind kind);

struct Violation {
  ViolationKind kind = ViolationKind::malformed_word;
  int line = 0;           ///< counted from 1
  std::string message{};  ///< printable ASCII
};

/// A command whose effect is not followed: a macro, or a command that prepares a print. The printer gets it as it is.
struct UncheckedCommand {
  int line = 0;           ///< counted from 1
  std::string command{};  ///< its name, printable ASCII: "M900", "START_PRINT"
};

/// A channel that was recognized.
struct FoundChannel {
  int line = 0;                    ///< line where the channel begins
  Eigen::Vector3d start{0, 0, 0};  ///< feet and apex, mm
  Eigen::Vector3d apex{0, 0, 0};
  Eigen::Vector3d end{0, 0, 0};
  double length = 0;  ///< mm
};

/// What G-code prints, and what is wrong with it.
struct GcodeReport {
  int lines = 0;
  double extruded_length = 0;  ///< length of moves that deposit filament, mm
  double filament = 0;         ///< deposited filament, mm; filament that only undoes a retraction does not count
  double travel_length = 0;    ///< mm
  int travels = 0;             ///< sequences of moves without extrusion that lead to a bead
  int retractions = 0;
  std::vector<double> heights{};    ///< heights at which something is printed level, ascending; the first 1000
  double minutes = 0;               ///< lengths divided by speeds, and dwells
  Eigen::Vector3d lowest{0, 0, 0};  ///< lowest corner of the box of everything that is printed, mm
  Eigen::Vector3d highest{0, 0, 0};
  double channel_length = 0;  ///< length of all channels, mm
  std::vector<FoundChannel> channels{};
  std::vector<Violation> violations{};        ///< sorted by line; the first 1000
  int violation_count = 0;                    ///< number of all violations
  std::vector<UncheckedCommand> unchecked{};  ///< sorted by line; the first 1000
  int unchecked_count = 0;                    ///< number of all of them
};

/// The comments around the lines that the owner of a printer adds at the beginning. What these lines deposit is no bead
/// of the print. It may have any thickness and speed, and may lie up to 10 mm beside the bed.
inline constexpr std::string_view own_lines_begin = "; own start lines";
inline constexpr std::string_view own_lines_end = "; end of the own start lines";

/// Reads any bytes as G-code (RepRap flavour: G0, G1, G4, G20, G21, G28, G80, G90, G91, G92, M18, M82 - M84, M104,
/// M106, M107, M109, M140, M190, M200, M220, M221, T0; comments, line numbers, checksums) and reports what a printer
/// would do. It is an independent check: except for the two comments above it shares no code with the writer of G-code.
/// Every fault is a violation. Macros, other M commands, and G commands that prepare a print (levelling, probing,
/// firmware retraction) are only listed as `unchecked`. Other G commands, other tools, and M commands that pause, end
/// or misplace the print (M0, M112, M206, M600, ...) are violations.
///
/// A channel is a sequence of beads that rises from a lower strand, which was printed earlier, falls to such a strand
/// again, and ends there. O(lines), plus for each channel the number of strands nearby. If all beads lie at one place,
/// the cost is the square of their number. Reports progress. Throws only if a stop is requested (see CancellationToken)
/// or if memory is lacking.
GcodeReport check_gcode(std::string_view text, const GcodeLimits& limits = {}, const Execution& execution = {});

}  // namespace supple::weave
