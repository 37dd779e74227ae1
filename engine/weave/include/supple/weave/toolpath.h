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

/// How far an open strand is printed on, straight, beyond its ends: it sticks to the bed there and is cut off; mm.
struct Overrun {
  double start = 0;
  double end = 0;
};

/// A rectangle of strands around the layout, ends of strands included and overruns not.
struct Frame {
  double margin = 0;   ///< between the layout's box and the frame, mm
  double lead_in = 0;  ///< the first side begins this far before its corner, mm
};

/// A solid bar by which a printed sheet is held: passes parallel to `from` - `to`, the first one there, each further
/// one a strand's width to the right of it.
struct Grip {
  Eigen::Vector2d from{0, 0};  ///< mm, in the layout's coordinates
  Eigen::Vector2d to{0, 0};
  double width = 10;  ///< mm
};

struct ToolpathOptions {
  /// Where the layout's (0, 0) comes to lie on the bed, mm; else all that is printed is centred on the bed.
  std::optional<Eigen::Vector2d> origin{};
  /// The strands' numbers in printing order; each must come after those that it slides across. Else strands that slide
  /// nowhere first, then the others, each group in the layout's order as far as that goes.
  std::vector<int> order{};
  Overrun overrun{};                  ///< of open strands
  std::map<int, Overrun> overruns{};  ///< of single strands instead, by their numbers
  double loop_overlap = 0;            ///< closed strands are printed on over their beginning by this, mm
  std::optional<Frame> frame{};
  std::vector<Grip> grips{};
  double chord_error = 0.005;  ///< printed polylines leave curved strands by less, mm
};

enum class MoveKind {
  strand,   ///< on the bed
  lifted,   ///< the part of a strand that passes over others
  channel,  ///< over a sliding strand
  support,  ///< frames and grips
  travel,   ///< without extrusion, retracted
};
std::string_view to_string(MoveKind kind);

struct Move {
  MoveKind kind = MoveKind::strand;
  std::vector<Eigen::Vector3d> points{};  ///< nozzle positions, the first one where the move before ended; mm
  double area = 0;                        ///< of the bead, mm^2; 0 of travels
  double speed = 0;                       ///< mm/min
  int strand = -1;                        ///< of a channel the one that it is fused to; -1 of supports and travels
  int crossing = -1;                      ///< of channels
};

/// What a toolpath amounts to. Lengths in mm.
struct ToolpathStatistics {
  double strand_length = 0;  ///< of strands on the bed
  double lifted_length = 0;  ///< of their lifted parts, ramps included
  double channel_length = 0;
  double support_length = 0;
  double travel_length = 0;
  double extruded_length = 0;  ///< all but travels
  double filament = 0;         ///< mm
  int travels = 0;
  int channels = 0;
  std::vector<double> heights{};    ///< at which something is printed level, ascending
  double minutes = 0;               ///< lengths over speeds: without accelerations
  Eigen::Vector3d lowest{0, 0, 0};  ///< corner of the box of all that is printed
  Eigen::Vector3d highest{0, 0, 0};
};

struct Toolpath {
  std::vector<Move> moves{};  ///< in printing order
  ToolpathStatistics statistics{};
};

/// How to print a finite layout: supports, strands that slide nowhere, strands that pass over others, channels.
///
/// Fused strands are printed through each other in one layer and weld. Of a sliding crossing the strand that slides is
/// the upper one: it rises just before, comes down after, and a channel that is fused to the other strand is printed
/// over it. Of several strands below, the channel stands on that which the sliding one crosses most squarely.
/// Strands that meet without a crossing in the layout are printed through each other.
///
/// Throws "weave.invalid_layout" and "weave.invalid_option" of faulty input, and "weave.not_printable", naming the
/// crossing or strand and the limit, where the layout is periodic, does not fit on the bed, strands would have to be
/// below each other, or crossings are too close to the ends or to each other for lifts and channels.
/// O(crossings log crossings + points).
Toolpath toolpath(const Weave& weave, const PrinterProfile& profile = {}, const ToolpathOptions& options = {},
                  const Execution& execution = {});

/// An SVG picture of a toolpath from above, coloured by kind of move. Millimetres are user units, y points up.
std::string to_svg(const Toolpath& toolpath);

}  // namespace supple::weave
