// Error of sheets against time: segments, tolerance and load steps; and of a toolpath against its chord error.
#include <algorithm>
#include <cmath>
#include <vector>

#include "measurement.h"
#include "supple/weave/gcode.h"
#include "supple/weave/toolpath.h"
#include "weave_bench.h"

namespace supple::bench {
namespace {

using weave::Connection;
using weave::EquilibriumOptions;
using weave::Switch;

struct AccuracyScene {
  std::string name;
  LoadedSheet sheet;
};

std::vector<AccuracyScene> accuracy_scenes(const WeaveSettings& settings) {
  const int n = settings.brief ? 4 : 12;
  return {{"fused, sheared by 5 %", sheared_sheet(n, Connection::fused, Shear::sinking, 0.05)},
          {"sliding, sheared by 30 %", sheared_sheet(n, Connection::slides_x, Shear::level, 0.3)},
          {"fused, drawn at a corner by 10 %", sheared_sheet(n, Connection::fused, Shear::diagonal, 0.1)}};
}

/// Sheets stay in the plane: out of it the equilibrium that is found would be compared, and not how well it is
/// computed.
TimedSheet run_in_plane(const AccuracyScene& scene, EquilibriumOptions options) {
  options.out_of_plane = Switch::off;
  return run_timed(scene.sheet.weave, scene.sheet.load, options);
}

/// The force on what is moved, N.
double pull(const AccuracyScene& scene, const TimedSheet& run) {
  const auto& state = run.result.states.back();
  Eigen::Vector3d sum(0, 0, 0);
  for (std::size_t i = 0; i < scene.sheet.load.supports.size(); ++i)
    if (scene.sheet.load.supports[i].displacement.norm() > 0) sum += state.reactions[i];
  return sum.norm();
}

/// The largest distance of a crossing from where the reference has it, mm.
double farthest(const TimedSheet& run, const TimedSheet& reference) {
  const auto& own = run.result.states.back().crossings;
  const auto& exact = reference.result.states.back().crossings;
  double distance = 0;
  for (std::size_t i = 0; i < own.size(); ++i) distance = std::max(distance, (own[i] - exact[i]).norm());
  return distance;
}

using Cells = std::vector<std::string>;

/// What a run differs by from the reference, for a row.
Cells differences(const AccuracyScene& scene, const TimedSheet& run, const TimedSheet& reference) {
  const double energy = reference.result.states.back().energy;
  const double force = pull(scene, reference);
  return {std::to_string(iterations_of(run.result)), number(1e3 * run.cpu_seconds),
          percent(std::abs(run.result.states.back().energy - energy) / energy),
          percent(std::abs(pull(scene, run) - force) / force), number(farthest(run, reference), 2)};
}

Table sheet_table(const std::string& file, const Table::Column& knob) {
  return {file,
          {{"sheet", "Sheet"},
           knob,
           {"iterations", "Newton iterations"},
           {"ms", "CPU ms"},
           {"energy_percent", "Error of the energy, %"},
           {"force_percent", "Error of the force, %"},
           {"distance_mm", "Farthest crossing, mm"}}};
}

void add_row(Table& table, const AccuracyScene& scene, const std::string& value, Cells cells) {
  cells.insert(cells.begin(), {scene.name, value});
  table.row(std::move(cells));
}

void study_sheet_segments(Report& report, const WeaveSettings& settings) {
  const std::vector<int> segments = settings.brief ? std::vector<int>{2, 4} : std::vector<int>{2, 4, 8, 16};
  const int finest = 2 * segments.back();
  Table table = sheet_table("weaves-sheet-segments", {"segments", "Segments"});
  for (const AccuracyScene& scene : accuracy_scenes(settings)) {
    const TimedSheet reference = run_in_plane(scene, {.segments = finest});
    for (const int n : segments)
      add_row(table, scene, std::to_string(n), differences(scene, run_in_plane(scene, {.segments = n}), reference));
  }
  report.heading("Segments");
  report.text("Pieces of rod between neighbouring crossings (`accuracy.segments`), against " + std::to_string(finest) +
              ".");
  report.table(table);
}

void study_sheet_tolerance(Report& report, const WeaveSettings& settings) {
  constexpr double tightest = 1e-11;
  const std::vector<double> tolerances =
      settings.brief ? std::vector<double>{1e-2, 1e-6} : std::vector<double>{1e-1, 1e-2, 1e-4, 1e-6, 1e-8};
  Table table = sheet_table("weaves-sheet-tolerance", {"tolerance", "Tolerance"});
  double worst_of_default = 0;
  for (const AccuracyScene& scene : accuracy_scenes(settings)) {
    const TimedSheet reference = run_in_plane(scene, {.tolerance = tightest});
    for (const double tolerance : tolerances) {
      const TimedSheet run = run_in_plane(scene, {.tolerance = tolerance});
      const double force = pull(scene, reference);
      if (tolerance == EquilibriumOptions{}.tolerance)
        worst_of_default = std::max(worst_of_default, std::abs(pull(scene, run) - force) / force);
      add_row(table, scene, number(tolerance, 1), differences(scene, run, reference));
    }
  }
  report.target("What the default tolerance leaves of error in a force", "at most 0.01 %",
                percent(worst_of_default) + " %", worst_of_default <= 1e-4);
  report.heading("Tolerance");
  report.text("The relative residual of an equilibrium (`accuracy.tolerance`), against " + number(tightest, 1) +
              ". Segments are the default.");
  report.table(table);
}

void study_sheet_load_steps(Report& report, const WeaveSettings& settings) {
  const std::vector<int> counts = settings.brief ? std::vector<int>{1, 4} : std::vector<int>{1, 2, 4, 8, 16, 32};
  const int finest = 4 * counts.back();
  Table table = sheet_table("weaves-sheet-steps", {"load_steps", "Load steps"});
  for (const AccuracyScene& scene : accuracy_scenes(settings)) {
    const TimedSheet reference = run_in_plane(scene, {.load_steps = finest});
    for (const int n : counts)
      add_row(table, scene, std::to_string(n), differences(scene, run_in_plane(scene, {.load_steps = n}), reference));
    add_row(table, scene, "automatic", differences(scene, run_in_plane(scene, {}), reference));
  }
  report.heading("Load steps");
  report.text(
      "The least number of load steps (`accuracy.load_steps`), against " + std::to_string(finest) +
      ". An equilibrium does not depend on the way to it, unless there are several: an error that does not shrink "
      "is another equilibrium.");
  report.table(table);
}

/// The length of everything that is extruded, and the size of what is sent.
void study_chord_error(Report& report, const WeaveSettings& settings) {
  const int n = settings.brief ? 2 : 6;
  const weave::Weave sheet = weave::interlacing_circles_sheet(weave::CircleType::all_slide, n, n);
  const std::vector<double> errors =
      settings.brief ? std::vector<double>{0.1, 0.005} : std::vector<double>{0.1, 0.005, 0.002, 0.001, 0.0005, 0.0002};
  constexpr double finest = 1e-4;
  const auto length = [&](double chord_error) {
    weave::ToolpathOptions options;
    options.chord_error = chord_error;
    return weave::toolpath(sheet, {}, options).statistics.extruded_length;
  };
  const double exact = length(finest);
  Table table("weaves-chord-error", {{"chord_error", "Chord error, mm"},
                                     {"ms", "Toolpath and G-code, CPU ms"},
                                     {"kilobytes", "G-code, kB"},
                                     {"points", "Points"},
                                     {"length_percent", "Error of the printed length, %"}});
  for (const double chord_error : errors) {
    weave::Toolpath path;
    std::string gcode;
    const double seconds = cpu_time([&] {
      weave::ToolpathOptions options;
      options.chord_error = chord_error;
      path = weave::toolpath(sheet, {}, options);
      gcode = weave::to_gcode(path, {});
    });
    double points = 0;
    for (const weave::Move& move : path.moves) points += static_cast<double>(move.points.size());
    table.row({number(chord_error, 1), number(1e3 * seconds), count(static_cast<double>(gcode.size()) / 1000),
               count(points), percent(std::abs(path.statistics.extruded_length - exact) / exact)});
  }
  report.heading("Chord error of a print");
  report.text("The largest distance of a printed polyline from its curve (`chord_error`), for a sheet of " +
              std::to_string(n) + " x " + std::to_string(n) +
              " circles that slide. A printer's nozzle is 0.4 mm wide. The printed length is compared with that at " +
              number(finest, 1) +
              " mm; it falls short with the chord error itself. Above 0.004 mm "
              "the pieces of the curves decide, none of which turns by more than 0.06 rad.");
  report.table(table);
}

}  // namespace

void study_weave_sheets(const WeaveSettings& settings) {
  Report report(settings.folder, "weaves-sheets", "Sheets of weaves: error against time");
  study_sheet_segments(report, settings);
  report.image("weaves-sheets.svg", "Error of the force against time for segments, tolerances and load steps");
  study_sheet_tolerance(report, settings);
  study_sheet_load_steps(report, settings);
  study_chord_error(report, settings);
  report.write(weave_introduction(
      settings, "sheets",
      "Sheets of 12 x 12 straight strands in their plane. The force is that on what is moved. The farthest crossing is "
      "the one that lies farthest from where the reference has it. Times are CPU times."));
}

}  // namespace supple::bench
