#include "supple/weave/patterns.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <string>
#include <utility>

#include "supple/weave/weave_error.h"

namespace supple::weave {
namespace {

using std::numbers::pi;
/// Number of points of a circle's spline. The radius of curvature is then right to 1e-5.
constexpr int circle_points = 64;
/// Crossings that are laid out between two checks for a stop request: a few milliseconds.
constexpr std::size_t laid_crossings_between_checks = 1024;

void require(bool good, const char* where, const std::string& message) {
  if (!good) throw WeaveError("weave.invalid_pattern", std::string(where) + " " + message, {{where, message}});
}

Strand line(const Eigen::Vector2d& from, const Eigen::Vector2d& to) { return {StrandCurve({from, to}, Ends::open)}; }

Strand circle(const Eigen::Vector2d& centre, double radius) {
  std::vector<Eigen::Vector2d> points;
  points.reserve(circle_points);
  for (int i = 0; i < circle_points; ++i) {
    const double angle = 2 * pi * i / circle_points;
    points.emplace_back(centre + radius * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
  }
  return {StrandCurve(points, Ends::closed)};
}

/// Adds the sides of a square, each a strand, counterclockwise from the bottom one.
void add_square(const Eigen::Vector2d& centre, double side, std::vector<Strand>& strands) {
  const double h = side / 2;
  const std::array<Eigen::Vector2d, 4> corners{Eigen::Vector2d(-h, -h), Eigen::Vector2d(h, -h), Eigen::Vector2d(h, h),
                                               Eigen::Vector2d(-h, h)};
  for (std::size_t k = 0; k < 4; ++k) strands.push_back(line(centre + corners[k], centre + corners[(k + 1) % 4]));
}

bool is_horizontal(const Weave& weave, const CrossingMember& member) {
  const Eigen::Vector2d t = weave.strands[static_cast<std::size_t>(member.strand)].curve.at(member.coordinate).first;
  return std::abs(t[0]) >= std::abs(t[1]);
}

/// The member of a crossing of two strands that lies along x, and the one along y.
CrossingMember& along_x(const Weave& weave, Crossing& crossing) {
  return crossing.members[is_horizontal(weave, crossing.members[0]) ? 0 : 1];
}
CrossingMember& along_y(const Weave& weave, Crossing& crossing) {
  return crossing.members[is_horizontal(weave, crossing.members[0]) ? 1 : 0];
}

void connect(const Weave& weave, Connection connection, Crossing& crossing) {
  if (connection == Connection::slides_x) along_x(weave, crossing).slides = true;
  if (connection == Connection::slides_y) along_y(weave, crossing).slides = true;
}

/// Decides which members slide where squares cross. Strand 4 k + i is side i of square k. The first `lattice_squares`
/// squares are those on the lattice; positions such as "bottom-left" refer to their centres.
void connect_squares(SquareType type, double side, int lattice_squares, Weave& weave, const Execution& execution = {}) {
  const auto is_end = [side](const CrossingMember& m) {
    return m.coordinate < 1e-6 * side || m.coordinate > side * (1 - 1e-6);
  };
  for (Crossing& crossing : weave.crossings) {
    const bool corner = std::all_of(crossing.members.begin(), crossing.members.end(), is_end);
    if (corner || type == SquareType::all_fused) continue;
    if (type == SquareType::all_slide_x) {
      along_x(weave, crossing).slides = true;
      continue;
    }
    // The square on the lattice slides through its neighbours' corners: with its horizontal side at one crossing of
    // each corner, and with its vertical side at the other one.
    CrossingMember& own = crossing.members[crossing.members[0].strand / 4 < lattice_squares ? 0 : 1];
    const auto bottom = static_cast<std::size_t>(own.strand) / 4 * 4;
    const Eigen::Vector2d centre =
        0.5 * (weave.strands[bottom].curve.at(0).position + weave.strands[bottom + 2].curve.at(0).position);
    const Eigen::Vector2d at =
        weave.strands[static_cast<std::size_t>(own.strand)].curve.at(own.coordinate).position - centre;
    const bool bottom_left = at[0] < 0 && at[1] < 0;
    if (type == SquareType::one_corner_fused && bottom_left) continue;
    own.slides = true;
  }
  limit_sliding(weave, sliding_fraction, execution);
}

void check_loops(double size, double overlap, const char* size_name, const char* overlap_name) {
  require(size > 0 && std::isfinite(size), size_name, "must be positive, in mm");
  require(overlap > 0 && std::isfinite(overlap), overlap_name, "must be positive, in mm");
}

void check_count(int columns, int rows) {
  require(columns >= 1 && rows >= 1, "columns", "and rows must be at least 1");
  require(static_cast<double>(columns) * rows <= max_pattern_strands, "columns",
          "times rows must be at most " + std::to_string(max_pattern_strands));
}

/// Decides which member of each crossing of circles slides: the circle whose neighbour lies in +x or -y.
void connect_circles(CircleType type, double radius, Weave& weave, const Execution& execution = {}) {
  if (type == CircleType::all_fused) return;
  for (Crossing& crossing : weave.crossings) {
    // Centre of the circle's copy at the crossing. A circle's coordinate 0 is to the right of its centre.
    const auto centre = [&](const CrossingMember& m) -> Eigen::Vector2d {
      return rest_position(weave, {m.strand, 0, m.shift}) - radius * Eigen::Vector2d(1, 0);
    };
    const Eigen::Vector2d between = centre(crossing.members[1]) - centre(crossing.members[0]);
    const bool beside = std::abs(between[0]) > std::abs(between[1]);
    // Beside each other the left circle slides, and above each other the upper one.
    const bool first = beside ? between[0] > 0 : between[1] < 0;
    crossing.members[first ? 0 : 1].slides = true;
  }
  limit_sliding(weave, sliding_fraction, execution);
}

}  // namespace

void limit_sliding(Weave& weave, double fraction, const Execution& execution) {
  std::vector<std::vector<double>> coordinates(weave.strands.size());
  for (std::size_t s = 0; s < coordinates.size(); ++s)
    if (weave.strands[s].curve.ends() == Ends::open) coordinates[s] = {0, weave.strands[s].curve.length()};
  for (const Crossing& crossing : weave.crossings)
    for (const CrossingMember& m : crossing.members)
      coordinates[static_cast<std::size_t>(m.strand)].push_back(m.coordinate);
  for (auto& list : coordinates) std::sort(list.begin(), list.end());
  for (std::size_t c = 0; c < weave.crossings.size(); ++c) {
    if (c % laid_crossings_between_checks == 0) execution.cancellation.throw_if_requested();
    for (CrossingMember& m : weave.crossings[c].members) {
      if (!m.slides) continue;
      const auto s = static_cast<std::size_t>(m.strand);
      const StrandCurve& curve = weave.strands[s].curve;
      const double near = 1e-7 * curve.length();
      const auto previous = std::lower_bound(coordinates[s].begin(), coordinates[s].end(), m.coordinate - near);
      const auto next = std::upper_bound(coordinates[s].begin(), coordinates[s].end(), m.coordinate + near);
      // Loops continue at their beginning. The ends of open strands are in the list.
      const double before =
          previous != coordinates[s].begin() ? *std::prev(previous) : coordinates[s].back() - curve.length();
      const double after = next != coordinates[s].end() ? *next : coordinates[s].front() + curve.length();
      m.backward = fraction * (m.coordinate - before);
      m.forward = fraction * (after - m.coordinate);
    }
  }
}

ConnectionBlock uniform_block(Connection connection) { return {{{connection, connection}, {connection, connection}}}; }

Weave regular_weave(const ConnectionBlock& block, double pitch) {
  require(pitch > 0 && std::isfinite(pitch), "pitch", "must be positive, in mm");
  const double cell = 2 * pitch;
  Weave weave;
  weave.lattice = Eigen::Matrix2d{{cell, 0}, {0, cell}};
  for (const double at : {0.5, 1.5})
    weave.strands.push_back({StrandCurve({{0, at * pitch}}, Ends::periodic, {cell, 0})});
  for (const double at : {0.5, 1.5})
    weave.strands.push_back({StrandCurve({{at * pitch, 0}}, Ends::periodic, {0, cell})});
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 2; ++column) {
      Crossing crossing{{{row, (column + 0.5) * pitch}, {2 + column, (row + 0.5) * pitch}}};
      connect(weave, block[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)], crossing);
      weave.crossings.push_back(std::move(crossing));
    }
  }
  return weave;
}

Weave regular_sheet(int columns, int rows, const ConnectionBlock& block, double pitch, int fused_border,
                    const Execution& execution) {
  require(pitch > 0 && std::isfinite(pitch), "pitch", "must be positive, in mm");
  check_count(columns, rows);
  Weave weave;
  weave.strands.reserve(static_cast<std::size_t>(columns) + static_cast<std::size_t>(rows));
  weave.crossings.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row)
    weave.strands.push_back(line({0, (row + 0.5) * pitch}, {columns * pitch, (row + 0.5) * pitch}));
  for (int column = 0; column < columns; ++column)
    weave.strands.push_back(line({(column + 0.5) * pitch, 0}, {(column + 0.5) * pitch, rows * pitch}));
  for (int row = 0; row < rows; ++row) {
    execution.cancellation.throw_if_requested();
    for (int column = 0; column < columns; ++column) {
      Crossing crossing{{{row, (column + 0.5) * pitch}, {rows + column, (row + 0.5) * pitch}}};
      const bool border = std::min({row, column, rows - 1 - row, columns - 1 - column}) < fused_border;
      const Connection connection = block[static_cast<std::size_t>(row % 2)][static_cast<std::size_t>(column % 2)];
      connect(weave, border ? Connection::fused : connection, crossing);
      weave.crossings.push_back(std::move(crossing));
    }
  }
  return weave;
}

Weave interlacing_squares(SquareType type, double side, double overlap) {
  check_loops(side, overlap, "side", "overlap");
  require(2 * overlap < side, "overlap", "must be less than half the side");
  const double period = 2 * (side - overlap);
  Weave weave;
  weave.lattice = Eigen::Matrix2d{{period, 0}, {0, period}};
  add_square({0, 0}, side, weave.strands);
  add_square({period / 2, period / 2}, side, weave.strands);
  weave.crossings = find_crossings(weave.strands, weave.lattice);
  connect_squares(type, side, 1, weave);
  return weave;
}

Weave interlacing_squares_sheet(SquareType type, int columns, int rows, double side, double overlap,
                                const Execution& execution) {
  check_loops(side, overlap, "side", "overlap");
  require(2 * overlap < side, "overlap", "must be less than half the side");
  check_count(columns, rows);
  const double period = 2 * (side - overlap);
  Weave weave;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      add_square({side / 2 + column * period, side / 2 + row * period}, side, weave.strands);
  for (int row = 0; row + 1 < rows; ++row)
    for (int column = 0; column + 1 < columns; ++column)
      add_square({side / 2 + (column + 0.5) * period, side / 2 + (row + 0.5) * period}, side, weave.strands);
  weave.crossings = find_crossings(weave.strands, std::nullopt, execution);
  connect_squares(type, side, columns * rows, weave, execution);
  return weave;
}

Weave interlacing_circles(CircleType type, double radius, double distance) {
  check_loops(radius, distance, "radius", "distance");
  require(distance < 2 * radius && distance > std::sqrt(2.0) * radius, "distance",
          "must lie between sqrt(2) and 2 radii: neighbours cut each other, others do not");
  Weave weave;
  weave.lattice = Eigen::Matrix2d{{distance, 0}, {0, distance}};
  weave.strands.push_back(circle({0, 0}, radius));
  weave.crossings = find_crossings(weave.strands, weave.lattice);
  connect_circles(type, radius, weave);
  return weave;
}

Weave interlacing_circles_sheet(CircleType type, int columns, int rows, double radius, double distance,
                                const Execution& execution) {
  check_loops(radius, distance, "radius", "distance");
  require(distance < 2 * radius && distance > std::sqrt(2.0) * radius, "distance",
          "must lie between sqrt(2) and 2 radii: neighbours cut each other, others do not");
  check_count(columns, rows);
  Weave weave;
  weave.strands.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      execution.cancellation.throw_if_requested();
      weave.strands.push_back(circle({column * distance, row * distance}, radius));
    }
  weave.crossings = find_crossings(weave.strands, std::nullopt, execution);
  connect_circles(type, radius, weave, execution);
  return weave;
}

Weave actuated_rings() {
  constexpr double outer = 28;
  constexpr double end = 44;
  Weave weave;
  for (const double radius : {12.0, 20.0, outer}) weave.strands.push_back(circle({0, 0}, radius));
  for (const double angle : {0.0, pi / 4, 3 * pi / 4}) {
    const Eigen::Vector2d d = outer * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    weave.strands.push_back(line(-d, d));
  }
  weave.strands.push_back(line({0, outer}, {0, -end}));
  const auto pushed = static_cast<int>(weave.strands.size()) - 1;
  weave.crossings = find_crossings(weave.strands);
  for (Crossing& crossing : weave.crossings)
    for (CrossingMember& m : crossing.members)
      if (m.strand == pushed && m.coordinate > 1e-6 * outer) m.slides = true;
  return weave;
}

}  // namespace supple::weave
