#include "weave_reader.h"

#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "supple/problem/problem.h"

namespace supple::json {
namespace {

// The ranges of api/openapi.yaml.
constexpr double max_weave_length = 1e6;
constexpr int max_columns = 20'000;
constexpr int max_cells_apart = 1000;
constexpr std::size_t max_crossings = 1'000'000;
constexpr std::size_t max_members = 1000;
constexpr auto connection_names = names_of<weave::Connection>({{weave::Connection::fused, "fused"},
                                                               {weave::Connection::slides_x, "slides_x"},
                                                               {weave::Connection::slides_y, "slides_y"}});

enum class Pattern { none, regular, squares, circles, rings, sample };
constexpr auto pattern_names = names_of<Pattern>({{Pattern::regular, "regular"},
                                                  {Pattern::squares, "interlacing_squares"},
                                                  {Pattern::circles, "interlacing_circles"},
                                                  {Pattern::rings, "actuated_rings"},
                                                  {Pattern::sample, "printed_sample"}});

using weave::Sample;
constexpr auto sample_names = names_of<Sample>({{Sample::fused_grid, "fused_grid"},
                                                {Sample::sliding_grid, "sliding_grid"},
                                                {Sample::squares_1, "squares_1"},
                                                {Sample::squares_2, "squares_2"},
                                                {Sample::squares_3, "squares_3"},
                                                {Sample::squares_4, "squares_4"},
                                                {Sample::circles_fused, "circles_fused"},
                                                {Sample::circles_sliding, "circles_sliding"},
                                                {Sample::actuation, "actuation"}});

void read_length(Fields& fields, std::string_view name, double& out) {
  fields.number(name, out, 0, max_weave_length, true);
}

void read_length(Fields& fields, std::string_view name, std::optional<double>& out) {
  double value = 0;
  read_length(fields, name, value);
  if (value > 0) out = value;
}

/// Reads an array of integers, each within a range.
void read_integers(Fields& fields, std::string_view name, bool is_required, std::size_t min, std::size_t max,
                   std::pair<int, int> range, std::vector<int>& out) {
  const auto* entries = fields.array(name, is_required, min, max, "");
  if (!entries) return;
  for (std::size_t i = 0; i < entries->size(); ++i) {
    const auto& entry = (*entries)[i];
    const double value = entry.is_number_integer() ? entry.get<double>() : 0.5;
    if (value != std::floor(value) || value < range.first || value > range.second) {
      fields.faults().add(
          fields.at(name) + "/" + std::to_string(i),
          "must be an integer from " + std::to_string(range.first) + " to " + std::to_string(range.second));
    } else {
      out.push_back(entry.get<int>());
    }
  }
}

void read_index(Fields& fields, std::string_view name, int& out) {
  fields.required(name);
  fields.integer(name, out, 0, max_index);
}

/// Reads a limit of sliding; null means that there is none.
void read_range(Fields& fields, std::string_view name, std::optional<double>& out) {
  const auto* value = fields.optional(name);
  if (!value) return;
  if (value->is_null()) {
    out = std::numeric_limits<double>::infinity();
    return;
  }
  double range = 0;
  if (read_number(*value, fields.at(name), fields.faults(), range, 0, max_weave_length)) out = range;
}

void read_ranges(Fields& fields, SlidingRange& range) {
  read_range(fields, "backward", range.backward);
  read_range(fields, "forward", range.forward);
}

std::optional<SheetSpec> read_sheet(Fields& fields, bool has_border) {
  std::optional<SheetSpec> sheet;
  nested(fields, "sheet", [&](Fields& inner) {
    sheet.emplace();
    inner.required("columns");
    inner.integer("columns", sheet->columns, 1, max_columns);
    inner.required("rows");
    inner.integer("rows", sheet->rows, 1, max_columns);
    if (has_border) inner.integer("fused_border", sheet->fused_border, 0, max_columns);
  });
  return sheet;
}

std::optional<weave::Connection> connection_in(const Document& value) {
  const auto* text = value.get_ptr<const std::string*>();
  return text ? connection_names.find(*text) : std::nullopt;
}

void read_connections(Fields& fields, weave::ConnectionBlock& block) {
  constexpr auto expected = "must be \"fused\", \"slides_x\" or \"slides_y\", or an array of 2 rows of 2 of them";
  const auto* value = fields.optional("connections");
  if (!value) return;
  if (const auto alike = connection_in(*value)) {
    block = weave::uniform_block(*alike);
    return;
  }
  const auto is_pair = [](const Document& entry) { return entry.is_array() && entry.size() == 2; };
  if (!is_pair(*value) || !is_pair((*value)[0]) || !is_pair((*value)[1]))
    return fields.faults().add(fields.at("connections"), expected);
  for (std::size_t row = 0; row < 2; ++row)
    for (std::size_t column = 0; column < 2; ++column) {
      const auto connection = connection_in((*value)[row][column]);
      if (connection) {
        block[row][column] = *connection;
      } else {
        fields.faults().add(fields.at("connections") + "/" + std::to_string(row) + "/" + std::to_string(column),
                            must_be_one_of(connection_names.names()));
      }
    }
}

RegularSpec read_regular(Fields& fields) {
  RegularSpec regular;
  read_connections(fields, regular.connections);
  read_length(fields, "pitch", regular.pitch);
  regular.sheet = read_sheet(fields, true);
  return regular;
}

SquaresSpec read_squares(Fields& fields) {
  SquaresSpec squares;
  int type = 1;
  fields.required("type");
  fields.integer("type", type, 1, 4);
  squares.type = static_cast<weave::SquareType>(type);
  read_length(fields, "side", squares.side);
  read_length(fields, "overlap", squares.overlap);
  squares.sheet = read_sheet(fields, false);
  return squares;
}

CirclesSpec read_circles(Fields& fields) {
  CirclesSpec circles;
  int type = 1;
  fields.required("type");
  fields.integer("type", type, 1, 2);
  circles.type = type == 1 ? weave::CircleType::all_fused : weave::CircleType::all_slide;
  read_length(fields, "circle_radius", circles.radius);
  read_length(fields, "distance", circles.distance);
  circles.sheet = read_sheet(fields, false);
  return circles;
}

SampleSpec read_sample(Fields& fields) {
  SampleSpec spec;
  fields.required("sample");
  fields.choice("sample", spec.sample, sample_names);
  return spec;
}

StrandSpec read_strand(const Document& value, const std::string& pointer, Faults& faults, std::size_t max_points) {
  StrandSpec strand;
  Fields fields(value, pointer, faults);
  if (const auto* points = fields.array("points", true, 1, max_points, "")) {
    strand.points.resize(points->size());
    for (std::size_t i = 0; i < points->size(); ++i)
      read_components((*points)[i], fields.at("points") + "/" + std::to_string(i), faults, strand.points[i],
                      -max_weave_length, max_weave_length);
  }
  fields.choice("ends", strand.ends, ends_names);
  if (const auto* translation = fields.optional("translation"))
    read_components(*translation, fields.at("translation"), faults, strand.translation, -max_weave_length,
                    max_weave_length);
  if (fields.present("translation") != (strand.ends == weave::Ends::periodic))
    faults.add(fields.at("translation"),
               fields.present("translation") ? "belongs to periodic strands only" : "is required of a periodic strand");
  read_length(fields, "radius", strand.radius);
  fields.finish();
  return strand;
}

MemberSpec read_member(const Document& value, const std::string& pointer, Faults& faults) {
  MemberSpec member;
  Fields fields(value, pointer, faults);
  read_index(fields, "strand", member.strand);
  fields.required("coordinate");
  fields.number("coordinate", member.coordinate, 0, max_length);
  std::vector<int> shift;
  read_integers(fields, "shift", false, 2, 2, {-max_cells_apart, max_cells_apart}, shift);
  if (shift.size() == 2) member.shift = {shift[0], shift[1]};
  fields.boolean("slides", member.slides);
  read_ranges(fields, member.range);
  fields.finish();
  return member;
}

std::vector<std::vector<MemberSpec>> read_crossings(const Document& entries, const std::string& pointer,
                                                    Faults& faults) {
  std::vector<std::vector<MemberSpec>> crossings(entries.size());
  for (std::size_t c = 0; c < entries.size(); ++c) {
    Fields fields(entries[c], pointer + "/" + std::to_string(c), faults);
    if (const auto* members = fields.array("members", true, 2, max_members, ""))
      for (std::size_t m = 0; m < members->size(); ++m)
        crossings[c].push_back(read_member((*members)[m], fields.at("members") + "/" + std::to_string(m), faults));
    fields.finish();
  }
  return crossings;
}

LayoutSpec read_layout(Fields& fields, const Limits& limits) {
  LayoutSpec layout;
  if (const auto* strands = fields.array("strands", true, 1, limits.max_strands, "")) {
    std::size_t points = 0;
    for (std::size_t s = 0; s < strands->size(); ++s) {
      layout.strands.push_back(read_strand((*strands)[s], fields.at("strands") + "/" + std::to_string(s),
                                           fields.faults(), limits.max_strand_points));
      points += layout.strands.back().points.size();
    }
    if (points > limits.max_strand_points)
      problem::throw_limit("request.limit_exceeded", "The number of points of all strands",
                           static_cast<double>(limits.max_strand_points), static_cast<double>(points), "",
                           fields.at("strands"));
  }
  if (const auto* crossings = fields.array("crossings", false, 0, max_crossings, ""))
    layout.crossings = read_crossings(*crossings, fields.at("crossings"), fields.faults());
  if (const auto* rows = fields.array("lattice", false, 2, 2, "")) {
    // The translations are rows in JSON and columns in the engine.
    layout.lattice.emplace(Eigen::Matrix2d::Zero());
    for (int k = 0; k < 2; ++k) {
      Eigen::Vector2d translation(0, 0);
      read_components((*rows)[static_cast<std::size_t>(k)], fields.at("lattice") + "/" + std::to_string(k),
                      fields.faults(), translation, -max_weave_length, max_weave_length);
      layout.lattice->col(k) = translation;
    }
  }
  return layout;
}

void read_overrides(Fields& fields, std::vector<CrossingOverride>& overrides) {
  const auto* entries = fields.array("overrides", false, 0, max_crossings, "");
  if (!entries) return;
  for (std::size_t i = 0; i < entries->size(); ++i) {
    CrossingOverride& change = overrides.emplace_back();
    Fields entry((*entries)[i], fields.at("overrides") + "/" + std::to_string(i), fields.faults());
    read_index(entry, "crossing", change.crossing);
    read_integers(entry, "slides", true, 0, max_members, {0, static_cast<int>(max_members)}, change.slides);
    read_ranges(entry, change.range);
    entry.finish();
  }
}

void read_source(Fields& fields, WeaveSpec& weave, const Limits& limits) {
  if (fields.present("strands")) {
    weave.source = read_layout(fields, limits);
    return;
  }
  auto pattern = Pattern::none;
  fields.choice("pattern", pattern, pattern_names);
  switch (pattern) {
    case Pattern::regular:
      weave.source = read_regular(fields);
      break;
    case Pattern::squares:
      weave.source = read_squares(fields);
      break;
    case Pattern::circles:
      weave.source = read_circles(fields);
      break;
    case Pattern::rings:
      weave.source = RingsSpec{};
      break;
    case Pattern::sample:
      weave.source = read_sample(fields);
      break;
    case Pattern::none:
      break;
  }
}

}  // namespace

WeaveSpec read_weave(Fields& fields, const Limits& limits) {
  WeaveSpec weave;
  const auto* value = fields.required("weave");
  if (!value) return weave;
  Fields inner(*value, fields.at("weave"), fields.faults());
  if (!value->is_object()) return weave;
  if (inner.present("pattern") == inner.present("strands")) {
    // It is unknown which other fields are allowed.
    fields.faults().add(fields.at("weave"), "must have exactly one of \"pattern\" and \"strands\"");
    return weave;
  }
  const auto* pattern = inner.present("pattern") ? value->at("pattern").get_ptr<const std::string*>() : nullptr;
  const bool known = !inner.present("pattern") || (pattern && pattern_names.find(*pattern));
  read_source(inner, weave, limits);
  read_length(inner, "radius", weave.radius);
  nested(inner, "material", [&](Fields& material) {
    material.number("youngs_modulus", weave.material.youngs_modulus, 1e-6, 1e7);
    material.number("poisson_ratio", weave.material.poisson_ratio, -0.99, 0.5);
  });
  read_overrides(inner, weave.overrides);
  if (inner.present("sliding_share")) {
    double share = 0;
    inner.number("sliding_share", share, 0, 1, true);
    weave.sliding_fraction = share;
  }
  inner.optional("sliding_share");
  if (known) inner.finish();
  return weave;
}

void read_equilibrium_options(Fields& fields, weave::EquilibriumOptions& options) {
  options.error_estimate = Switch::automatic;
  nested(fields, "accuracy", [&](Fields& accuracy) {
    accuracy.integer("segments", options.segments, 1, 64);
    accuracy.number("tolerance", options.tolerance, 1e-12, 0.1);
    accuracy.integer("max_iterations", options.max_iterations, 1, 10'000);
    accuracy.number("limit_tolerance", options.limit_tolerance, 1e-12, 1);
    accuracy.integer("load_steps", options.load_steps, 1, 10'000);
  });
  nested(fields, "sliding", [&](Fields& sliding) {
    const auto number = [&](std::string_view name, std::optional<double>& out, bool positive) {
      double value = 0;
      if (!sliding.present(name)) return sliding.number(name, value, 0, 1000, positive);
      sliding.number(name, out.emplace(0), 0, 1000, positive);
    };
    number("least_distance", options.least_distance, false);
    number("barrier_range", options.barrier_range, true);
    number("regularization", options.sliding_regularization, false);
  });
  nested(fields, "effects", [&](Fields& effects) {
    effects.choice("out_of_plane", options.out_of_plane, switch_names);
    effects.choice("buckling", options.buckling, switch_names);
    effects.choice("error_estimate", options.error_estimate, switch_names);
  });
}

}  // namespace supple::json
