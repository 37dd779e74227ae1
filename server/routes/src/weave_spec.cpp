#include "weave_spec.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>
#include <utility>

#include "request_pointers.h"
#include "supple/weave/weave_error.h"

namespace supple::routes {
namespace {

using weave::Weave;

/// Columns are a parameter of patterns in the engine and a field of the sheet in requests.
PointerMap pattern_pointers() {
  return PointerMap("/weave", {{.field = "columns", .pointer = "/weave/sheet/columns"},
                               {.field = "radius", .pointer = "/weave/circle_radius"}});
}

/// Limit for the pieces of all curves of a layout, which take some 100 bytes each.
constexpr std::size_t max_pieces = weave::StrandCurve::max_pieces;

Weave lay_out(const json::LayoutSpec& spec, double radius, const Execution& execution) {
  Weave weave;
  weave.lattice = spec.lattice;
  weave.strands.reserve(spec.strands.size());
  std::size_t pieces = 0;
  for (std::size_t s = 0; s < spec.strands.size(); ++s) {
    const auto& strand = spec.strands[s];
    weave.strands.push_back(with_pointers<weave::WeaveError>(PointerMap("/weave/strands/" + std::to_string(s)), [&] {
      return weave::Strand{weave::StrandCurve(strand.points, strand.ends, strand.translation, execution),
                           strand.radius.value_or(radius)};
    }));
    pieces += weave.strands.back().curve.knots().size() - 1;
    if (pieces > max_pieces) {
      const std::string message = "turn so often that their curves have more than " + std::to_string(max_pieces) +
                                  " pieces together, the limit";
      throw Error("weave.invalid_layout", "The strands " + message + ".", {{"/weave/strands", message}});
    }
  }
  if (!spec.crossings) {
    // Finding them needs a lattice that has cells.
    if (weave.lattice && !(weave.lattice->determinant() > 0))
      throw Error("weave.invalid_layout", "The lattice must be of positive determinant.",
                  {{"/weave/lattice", "must be of positive determinant"}});
    weave.crossings = with_pointers<weave::WeaveError>(
        PointerMap("/weave"), [&] { return weave::find_crossings(weave.strands, weave.lattice, execution); });
    return weave;
  }
  for (const auto& members : *spec.crossings) {
    execution.cancellation.throw_if_requested();
    auto& crossing = weave.crossings.emplace_back();
    for (const auto& member : members)
      crossing.members.push_back({member.strand, member.coordinate, member.shift, member.slides});
  }
  return weave;
}

Weave lay_out(const json::RegularSpec& spec, const Execution& execution) {
  if (!spec.sheet) return weave::regular_weave(spec.connections, spec.pitch);
  return weave::regular_sheet(spec.sheet->columns, spec.sheet->rows, spec.connections, spec.pitch,
                              spec.sheet->fused_border, execution);
}

Weave lay_out(const json::SquaresSpec& spec, const Execution& execution) {
  constexpr double sheet_overlap = 3.6;
  const auto& sheet = spec.sheet;
  if (!sheet)
    return spec.overlap ? weave::interlacing_squares(spec.type, spec.side, *spec.overlap)
                        : weave::interlacing_squares(spec.type, spec.side);
  return weave::interlacing_squares_sheet(spec.type, sheet->columns, sheet->rows, spec.side,
                                          spec.overlap.value_or(sheet_overlap), execution);
}

Weave lay_out(const json::CirclesSpec& spec, const Execution& execution) {
  constexpr double cell_radius = 5.5;
  constexpr double cell_distance = 10;
  constexpr double sheet_radius = 8;
  constexpr double sheet_distance = 14.4;
  if (!spec.sheet)
    return weave::interlacing_circles(spec.type, spec.radius.value_or(cell_radius),
                                      spec.distance.value_or(cell_distance));
  return weave::interlacing_circles_sheet(spec.type, spec.sheet->columns, spec.sheet->rows,
                                          spec.radius.value_or(sheet_radius), spec.distance.value_or(sheet_distance),
                                          execution);
}

Weave lay_out(const json::RingsSpec&, const Execution&) { return weave::actuated_rings(); }

Weave lay_out(const json::SampleSpec& spec, const Execution&) { return weave::printed_sample(spec.sample).weave; }

Weave lay_out(const json::WeaveSpec& spec, const Execution& execution) {
  if (const auto* layout = std::get_if<json::LayoutSpec>(&spec.source)) return lay_out(*layout, spec.radius, execution);
  return with_pointers<weave::WeaveError>(pattern_pointers(), [&] {
    Weave weave = std::visit(
        [&](const auto& source) {
          if constexpr (std::is_same_v<std::decay_t<decltype(source)>, json::LayoutSpec>)
            return Weave{};
          else
            return lay_out(source, execution);
        },
        spec.source);
    for (auto& strand : weave.strands) strand.radius = spec.radius;
    return weave;
  });
}

void apply(const json::SlidingRange& range, weave::CrossingMember& member) {
  if (range.backward) member.backward = *range.backward;
  if (range.forward) member.forward = *range.forward;
}

Error invalid_override(std::size_t index, const std::string& field, const std::string& message) {
  const std::string where = "/weave/overrides/" + std::to_string(index) + "/" + field;
  return {"weave.invalid_layout", where.substr(1) + " " + message, {{where, message}}};
}

void override_connections(const std::vector<json::CrossingOverride>& overrides, Weave& weave) {
  for (std::size_t i = 0; i < overrides.size(); ++i) {
    const auto crossing = static_cast<std::size_t>(overrides[i].crossing);
    if (crossing >= weave.crossings.size())
      throw invalid_override(i, "crossing", "names no crossing: there are " + std::to_string(weave.crossings.size()));
    auto& members = weave.crossings[crossing].members;
    for (auto& member : members) member.slides = false;
    for (std::size_t k = 0; k < overrides[i].slides.size(); ++k) {
      const auto member = static_cast<std::size_t>(overrides[i].slides[k]);
      if (member >= members.size())
        throw invalid_override(i, "slides/" + std::to_string(k),
                               "names no member: the crossing has " + std::to_string(members.size()));
      members[member].slides = true;
      members[member].backward = members[member].forward = std::numeric_limits<double>::infinity();
    }
  }
}

/// Up to these limits, strands and listed crossings are laid out within milliseconds, whatever they look like. A
/// straight strand is one piece, while the pieces of a curve and their crossings have no such bound.
constexpr int max_small_strands = 100;
constexpr std::size_t max_small_straight_strands = 16;
constexpr std::size_t max_small_crossings = 1000;

/// A sheet of more strands than any pattern may have is refused before they are made, and is small therefore.
bool is_small(const std::optional<json::SheetSpec>& sheet) {
  if (!sheet) return true;
  const double cells = static_cast<double>(sheet->columns) * sheet->rows;
  return cells <= max_small_strands || cells > weave::max_pattern_strands;
}
bool is_small(const json::RegularSpec& spec) { return is_small(spec.sheet); }
bool is_small(const json::SquaresSpec& spec) { return is_small(spec.sheet); }
bool is_small(const json::CirclesSpec& spec) { return is_small(spec.sheet); }
bool is_small(const json::RingsSpec&) { return true; }
bool is_small(const json::SampleSpec&) { return true; }
bool is_small(const json::LayoutSpec& spec) {
  if (spec.strands.size() > max_small_straight_strands ||
      (spec.crossings && spec.crossings->size() > max_small_crossings))
    return false;
  return std::all_of(spec.strands.begin(), spec.strands.end(), [](const json::StrandSpec& strand) {
    return strand.points.size() <= (strand.ends == weave::Ends::open ? 2 : 1);
  });
}

/// Fraction of the distance to the next crossing that strands may slide. Without one in the request, loops have a
/// default, and other strands slide as far as their neighbours let them.
std::optional<double> sliding_fraction(const json::WeaveSpec& spec) {
  if (spec.sliding_fraction) return spec.sliding_fraction;
  const bool loops =
      std::holds_alternative<json::SquaresSpec>(spec.source) || std::holds_alternative<json::CirclesSpec>(spec.source);
  return loops ? std::optional(weave::sliding_fraction) : std::nullopt;
}

}  // namespace

Weave make_weave(const json::WeaveSpec& spec, const Execution& execution) {
  execution.cancellation.throw_if_requested();
  Weave weave = lay_out(spec, execution);
  weave.material = spec.material;
  override_connections(spec.overrides, weave);
  with_pointers<weave::WeaveError>(PointerMap("/weave"), [&] { validate(weave, execution); });
  if (const auto fraction = sliding_fraction(spec)) limit_sliding(weave, *fraction, execution);
  // The ranges that crossings have themselves take precedence over the fraction.
  if (const auto* layout = std::get_if<json::LayoutSpec>(&spec.source); layout && layout->crossings)
    for (std::size_t c = 0; c < weave.crossings.size(); ++c)
      for (std::size_t m = 0; m < weave.crossings[c].members.size(); ++m)
        apply((*layout->crossings)[c][m].range, weave.crossings[c].members[m]);
  for (const auto& change : spec.overrides)
    for (const int member : change.slides)
      apply(change.range,
            weave.crossings[static_cast<std::size_t>(change.crossing)].members[static_cast<std::size_t>(member)]);
  return weave;
}

void refuse_small_faulty_weave(const json::WeaveSpec& spec) {
  const bool small = std::visit([](const auto& source) { return is_small(source); }, spec.source);
  if (small && spec.overrides.size() <= max_small_crossings) make_weave(spec, {});
}

}  // namespace supple::routes
