#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "supple/weave/printer_profile.h"
#include "supple/weave/weave.h"

namespace supple::weave {

/// How far an open strand is printed on, straight, beyond its ends, in mm. There it sticks to the bed, and this part is
/// cut off later.
struct Overrun {
  double start = 0;
  double end = 0;
};

/// A rectangle of strands around the layout, including the ends of strands but not their overruns.
struct Frame {
  double margin = 0;   ///< between the layout's box and the frame, mm
  double lead_in = 0;  ///< the first side begins this far before its corner, mm
};

/// A solid bar by which a test machine can grip a printed sheet. It consists of passes parallel to `from` - `to`. The
/// first pass runs there, and each further pass runs a strand's width to the right of the previous one.
struct Grip {
  Eigen::Vector2d from{0, 0};  ///< mm, in the layout's coordinates
  Eigen::Vector2d to{0, 0};
  double width = 10;  ///< mm
};

struct ToolpathOptions {
  /// Position of the layout's (0, 0) on the bed, mm. The default centres everything that is printed on the bed.
  std::optional<Eigen::Vector2d> origin{};
  /// The strands' numbers in printing order. Each strand must come after those across which it slides. In the default
  /// order, strands that slide nowhere come first and the others follow, each group in the layout's order as far as
  /// possible.
  std::vector<int> order{};
  Overrun overrun{};                  ///< overrun of all open strands
  std::map<int, Overrun> overruns{};  ///< overruns of single strands, by their numbers; they replace `overrun`
  double loop_overlap = 0;            ///< length by which closed strands are printed beyond their beginning, mm
  std::optional<Frame> frame{};
  std::vector<Grip> grips{};
  double chord_error = 0.005;  ///< maximum distance of printed polylines from curved strands, mm
};

enum class MoveKind {
  priming,  ///< beside the print, to fill the nozzle
  strand,   ///< on the bed
  lifted,   ///< the part of a strand that passes over others
  channel,  ///< over a sliding strand
  support,  ///< frames and grips
  travel,   ///< without extrusion, retracted
};
std::string_view to_string(MoveKind kind);

struct Move {
  MoveKind kind = MoveKind::strand;
  std::vector<Eigen::Vector3d> points{};  ///< nozzle positions, beginning where the previous move ended; mm
  double area = 0;                        ///< area of the bead, mm^2; 0 for travels
  double speed = 0;                       ///< mm/min
  int strand = -1;                        ///< for a channel the strand it is fused to; -1 for supports and travels
  int crossing = -1;                      ///< set for channels only
};

/// Totals of a toolpath. Lengths are in mm.
struct ToolpathStatistics {
  double strand_length = 0;  ///< length of strands on the bed
  double lifted_length = 0;  ///< length of their lifted parts, including ramps
  double channel_length = 0;
  double support_length = 0;
  double priming_length = 0;
  double travel_length = 0;
  double extruded_length = 0;  ///< length of everything except travels
  double filament = 0;         ///< mm
  int travels = 0;
  int channels = 0;
  std::vector<double> heights{};    ///< heights at which something is printed level, ascending
  double minutes = 0;               ///< lengths divided by speeds, without accelerations
  Eigen::Vector3d lowest{0, 0, 0};  ///< lowest corner of the box of the print, without the priming line
  Eigen::Vector3d highest{0, 0, 0};
};

struct Toolpath {
  std::vector<Move> moves{};  ///< in printing order
  ToolpathStatistics statistics{};
};

/// Computes how a finite layout is printed: first a priming line, then supports, then strands that slide nowhere, then
/// strands that pass over others, and last channels.
///
/// Fused strands are printed through each other in one layer, so that they weld. At a sliding crossing the strand that
/// slides is the upper one. It rises just before the crossing and comes down after it. A channel is printed over it and
/// is fused to the strand below. If there are several strands below, the channel stands on the one that the sliding
/// strand crosses at the angle closest to 90 degrees. Strands that meet without a crossing in the layout are printed
/// through each other.
///
/// Throws "weave.invalid_layout" and "weave.invalid_option" for faulty input. Throws "weave.not_printable", which names
/// the crossing or strand and the limit, if the layout is periodic or does not fit on the bed, if strands would have to
/// be below each other, or if crossings are too close to the ends or to each other for lifts and channels. O(crossings
/// log crossings + points).
Toolpath toolpath(const Weave& weave, const PrinterProfile& profile = {}, const ToolpathOptions& options = {},
                  const Execution& execution = {});

/// An SVG picture of a toolpath from above, coloured by kind of move. Millimetres are user units, y points up.
std::string to_svg(const Toolpath& toolpath);

}  // namespace supple::weave
