#include "supple/weave/toolpath.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>

#include "channel_path.h"
#include "print_order.h"
#include "strand_path.h"
#include "supple/base/faults.h"
#include "supple/base/number_text.h"
#include "supple/weave/weave_error.h"
#include "toolpath_statistics.h"

namespace supple::weave {
namespace {

constexpr double same_position_tolerance = 1e-6;  ///< distance below which two positions are one, mm
constexpr double priming_margin = 5;  ///< distance of the priming line from the bed's edges and from the print, mm
constexpr double max_option = 1000;   ///< limit of overruns, margins and grips, mm
constexpr std::size_t max_grips = 100;
constexpr int max_overlap = 10;        ///< limit of the overlap of a loop, in lengths of the loop
constexpr int max_points = 2'000'000;  ///< limit of the points of a toolpath

/// Number of passes along a grip that fill it.
double passes_of(const Grip& grip, const PrinterProfile& profile) {
  return std::max(1.0, std::floor(grip.width / profile.strand_width + 1e-6));
}

void check(const ToolpathOptions& options, const Weave& weave, const PrinterProfile& profile) {
  Faults faults;
  const auto length = [&](double value, const std::string& where, double minimum = 0) {
    faults.require(value >= minimum && value <= max_option, where,
                   "must lie within [" + mm(minimum) + ", " + mm(max_option) + "], got " + number_text(value));
  };
  const auto overrun = [&](const Overrun& o, const std::string& where) {
    length(o.start, where + "/start");
    length(o.end, where + "/end");
  };
  faults.require(!options.origin || options.origin->allFinite(), "origin", "must be finite, in mm");
  overrun(options.overrun, "overrun");
  for (const auto& [strand, o] : options.overruns) {
    const std::string where = "overruns/" + std::to_string(strand);
    faults.require(strand >= 0 && strand < static_cast<int>(weave.strands.size()), where, "names no strand");
    overrun(o, where);
  }
  length(options.loop_overlap, "loop_overlap");
  if (options.frame) {
    length(options.frame->margin, "frame/margin");
    length(options.frame->lead_in, "frame/lead_in");
  }
  faults.require(options.grips.size() <= max_grips, "grips", "must be at most " + std::to_string(max_grips));
  double passes = 0;
  for (std::size_t g = 0; g < options.grips.size(); ++g) {
    const Grip& grip = options.grips[g];
    const std::string where = "grips/" + std::to_string(g);
    const bool finite = grip.from.allFinite() && grip.to.allFinite();
    faults.require(finite, where, "must be finite, in mm");
    if (finite) length((grip.to - grip.from).norm(), where, 0.1);
    length(grip.width, where + "/width");
    passes += passes_of(grip, profile);
  }
  faults.require(
      !(2 * passes > max_points), "grips",
      "must be printed in fewer passes of the profile's strand_width together than " + std::to_string(max_points / 2));
  length(options.chord_error, "chord_error", 1e-4);
  faults.throw_if_any<InvalidOption>("weave.invalid_option");
}

/// Collects extruded moves and inserts travels between them. The moves are not yet placed on the bed.
class ToolpathBuilder {
 public:
  explicit ToolpathBuilder(const PrinterProfile& profile) : profile_(profile) {}

  void extrude(Move move) {
    if (moves_.empty() || (moves_.back().points.back() - move.points.front()).norm() > same_position_tolerance)
      travel(move.points.front());
    for (const Eigen::Vector3d& p : move.points) top_ = std::max(top_, p[2]);
    moves_.push_back(std::move(move));
  }

  Eigen::Vector2d position() const {
    return moves_.empty() ? Eigen::Vector2d(0, 0) : Eigen::Vector2d(moves_.back().points.back().head<2>());
  }
  bool empty() const { return moves_.empty(); }
  std::vector<Move> take() { return std::move(moves_); }

 private:
  /// Moves up above all that is printed, across, and down. The start of the first travel is unknown until the print is
  /// placed.
  void travel(const Eigen::Vector3d& to) {
    const Eigen::Vector3d from = moves_.empty() ? to : moves_.back().points.back();
    const double height = std::max({top_, from[2], to[2]}) + profile_.travel_clearance;
    Move move{
        MoveKind::travel, {from, {from[0], from[1], height}, {to[0], to[1], height}, to}, 0, profile_.travel_speed};
    moves_.push_back(std::move(move));
  }

  const PrinterProfile& profile_;
  double top_ = 0;
  std::vector<Move> moves_;
};

/// Bounding box of all strands between their ends.
Eigen::AlignedBox2d layout_box(const std::vector<StrandPath>& paths, const std::vector<Overrun>& overruns,
                               const Weave& weave) {
  Eigen::AlignedBox2d box;
  for (std::size_t s = 0; s < paths.size(); ++s) {
    const StrandCurve& curve = weave.strands[s].curve;
    if (curve.ends() == Ends::open && overruns[s].start + overruns[s].end > 0 && curve.straight()) {
      box.extend(curve.at(0).position);
      box.extend(curve.at(curve.length()).position);
    } else {
      for (const Eigen::Vector3d& p : paths[s].points) box.extend(Eigen::Vector2d(p.head<2>()));
    }
  }
  return box;
}

void add_supports(const Eigen::AlignedBox2d& box, const PrinterProfile& profile, const ToolpathOptions& options,
                  ToolpathBuilder& builder) {
  const double z = profile.strand_height;
  const auto line = [&](const std::vector<Eigen::Vector2d>& points) {
    Move move{MoveKind::support, {}, bead_area(profile, profile.strand_width / 2), profile.strand_speed};
    for (const Eigen::Vector2d& p : points) move.points.emplace_back(p[0], p[1], z);
    builder.extrude(std::move(move));
  };
  if (options.frame) {
    const Eigen::Vector2d margin = Eigen::Vector2d::Constant(options.frame->margin);
    const Eigen::Vector2d a = box.min() - margin;
    const Eigen::Vector2d b = box.max() + margin;
    line({{a[0] - options.frame->lead_in, a[1]}, {b[0], a[1]}, {b[0], b[1]}, {a[0], b[1]}, {a[0], a[1]}});
  }
  for (const Grip& grip : options.grips) {
    const Eigen::Vector2d along = (grip.to - grip.from).normalized();
    const Eigen::Vector2d aside = profile.strand_width * Eigen::Vector2d(along[1], -along[0]);
    const auto passes = static_cast<int>(passes_of(grip, profile));
    std::vector<Eigen::Vector2d> points;
    for (int i = 0; i < passes; ++i) {
      points.emplace_back((i % 2 == 0 ? grip.from : grip.to) + i * aside);
      points.emplace_back((i % 2 == 0 ? grip.to : grip.from) + i * aside);
    }
    line(points);
  }
}

/// Adds a strand, beginning at the end that is nearer to the nozzle, as moves of consecutive segments that are either
/// all lifted or all flat.
void add_strand(int number, const Strand& strand, StrandPath path, const PrinterProfile& profile,
                ToolpathBuilder& builder) {
  if (strand.curve.ends() == Ends::open && !builder.empty()) {
    const Eigen::Vector2d at = builder.position();
    if ((path.points.back().head<2>() - at).norm() < (path.points.front().head<2>() - at).norm()) {
      std::reverse(path.points.begin(), path.points.end());
      std::reverse(path.lifted.begin(), path.lifted.end());
    }
  }
  const double area = bead_area(profile, strand.radius);
  for (std::size_t i = 0; i < path.lifted.size();) {
    const bool lifted = path.lifted[i] != 0;
    Move move{lifted ? MoveKind::lifted : MoveKind::strand,
              {path.points[i]},
              lifted ? area * profile.lifted_flow : area,
              lifted ? profile.lifted_speed : profile.strand_speed,
              number};
    for (; i < path.lifted.size() && (path.lifted[i] != 0) == lifted; ++i) move.points.push_back(path.points[i + 1]);
    builder.extrude(std::move(move));
  }
}

Eigen::AlignedBox2d printed_box(const std::vector<Move>& moves) {
  Eigen::AlignedBox2d box;
  for (const Move& move : moves)
    if (move.kind != MoveKind::travel)
      for (const Eigen::Vector3d& p : move.points) box.extend(Eigen::Vector2d(p.head<2>()));
  return box;
}

/// A line along the first edge of the bed, of front, rear, left and right, that is clear of the print. Empty if there
/// is none.
std::vector<Eigen::Vector2d> priming_line(const Eigen::AlignedBox2d& print, const PrinterProfile& profile) {
  const Eigen::Vector2d bed = profile.bed.head<2>();
  const Eigen::Vector2d length = (bed.array() - 2 * priming_margin).min(profile.priming_length);
  const Eigen::Vector2d low = Eigen::Vector2d::Constant(priming_margin);
  const Eigen::Vector2d high = bed - low;
  const auto along_x = [&](double y) { return std::vector{Eigen::Vector2d(low[0], y), {low[0] + length[0], y}}; };
  const auto along_y = [&](double x) { return std::vector{Eigen::Vector2d(x, low[1]), {x, low[1] + length[1]}}; };
  for (auto& line : {along_x(low[1]), along_x(high[1]), along_y(low[0]), along_y(high[0])}) {
    Eigen::AlignedBox2d line_box(line[0]);
    line_box.extend(line[1]);
    if ((line[1] - line[0]).norm() > 0 && line_box.squaredExteriorDistance(print) >= priming_margin * priming_margin)
      return line;
  }
  return {};
}

/// Inserts the priming line before the placed moves. The nozzle comes from above (0, 0), primes and travels to the
/// print.
void add_priming(std::vector<Move>& moves, const PrinterProfile& profile) {
  if (profile.priming_length == 0) return;
  const auto line = priming_line(printed_box(moves), profile);
  if (line.empty()) return;
  const double z = profile.strand_height;
  const double height = z + profile.travel_clearance;
  const auto at = [](const Eigen::Vector2d& p, double over_bed) { return Eigen::Vector3d(p[0], p[1], over_bed); };
  const Move arrival{
      MoveKind::travel, {Eigen::Vector3d(0, 0, height), at(line[0], height), at(line[0], z)}, 0, profile.travel_speed};
  const Move priming{MoveKind::priming,
                     {at(line[0], z), at(line[1], z)},
                     bead_area(profile, profile.strand_width / 2),
                     profile.strand_speed};
  std::vector<Eigen::Vector3d>& first = moves.front().points;
  first.front() = at(line[1], first[1][2]);
  first.insert(first.begin(), at(line[1], z));
  moves.insert(moves.begin(), {arrival, priming});
}

/// Moves the print to its place on the bed. The nozzle comes from above (0, 0).
void place(std::vector<Move>& moves, const ToolpathOptions& options, const PrinterProfile& profile) {
  const Eigen::Vector2d shift =
      options.origin ? *options.origin : Eigen::Vector2d(profile.bed.head<2>() / 2 - printed_box(moves).center());
  for (Move& move : moves)
    for (Eigen::Vector3d& p : move.points) p.head<2>() += shift;
  std::vector<Eigen::Vector3d>& first = moves.front().points;
  first[0] = Eigen::Vector3d(0, 0, first[1][2]);
  first[1] = first[0];
  first.erase(first.begin());
}

void check_bed(const Toolpath& path, const PrinterProfile& profile) {
  PrintFaults faults;
  Eigen::AlignedBox3d box;
  for (const Move& move : path.moves)
    for (const Eigen::Vector3d& p : move.points) box.extend(p);
  constexpr std::array axes{"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    const double low = axis < 2 ? path.statistics.lowest[axis] : 0;
    const double high = axis < 2 ? path.statistics.highest[axis] : box.max()[axis];
    if (low < 0 || high > profile.bed[axis])
      faults.add("bed", std::string("reaches from 0 to ") + mm(profile.bed[axis]) + " in " +
                            axes[static_cast<std::size_t>(axis)] + ", and the nozzle would go from " + mm(low) +
                            " to " + mm(high));
  }
  faults.throw_if_any();
}

}  // namespace

std::string_view to_string(MoveKind kind) {
  switch (kind) {
    case MoveKind::priming:
      return "priming";
    case MoveKind::strand:
      return "strand";
    case MoveKind::lifted:
      return "lifted";
    case MoveKind::channel:
      return "channel";
    case MoveKind::support:
      return "support";
    case MoveKind::travel:
      break;
  }
  return "travel";
}

Toolpath toolpath(const Weave& weave, const PrinterProfile& profile, const ToolpathOptions& options,
                  const Execution& execution) {
  validate(weave, execution);
  validate(profile);
  check(options, weave, profile);
  PrintFaults faults;
  if (weave.lattice) faults.add("lattice", "makes the layout periodic; only finite ones can be printed");
  double length = 0;
  for (std::size_t s = 0; s < weave.strands.size(); ++s) {
    if (weave.strands[s].curve.ends() == Ends::periodic)
      faults.add(strand_name(static_cast<int>(s)), "goes on for ever; only open and closed strands can be printed");
    const double loop_length = weave.strands[s].curve.length();
    if (weave.strands[s].curve.ends() == Ends::closed && options.loop_overlap > max_overlap * loop_length)
      faults.add(strand_name(static_cast<int>(s)),
                 "is a loop of " + mm(loop_length) + ", over which " + mm(options.loop_overlap) +
                     " of loop_overlap would go round more than " + std::to_string(max_overlap) + " times");
    length += loop_length;
  }
  const double min_step = std::sqrt(options.chord_error);
  if (length / min_step > max_points)
    faults.add("strands", "are " + mm(length) + " long together; at most " + mm(max_points * min_step) +
                              " can be printed at this chord_error");
  faults.throw_if_any();

  const std::vector<SlidingCrossing> crossings = sliding_crossings(weave, faults);
  faults.throw_if_any();
  const std::vector<int> order = print_order(static_cast<int>(weave.strands.size()), crossings, options.order);
  std::vector<Overrun> overruns(weave.strands.size(), options.overrun);
  for (const auto& [strand, overrun] : options.overruns) overruns[static_cast<std::size_t>(strand)] = overrun;
  std::vector<StrandPath> paths = strand_paths(weave, crossings, profile, options, overruns, execution, faults);
  const auto channels = channel_paths(weave, crossings, profile, overruns, execution, faults);
  faults.throw_if_any();

  ToolpathBuilder builder(profile);
  add_supports(layout_box(paths, overruns, weave), profile, options, builder);
  for (const int s : order) {
    execution.cancellation.throw_if_requested();
    add_strand(s, weave.strands[static_cast<std::size_t>(s)], std::move(paths[static_cast<std::size_t>(s)]), profile,
               builder);
  }
  for (std::size_t c = 0; c < crossings.size(); ++c) {
    const double radius = weave.strands[static_cast<std::size_t>(crossings[c].bottom)].radius;
    builder.extrude({MoveKind::channel, channels[c], profile.channel_flow * bead_area(profile, radius),
                     profile.channel_speed, crossings[c].bottom, crossings[c].crossing});
  }
  Toolpath result{builder.take(), {}};
  execution.cancellation.throw_if_requested();
  place(result.moves, options, profile);
  add_priming(result.moves, profile);
  result.statistics = statistics(result.moves, profile);
  check_bed(result, profile);
  return result;
}

}  // namespace supple::weave
