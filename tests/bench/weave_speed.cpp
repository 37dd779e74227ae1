// Time of 200 directions of a cell and of sheets under shear, and its parts by stage.
#include <algorithm>

#include "measurement.h"
#include "supple/base/threads.h"
#include "weave_bench.h"

namespace supple::bench {
namespace {

using weave::Connection;
using weave::DirectionalResponse;
using weave::Stop;

constexpr double strains[] = {0.1, 0.3};
constexpr double cell_limit_s = 2;
constexpr double sheet_limit_s = 10;

std::string percent_of_time(double part, double whole) { return number(100 * part / whole, 2); }

std::vector<Table::Column> percent_columns(std::vector<Table::Column> first) {
  for (const Table::Column& column : {Table::Column{"assembly", "Assembly, %"},
                                      {"factorization", "Factorization, %"},
                                      {"solve", "Solves, %"},
                                      {"out_of_plane", "Look out of the plane, %"},
                                      {"other", "Other, %"}})
    first.push_back(column);
  return first;
}

std::vector<std::string> percent_cells(std::vector<std::string> first, const CostLedger& cost, double whole) {
  const WeaveTimes parts = times_of(cost);
  const double rest = whole - parts.assembly - parts.factorization - parts.solve - parts.out_of_plane;
  for (const double part : {parts.assembly, parts.factorization, parts.solve, parts.out_of_plane, rest})
    first.push_back(percent_of_time(part, whole));
  return first;
}

void study_cell_speed(Report& report, const WeaveSettings& settings) {
  const int directions = settings.brief ? 4 : 200;
  const int sampled = settings.brief ? 4 : 40;
  Table table("weaves-speed-cells", {{"cell", "Cell"},
                                     {"strain", "Strain"},
                                     {"elapsed_s", "Elapsed s"},
                                     {"cpu_s", "CPU s"},
                                     {"iterations", "Newton iterations per direction"},
                                     {"load_steps", "Load steps per direction"},
                                     {"out_of_plane", "Out of the plane"},
                                     {"unreached", "Not reached"}});
  Table parts("weaves-speed-cell-shares",
              percent_columns({{"cell", "Cell"}, {"strain", "Strain"}, {"ms", "ms per direction"}}));
  std::vector<BenchCell> cells = all_cells();
  if (settings.brief) cells = {cell_named("regular, fused"), cell_named("squares, type 1")};
  for (const double strain : strains) {
    std::string measured;
    double slowest = 0;
    for (const BenchCell& cell : cells) {
      const TimedCell run = run_timed(cell.weave, uniaxial(strain, directions));
      double iterations = 0, load_steps = 0;
      int out_of_plane = 0, unreached = 0;
      for (const DirectionalResponse& response : run.result) {
        iterations += response.state.iterations;
        load_steps += response.state.load_steps;
        out_of_plane += response.state.out_of_plane;
        unreached += response.state.stopped != Stop::converged;
      }
      table.row({cell.name, number(strain, 1), number(run.wall_seconds), number(run.cpu_seconds),
                 number(iterations / directions), number(load_steps / directions), std::to_string(out_of_plane),
                 std::to_string(unreached)});
      if (cell.name.rfind("squares", 0) != 0) continue;
      slowest = std::max(slowest, run.wall_seconds);
      measured += (measured.empty() ? "" : ", ") + cell.name.substr(9) + " " + number(run.wall_seconds) + " s";
    }
    report.target(std::to_string(directions) + " directions of each cell of squares, strain " + number(strain, 1) +
                      ", elapsed on " + std::to_string(thread_count()) + " threads",
                  "under " + number(cell_limit_s, 1) + " s", measured, slowest < cell_limit_s);
  }
  // With several threads the bill would count the time in which they wait for each other.
  const int threads = thread_count();
  set_thread_count(1);
  for (const BenchCell& cell : cells) {
    for (const double strain : strains) {
      const TimedCell run = run_timed(cell.weave, uniaxial(strain, sampled));
      parts.row(percent_cells({cell.name, number(strain, 1), number(1e3 * run.wall_seconds / sampled)}, run.cost,
                              run.wall_seconds));
    }
  }
  set_thread_count(threads);
  report.heading("Cells");
  report.text(
      std::to_string(directions) +
      " directions over half a turn at the default accuracy, from rest, shared among the threads. *Out of the plane* "
      "counts directions whose cells buckled; *not reached* those that could not be followed to the strain.");
  report.table(table);
  report.heading("Where the time goes");
  report.text(
      std::to_string(sampled) +
      " directions on one thread, elapsed. *Look out of the plane* is the search of each planar equilibrium for an "
      "unstable mode out of it; what a cell costs that did buckle is in the other columns. *Other* is building "
      "models, checking steps and frames.");
  report.table(parts);
}

struct StudiedSheet {
  std::string name;
  Connection connection;
  Shear shear;
};

void study_sheet_speed(Report& report, const WeaveSettings& settings) {
  constexpr double amount = 0.3;
  const int n = settings.brief ? 5 : 20;
  Table table("weaves-speed-sheets", percent_columns({{"sheet", "Sheet"},
                                                      {"unknowns", "Unknowns"},
                                                      {"load_steps", "Load steps"},
                                                      {"iterations", "Newton iterations"},
                                                      {"energy", "Energy, N mm"},
                                                      {"reached", "Reached"},
                                                      {"one_thread_s", "One thread, s"},
                                                      {"all_threads_s", "All threads, s"}}));
  std::vector<StudiedSheet> sheets{{"sliding, free to sink", Connection::slides_x, Shear::sinking},
                                   {"sliding, at constant height", Connection::slides_x, Shear::level},
                                   {"sliding, along the diagonal", Connection::slides_x, Shear::diagonal},
                                   {"fused, along the diagonal", Connection::fused, Shear::diagonal}};
  if (settings.brief) sheets.resize(2);
  for (const StudiedSheet& studied : sheets) {
    const LoadedSheet sheet = sheared_sheet(n, studied.connection, studied.shear, amount);
    const int threads = thread_count();
    const double on_all = run_timed(sheet.weave, sheet.load).wall_seconds;
    set_thread_count(1);
    const TimedSheet run = run_timed(sheet.weave, sheet.load);
    set_thread_count(threads);
    const weave::SheetState& last = run.result.states.back();
    table.row(percent_cells(
        {studied.name, count(run.result.unknowns), std::to_string(load_steps_of(run.result)),
         std::to_string(iterations_of(run.result)), number(last.energy),
         converged(run.result) ? "yes" : "up to " + number(last.share), number(run.wall_seconds), number(on_all)},
        run.cost, run.wall_seconds));
    report.target(
        "Sheet of " + std::to_string(n) + " x " + std::to_string(n) + " strands, " + studied.name + ", sheared by 30 %",
        "reached in under " + number(sheet_limit_s, 2) + " s",
        (converged(run.result) ? "" : "not reached; ") + number(run.wall_seconds) + " s",
        converged(run.result) && run.wall_seconds < sheet_limit_s);
  }
  report.heading("Sheets under shear");
  report.text(
      "Sliding: all crossings slide along x. *Free to sink* and *at constant height*: the lowest strand is held at "
      "every "
      "crossing, the highest one is moved aside by 30 % of their distance, and strands turn, or must stretch. *Along "
      "the "
      "diagonal*: three crossings of a corner are held, those of the opposite corner are drawn towards it by 30 % of "
      "the "
      "sheet's side in x and in y. One state each. Times are elapsed, shares those of one thread.");
  report.table(table);
}

}  // namespace

void study_weave_speed(const WeaveSettings& settings) {
  Report report(settings.folder, "weaves", "speed", "Time of cells and sheets");
  study_cell_speed(report, settings);
  study_sheet_speed(report, settings);
  report.write("weave_bench speed", settings.brief,
               "Default options throughout: 4 segments between crossings, a tolerance of 1e-6, effects automatic.");
}

}  // namespace supple::bench
