// Cost of each effect, and what the answer loses without it.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "measurement.h"
#include "weave_bench.h"

namespace supple::bench {
namespace {

using weave::Connection;
using weave::DirectionalResponse;
using weave::EquilibriumOptions;
using weave::Stop;
using weave::Switch;
using weave::Weave;

/// Larger relative differences mean no more than that buckling has left hardly anything of a modulus.
constexpr double max_difference = 100;
std::string capped_percent(double fraction) { return fraction > max_difference ? "over 10,000" : percent(fraction); }
std::string milliseconds(const TimedCell& run) {
  return number(1e3 * run.cpu_seconds / static_cast<double>(run.result.size()));
}

template <typename Predicate>
int how_many(const TimedCell& run, Predicate predicate) {
  return static_cast<int>(std::count_if(run.result.begin(), run.result.end(), predicate));
}
bool left_plane(const DirectionalResponse& response) { return response.state.out_of_plane; }
bool unstable(const DirectionalResponse& response) { return !response.state.stable; }
bool unreached(const DirectionalResponse& response) { return response.state.stopped != Stop::converged; }

/// |E' - E| over the root mean square of E in all directions, for those directions that both runs reached and `wanted`
/// selects. E itself would be no scale: it is nearly zero where sliding is free.
template <typename Predicate>
std::vector<double> changes(const TimedCell& run, const TimedCell& automatic, Predicate wanted) {
  std::vector<double> scale, relative;
  for (std::size_t i = 0; i < automatic.result.size(); ++i) {
    const DirectionalResponse &with = automatic.result[i], &without = run.result[i];
    if (unreached(with) || unreached(without)) continue;
    scale.push_back(with.youngs_modulus);
    if (wanted(i)) relative.push_back(std::abs(without.youngs_modulus - with.youngs_modulus));
  }
  for (double& value : relative) value /= root_mean_square(scale);
  return relative;
}
bool anywhere(std::size_t) { return true; }

std::string median_and_worst(const std::vector<double>& relative) {
  return relative.empty() ? "none" : capped_percent(median(relative)) + ", " + capped_percent(quantile(relative, 1));
}

std::vector<BenchCell> studied_cells(const WeaveSettings& settings) {
  return settings.brief ? std::vector<BenchCell>{cell_named("squares, type 1")} : all_cells();
}
int directions_of(const WeaveSettings& settings) { return settings.brief ? 3 : 48; }

void study_plane(Report& report, const WeaveSettings& settings) {
  Table table("weaves-effects-plane", {{"cell", "Cell"},
                                       {"strain", "Strain"},
                                       {"off_ms", "Off, ms per direction"},
                                       {"automatic_ms", "Automatic"},
                                       {"on_ms", "On"},
                                       {"left", "Directions that leave the plane"},
                                       {"off_change", "Off is off there by, median, worst, %"},
                                       {"on_change", "On differs from automatic by, median, worst, %"},
                                       {"unreached", "Not reached: off, automatic, on"}});
  for (const double strain : {0.1, -0.1}) {
    for (const BenchCell& cell : studied_cells(settings)) {
      const auto run = [&](Switch out_of_plane) {
        EquilibriumOptions options;
        options.out_of_plane = out_of_plane;
        return run_timed(cell.weave, uniaxial(strain, directions_of(settings), options));
      };
      const TimedCell off = run(Switch::off), automatic = run(Switch::automatic), on = run(Switch::on);
      table.row(
          {cell.name, number(strain, 1), milliseconds(off), milliseconds(automatic), milliseconds(on),
           std::to_string(how_many(automatic, left_plane)),
           median_and_worst(changes(off, automatic, [&](std::size_t i) { return left_plane(automatic.result[i]); })),
           median_and_worst(changes(on, automatic, anywhere)),
           std::to_string(how_many(off, unreached)) + ", " + std::to_string(how_many(automatic, unreached)) + ", " +
               std::to_string(how_many(on, unreached))});
    }
  }
  report.heading("Out of the plane");
  report.text(
      "`effects.out_of_plane`: off stays in the plane whatever happens; automatic goes on in space from an "
      "equilibrium that is unstable against a mode out of the plane; on is in space, with twist, from the start. "
      "Changes are of moduli, relative to the root mean square over all directions.");
  report.table(table);
}

void study_buckling(Report& report, const WeaveSettings& settings) {
  Table table("weaves-effects-buckling", {{"cell", "Cell"},
                                          {"strain", "Strain"},
                                          {"off_ms", "Off, ms per direction"},
                                          {"automatic_ms", "Automatic"},
                                          {"unstable", "Directions that off leaves unstable"},
                                          {"change", "Off is off there by, median, worst, %"},
                                          {"unreached", "Not reached: off, automatic"}});
  for (const double strain : {0.1, -0.1}) {
    for (const BenchCell& cell : studied_cells(settings)) {
      EquilibriumOptions options;
      options.out_of_plane = Switch::off;
      const TimedCell automatic = run_timed(cell.weave, uniaxial(strain, directions_of(settings), options));
      options.buckling = Switch::off;
      const TimedCell off = run_timed(cell.weave, uniaxial(strain, directions_of(settings), options));
      table.row({cell.name, number(strain, 1), milliseconds(off), milliseconds(automatic),
                 std::to_string(how_many(off, unstable)),
                 median_and_worst(changes(off, automatic, [&](std::size_t i) { return unstable(off.result[i]); })),
                 std::to_string(how_many(off, unreached)) + ", " + std::to_string(how_many(automatic, unreached))});
    }
  }
  report.heading("Buckling");
  report.text(
      "`effects.buckling`: off reports the equilibrium that the path comes to, unstable or not; automatic leaves an "
      "unstable one along its least stable mode. In the plane, so that nothing else leaves it.");
  report.table(table);
}

/// The same weave without limits of sliding, in which only other crossings stop a strand.
Weave without_limits(Weave weave) {
  for (weave::Crossing& crossing : weave.crossings)
    for (weave::CrossingMember& member : crossing.members)
      member.backward = member.forward = std::numeric_limits<double>::infinity();
  return weave;
}

int effect_count(const CostLedger& cost, const std::string& name) {
  for (const CostLedger::Effect& effect : cost.effects())
    if (effect.name == name) return static_cast<int>(effect.count);
  return 0;
}

/// In fewer load steps some variants end on other equilibria (docs/notes/weaves.md).
constexpr int sliding_load_steps = 8;

struct SlidingVariant {
  std::string name;
  bool limits;
  std::optional<double> least_distance;
  double limit_tolerance;
};

void study_sliding(Report& report, const WeaveSettings& settings) {
  const EquilibriumOptions usual;
  std::vector<SlidingVariant> variants{{"as it is", true, {}, usual.limit_tolerance},
                                       {"barriers alone", true, {}, 1},
                                       {"no limits", false, {}, usual.limit_tolerance},
                                       {"no limits, no distance of crossings", false, 0, usual.limit_tolerance}};
  Table table("weaves-effects-sliding", {{"cell", "Cell"},
                                         {"variant", "Sliding"},
                                         {"ms", "ms per direction"},
                                         {"limits_percent", "Limits' terms, % of it"},
                                         {"contact_percent", "Contact's, %"},
                                         {"at_limits", "Sliders at limits"},
                                         {"in_contact", "Crossings in contact"},
                                         {"least", "Least modulus, N/m"},
                                         {"largest", "Largest"},
                                         {"change", "Modulus differs by, median, worst, %"},
                                         {"unreached", "Not reached"}});
  const std::vector<std::string> names =
      settings.brief
          ? std::vector<std::string>{"squares, type 2"}
          : std::vector<std::string>{"squares, type 2", "squares, type 3", "squares, type 4", "circles, sliding"};
  if (settings.brief) variants.resize(2);
  for (const std::string& name : names) {
    const Weave cell = cell_named(name).weave;
    TimedCell first;
    for (const SlidingVariant& variant : variants) {
      EquilibriumOptions options;
      options.least_distance = variant.least_distance;
      options.limit_tolerance = variant.limit_tolerance;
      options.load_steps = sliding_load_steps;
      TimedCell run =
          run_timed(variant.limits ? cell : without_limits(cell), uniaxial(0.3, directions_of(settings), options));
      std::vector<double> moduli;
      for (const DirectionalResponse& response : run.result)
        if (!unreached(response)) moduli.push_back(response.youngs_modulus);
      const bool is_first = first.result.empty();
      if (is_first) first = run;
      table.row(
          {name, variant.name, milliseconds(run),
           capped_percent((effect_seconds(run.cost, "sliding_limits") + effect_seconds(run.cost, "rigid_limits")) /
                          run.cpu_seconds),
           capped_percent(effect_seconds(run.cost, "crossing_contact") / run.cpu_seconds),
           std::to_string(effect_count(run.cost, "at_sliding_limits")),
           std::to_string(effect_count(run.cost, "crossings_in_contact")), number(least(moduli)),
           number(quantile(moduli, 1)), is_first ? "" : median_and_worst(changes(run, first, anywhere)),
           std::to_string(how_many(run, unreached))});
    }
  }
  report.heading("Sliding limits and contact of crossings");
  report.text(
      "Strain 0.3 in 8 load steps. Limits end how far a strand slides at a crossing; contact keeps neighbouring "
      "crossings of a strand "
      "so far apart that the strands that cross there touch, and cannot be left out altogether: without it crossings "
      "would pass through each other. Before both, barriers push back while a path is followed, from "
      "`sliding.barrier_range` on (a twentieth of the mean length of rod); sliders that are stopped are then brought "
      "to "
      "their limits, unless `accuracy.limit_tolerance` is 1. Counts are sums over the directions.");
  report.table(table);
}

struct SheetScene {
  std::string name;
  Weave weave;
  weave::SheetLoad load;
};

std::vector<SheetScene> sheet_scenes(const WeaveSettings& settings) {
  const int n = settings.brief ? 3 : 10;
  std::vector<SheetScene> scenes;
  for (const Connection connection : {Connection::fused, Connection::slides_x}) {
    LoadedSheet sheet = sheared_sheet(n, connection, Shear::diagonal, 0.1);
    scenes.push_back({std::to_string(n) + " x " + std::to_string(n) +
                          (connection == Connection::fused ? " fused, sheared" : " sliding, sheared") + " by 10 %",
                      std::move(sheet.weave), std::move(sheet.load)});
  }
  if (settings.brief) return scenes;
  SheetScene rings{"rings, pushed in by 10 mm", weave::actuated_rings(), {}};
  const auto pushed = static_cast<int>(rings.weave.strands.size()) - 1;
  const weave::StrandCurve& outer = rings.weave.strands[2].curve;
  rings.load.supports.push_back({2, 0.75 * outer.length(), {true, true, true}, {0, 0, 0}, true});
  rings.load.supports.push_back({pushed, rings.weave.strands.back().curve.length(), {true, true, true}, {0, 10, 0}});
  rings.load.states = 4;
  scenes.push_back(std::move(rings));
  return scenes;
}

void study_sheet_effects(Report& report, const WeaveSettings& settings) {
  Table table("weaves-effects-sheets", {{"sheet", "Sheet"},
                                        {"out_of_plane", "Out of the plane"},
                                        {"buckling", "Buckling"},
                                        {"cpu_s", "CPU s"},
                                        {"iterations", "Newton iterations"},
                                        {"branches", "Unstable equilibria left"},
                                        {"energy", "Energy, N mm"},
                                        {"height", "Height, mm"},
                                        {"stable", "Stable"},
                                        {"reached", "Reached"}});
  struct Variant {
    Switch out_of_plane, buckling;
    std::string plane_name, buckling_name;
  };
  const std::vector<Variant> variants{{Switch::automatic, Switch::automatic, "automatic", "automatic"},
                                      {Switch::on, Switch::automatic, "on", "automatic"},
                                      {Switch::off, Switch::automatic, "off", "automatic"},
                                      {Switch::off, Switch::off, "off", "off"}};
  for (const SheetScene& scene : sheet_scenes(settings)) {
    for (const Variant& variant : variants) {
      EquilibriumOptions options;
      options.out_of_plane = variant.out_of_plane;
      options.buckling = variant.buckling;
      const TimedSheet run = run_timed(scene.weave, scene.load, options);
      const weave::SheetState& last = run.result.states.back();
      double height = 0;
      int branches = 0;
      for (const Eigen::Vector3d& crossing : last.crossings) height = std::max(height, std::abs(crossing[2]));
      for (const weave::SheetState& state : run.result.states) branches += state.branches;
      table.row({scene.name, variant.plane_name, variant.buckling_name, number(run.cpu_seconds),
                 std::to_string(iterations_of(run.result)), std::to_string(branches), number(last.energy),
                 number(height), last.stable ? "yes" : "no",
                 converged(run.result) ? "yes" : "up to " + number(last.share)});
    }
  }
  report.heading("Sheets");
  report.text(
      "Sheets are held at three crossings of a corner, and those of the opposite corner are drawn towards it by 10 % "
      "of "
      "the side in x and in y. The energy tells what an effect changes: of equilibria that are found, the one with the "
      "least is what would be seen.");
  report.table(table);
}

}  // namespace

void study_weave_effects(const WeaveSettings& settings) {
  Report report(settings.folder, "weaves", "effects", "What effects cost and change");
  study_plane(report, settings);
  study_buckling(report, settings);
  study_sliding(report, settings);
  study_sheet_effects(report, settings);
  report.write("weave_bench effects", settings.brief,
               std::to_string(directions_of(settings)) +
                   " directions of each cell at the default accuracy, stretched or compressed by 10 % unless stated "
                   "otherwise. Times are CPU times.");
}

}  // namespace supple::bench
