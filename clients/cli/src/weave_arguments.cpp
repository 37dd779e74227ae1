#include "weave_arguments.h"

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <sstream>
#include <system_error>

#include "failure.h"
#include "numbers.h"
#include "session.h"
#include "suggestions.h"
#include "units.h"

namespace supple::cli {
namespace {

std::string pattern_of(const std::string& name) {
  if (name == "regular") return name;
  if (name == "squares" || name == "interlacing_squares") return "interlacing_squares";
  if (name == "circles" || name == "interlacing_circles") return "interlacing_circles";
  if (name == "rings" || name == "actuated_rings") return "actuated_rings";
  if (name == "sample" || name == "printed_sample") return "printed_sample";
  return {};
}

std::vector<std::string> pattern_names() { return {"regular", "squares", "circles", "rings", "sample"}; }

std::int64_t parsed_index(std::string_view text, const char* what) {
  const auto index = integer_in(text);
  if (!index || *index < 0) throw Failure(ExitCode::usage, fmt::format("'{}' is no {}", text, what));
  return *index;
}

/// One connection for all crossings, such as "fused", or four in two rows, the lower row first:
/// "fused,slides_x;slides_y,fused".
nlohmann::json parse_connections(const std::string& text) {
  if (text.find_first_of(",;") == std::string::npos) return text;
  auto rows = nlohmann::json::array();
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line, ';');) {
    auto row = nlohmann::json::array();
    std::istringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(cell);
    rows.push_back(row);
  }
  return rows;
}

nlohmann::json parse_sheet(const std::string& text) {
  const std::size_t cross = text.find('x');
  const auto columns = integer_in(std::string_view(text).substr(0, cross));
  const auto rows = cross == std::string::npos ? std::nullopt : integer_in(std::string_view(text).substr(cross + 1));
  if (!columns || !rows)
    throw Failure(ExitCode::usage, fmt::format("'{}' is no size of a sheet: write for example 5x4", text));
  return {{"columns", *columns}, {"rows", *rows}};
}

nlohmann::json parse_overrides(const WeaveArguments& arguments) {
  auto overrides = nlohmann::json::array();
  for (const auto& crossing : arguments.fused)
    overrides.push_back({{"crossing", parsed_index(crossing, "crossing")}, {"slides", nlohmann::json::array()}});
  for (const auto& entry : arguments.sliding) {
    const std::size_t colon = entry.find(':');
    if (colon == std::string::npos)
      throw Failure(ExitCode::usage, fmt::format("'{}' is no crossing and member: write for example 3:0", entry));
    const auto crossing = parsed_index(std::string_view(entry).substr(0, colon), "crossing");
    const auto member = parsed_index(std::string_view(entry).substr(colon + 1), "member of a crossing");
    // Both members of a crossing slide if each is named by itself.
    if (!overrides.empty() && overrides.back()["crossing"] == crossing && !overrides.back()["slides"].empty()) {
      overrides.back()["slides"].push_back(member);
    } else {
      overrides.push_back({{"crossing", crossing}, {"slides", {member}}});
    }
  }
  return overrides;
}

void set_pattern_fields(const WeaveArguments& arguments, nlohmann::json& weave) {
  const auto set_length = [&](const char* name, double value) {
    if (value > 0) weave[name] = value;
  };
  if (!arguments.type.empty()) weave["type"] = parsed_index(arguments.type, "type of a pattern");
  if (!arguments.sample.empty()) weave["sample"] = arguments.sample;
  if (!arguments.connections.empty()) weave["connections"] = parse_connections(arguments.connections);
  set_length("pitch", arguments.pitch);
  set_length("side", arguments.side);
  set_length("overlap", arguments.overlap);
  set_length("circle_radius", arguments.circle_radius);
  set_length("distance", arguments.distance);
  if (!arguments.sheet.empty()) weave["sheet"] = parse_sheet(arguments.sheet);
  if (arguments.fused_border > 0) weave["sheet"]["fused_border"] = arguments.fused_border;
}

}  // namespace

void add_weave_options(CLI::App& command, WeaveArguments& arguments) {
  command
      .add_option("weave", arguments.weave,
                  "regular, squares, circles, rings or sample, or a JSON file with a pattern, or strands and crossings")
      ->required();
  command.add_option("--type", arguments.type,
                     "Of squares 1 to 4 (fused, sliding in x, both ways, one corner fused), "
                     "of circles 1 (fused) or 2 (sliding)");
  command.add_option("--sample", arguments.sample, "Which of the sheets that have been printed and tested")
      ->check(CLI::IsMember({"fused_grid", "sliding_grid", "squares_1", "squares_2", "squares_3", "squares_4",
                             "circles_fused", "circles_sliding", "actuation"}));
  command.add_option(
      "--connections", arguments.connections,
      "Of a regular weave: fused, slides_x or slides_y, or rows from below: fused,slides_x;slides_y,fused");
  const auto add_length = [&](const char* name, double& value, const char* text) {
    command.add_option(name, value, text)->transform(quantity(Dimension::length))->check(CLI::PositiveNumber);
  };
  add_length("--pitch", arguments.pitch, "Of a regular weave, in mm (4)");
  add_length("--side", arguments.side, "Of squares, in mm (12)");
  add_length("--overlap", arguments.overlap, "Of squares' corners, in mm (3; of a sheet 3.6)");
  add_length("--circle-radius", arguments.circle_radius, "In mm (5.5; of a sheet 8)");
  add_length("--distance", arguments.distance, "Of circles' centres, in mm (10; of a sheet 14.4)");
  command.add_option("--sheet", arguments.sheet, "A finite sheet of so many columns and rows: 20x20");
  command.add_option("--fused-border", arguments.fused_border, "Crossings at a regular sheet's border that are fused")
      ->check(CLI::NonNegativeNumber);
  add_length("--radius", arguments.radius, "Radius of the strands, in mm (0.25)");
  command.add_option("--youngs-modulus", arguments.youngs_modulus, "Of the strands, in MPa (3500)")
      ->transform(quantity(Dimension::stress))
      ->check(CLI::PositiveNumber);
  command.add_option("--poisson-ratio", arguments.poisson_ratio, "Of the strands (0.42)");
  command.add_option("--fuse", arguments.fused, "Crossings that are fused, whatever the pattern says: 3,5")
      ->delimiter(',');
  command
      .add_option("--slide", arguments.sliding,
                  "Crossings and the member of each that slides: 4:0,7:1; see supple weave layout --crossings")
      ->delimiter(',');
  command
      .add_option("--sliding-share", arguments.sliding_fraction,
                  "How far strands slide, as a share of the way to the next crossing (squares, circles: 0.7)")
      ->check(CLI::PositiveNumber);
}

nlohmann::json weave_of(const WeaveArguments& arguments) {
  const std::string pattern = pattern_of(arguments.weave);
  std::error_code ignored;
  if (pattern.empty() && !looks_like_path(arguments.weave) && !std::filesystem::exists(arguments.weave, ignored))
    throw Failure(ExitCode::usage,
                  fmt::format("'{}' is neither a pattern (regular, squares, circles, rings, sample) nor a file{}",
                              arguments.weave, suggestion(arguments.weave, pattern_names())));
  nlohmann::json weave = pattern.empty() ? object_in_file(arguments.weave) : nlohmann::json{{"pattern", pattern}};
  // The file may be a whole request.
  if (weave.contains("weave")) weave = weave.at("weave");
  set_pattern_fields(arguments, weave);
  if (arguments.radius > 0) weave["radius"] = arguments.radius;
  if (arguments.youngs_modulus > 0) weave["material"]["youngs_modulus"] = arguments.youngs_modulus;
  if (!arguments.poisson_ratio.empty())
    weave["material"]["poisson_ratio"] = parse_number(arguments.poisson_ratio, "Poisson's ratio");
  if (arguments.sliding_fraction > 0) weave["sliding_share"] = arguments.sliding_fraction;
  for (const auto& change : parse_overrides(arguments)) weave["overrides"].push_back(change);
  return weave;
}

void add_equilibrium_options(CLI::App& command, EquilibriumArguments& arguments) {
  command.add_option("--segments", arguments.segments, "Pieces of rod between crossings (4)")
      ->check(CLI::PositiveNumber);
  command.add_option("-t,--tolerance", arguments.tolerance, "Relative residual of an equilibrium (1e-6)")
      ->check(CLI::PositiveNumber);
  command.add_option("--max-iterations", arguments.max_iterations, "Newton iterations of one load step (100)")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--load-steps", arguments.load_steps, "Load steps to a state at least (as many as keep each to 4 %)")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--limit-tolerance", arguments.limit_tolerance,
                  "Error of the energy because sliders stand short of their limits, relative (1e-6)")
      ->check(CLI::PositiveNumber);
  command
      .add_option("--least-distance", arguments.least_distance,
                  "Between crossings that slide, in mm (strands that cross there touch)")
      ->transform(quantity(Dimension::length));
  command
      .add_option("--barrier-range", arguments.barrier_range,
                  "Where resistance before a limit begins on the way, in mm (a twentieth of the mean length of rod)")
      ->transform(quantity(Dimension::length));
  command.add_option("--sliding-stiffness", arguments.sliding_stiffness,
                     "Stiffness of every sliding displacement, in N/mm (7.1e-11 E times the mean length of rod)");
  const auto switch_values = CLI::IsMember({"automatic", "on", "off"});
  command.add_option("--out-of-plane", arguments.out_of_plane, "The third dimension (automatic)")->check(switch_values);
  command.add_option("--buckling", arguments.buckling, "Leave unstable states (automatic)")->check(switch_values);
  command
      .add_option(
          "--error-estimate", arguments.error_estimate,
          "Compute states once more with half as many segments, which tells their errors (automatic: of at most "
          "24 directions or gradients, and of no sheet)")
      ->check(switch_values);
  command.add_option("--deadline", arguments.deadline, "Seconds that the computation may take, or for example 2min")
      ->transform(quantity(Dimension::duration))
      ->check(CLI::PositiveNumber);
}

void set_equilibrium_fields(const EquilibriumArguments& arguments, nlohmann::json& request) {
  const auto set_number = [&](const char* name, auto value) {
    if (value > 0) request["accuracy"][name] = value;
  };
  set_number("segments", arguments.segments);
  set_number("tolerance", arguments.tolerance);
  set_number("max_iterations", arguments.max_iterations);
  set_number("load_steps", arguments.load_steps);
  set_number("limit_tolerance", arguments.limit_tolerance);
  if (!arguments.least_distance.empty())
    request["sliding"]["least_distance"] = parse_number(arguments.least_distance, "distance");
  if (!arguments.barrier_range.empty())
    request["sliding"]["barrier_range"] = parse_number(arguments.barrier_range, "range");
  if (!arguments.sliding_stiffness.empty())
    request["sliding"]["regularization"] = parse_number(arguments.sliding_stiffness, "stiffness");
  if (!arguments.out_of_plane.empty()) request["effects"]["out_of_plane"] = arguments.out_of_plane;
  if (!arguments.buckling.empty()) request["effects"]["buckling"] = arguments.buckling;
  if (!arguments.error_estimate.empty()) request["effects"]["error_estimate"] = arguments.error_estimate;
  if (arguments.deadline > 0) request["deadline"] = arguments.deadline;
}

}  // namespace supple::cli
