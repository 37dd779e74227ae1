// The outer problem of inverse design by our solver and by its rivals: the same residuals, Jacobians and starts.
#include <algorithm>

#include "design_bench.h"
#include "measurement.h"
#include "outer_problems.h"
#include "report.h"

namespace supple::bench {
namespace {

/// What several runs of a solver gave.
struct Summary {
  std::vector<double> seconds;
  std::vector<double> evaluations;
  std::vector<double> jacobians;
  std::vector<std::string> outcomes;
  std::vector<double> close;  ///< 1 for runs that came close to the least, else 0

  void add(const OuterRun& run, const std::string& outcome, bool is_close) {
    close.push_back(is_close ? 1 : 0);
    seconds.push_back(run.seconds);
    evaluations.push_back(run.evaluations);
    jacobians.push_back(run.jacobians);
    outcomes.push_back(outcome);
  }
  double percent(std::string_view outcome) const {
    return 100 * static_cast<double>(std::count(outcomes.begin(), outcomes.end(), outcome)) /
           static_cast<double>(outcomes.size());
  }
};
/// Of each solver.
using Summaries = std::vector<Summary>;

/// A row for each solver of each group of problems.
class SolverTable {
 public:
  /// `branches`: whether problems with several branches are among them.
  SolverTable(const std::string& file, std::vector<Table::Column> groups, bool branches)
      : branches_(branches), table_(file, with_results(std::move(groups), branches)) {}

  void rows(const std::vector<std::string>& group, const Summaries& summaries) {
    for (std::size_t s = 0; s < summaries.size(); ++s) {
      const Summary& of = summaries[s];
      if (of.seconds.empty()) continue;
      auto cells = group;
      const auto add = [&cells](std::string cell) { cells.push_back(std::move(cell)); };
      add(count(static_cast<double>(of.seconds.size())));
      add(outer_solvers()[s].name);
      add(number(of.percent("reached")));
      add(number(100 * mean(of.close)));
      add(number(of.percent("other_minimum")));
      if (branches_) add(number(of.percent("other_branch")));
      add(number(of.percent("stalled")));
      add(number(of.percent("limit") + of.percent("gave_up")));
      add(number(1e3 * median(of.seconds)));
      add(number(1e3 * quantile(of.seconds, 0.9)));
      add(number(median(of.evaluations), 2));
      add(number(quantile(of.evaluations, 0.9), 2));
      add(number(median(of.jacobians), 2));
      table_.row(std::move(cells));
    }
  }
  const Table& table() const { return table_; }

 private:
  static std::vector<Table::Column> with_results(std::vector<Table::Column> columns, bool branches) {
    const auto add = [&columns](const char* key, const char* heading) { columns.push_back({key, heading}); };
    add("problems", "Problems");
    add("solver", "Solver");
    add("reached_percent", "Reach the least, %");
    add("close_percent", "Come close, %");
    add("other_minimum_percent", "Other minimum, %");
    if (branches) add("other_branch_percent", "Other branch, %");
    add("stalled_percent", "Stalled, %");
    add("failed_percent", "Failed, %");
    add("median_ms", "Median ms");
    add("p90_ms", "90th percentile ms");
    add("evaluations", "Residuals, median");
    add("p90_evaluations", "Residuals, 90th percentile");
    add("jacobians", "Jacobians, median");
    return columns;
  }

  bool branches_;
  Table table_;
};

/// How often ours and a rival ended lower than the other.
struct Comparison {
  int ours = 0;
  int rival = 0;
  int alike = 0;

  void add(double ours_norm, double rival_norm) {
    const double margin = reached_share * std::min(ours_norm, rival_norm) + reached_margin;
    ++(ours_norm < rival_norm - margin ? ours : rival_norm < ours_norm - margin ? rival : alike);
  }
};

constexpr const char* solvers_introduction =
    "The outer problem alone, from one random start: without the candidates and the few samples by which "
    "`find_design` begins. Targets are profiles of random designs along random directions, at strains from 0.01 to "
    "0.1 (`design`), and the same under waves of about a seventh of their size, which no design has (`perturbed`). "
    "All solvers ask the same function for residuals *r* and their exact Jacobian *J*, with equilibria to 1e-10 that "
    "start from those of the last point with a Jacobian, in parameters scaled to the unit box; |*r*| is "
    "`relative_rms`.\n\n"
    "- Ours: `numerics::minimize_least_squares`, as in `find_design`.\n"
    "- Ceres 2.1: trust regions with bounds, steps of Levenberg and Marquardt or of the traditional dogleg, dense QR,"
    " its own defaults but for where it ends.\n"
    "- L-BFGS-B 3.0, the thesis's method in the Fortran of its authors: 10 pairs, its own line search of More and "
    "Thuente (the thesis backtracks), gradient *J*^T *r*.\n\n"
    "All end where |*r*| <= 1e-9, after an accepted step that lessened |*r*| by at most 1e-9 (ours before a step that"
    " promises no more), or after 500 evaluations; the rivals' own tests are set to 1e-13. The least deviation is the"
    " smallest |*r*| of all, worked out from rest; a solver reaches it within a share of 1e-6 and a margin of 1e-7, "
    "and comes close within 0.001. The others end at another minimum (the residuals and their gradients by parameters"
    " that can move are orthogonal to 1e-3 there), on another branch (their equilibria are not those that rest leads "
    "to: the design does not do what the search saw), stalled elsewhere, or failed (500 evaluations, or an error of "
    "the solver). Where any solver left the branch, the solvers did not see the same function: these problems are in "
    "the first table alone, as `branches`. The shipped models have one or two parameters. Solvers take turns at "
    "coming first; the machine was not idle, so that gaps in time below a fifth mean little. The plot has solid lines"
    " for the least deviation and dotted ones for 0.001 above it.";

constexpr const char* solvers_reading =
    "- `inside`: a single start ends in one basin, and where a solver misses the least deviation it nearly always "
    "ended at another minimum; `find_design` follows several starts for this reason. All rivals get the least there a "
    "little more often than ours, Ceres most of all for the stiffness of designs and L-BFGS-B for perturbed Poisson's "
    "ratios. A likely reason is that ours begins with a trust region of a quarter of the bounds' widths and Ceres in "
    "effect with none: longer first steps lead out of more basins.\n"
    "- `at_bound`: Ceres models the residuals without the bounds and then projects its step, so that steps along a "
    "bound become short: it comes close, with ten times as many residuals, and stalls there. Ours minimizes its model "
    "over the box, and L-BFGS-B follows the projected gradient.\n"
    "- `branches`: under such loads a design has several equilibria, and warm starts keep to one. Dogleg steps and "
    "L-BFGS-B ended lowest more often than ours. No solver of the outer problem cures this; it is why the answer's "
    "profile is worked out from rest.\n"
    "- L-BFGS-B sees of the Jacobian the gradient alone, which takes twice as many residuals, and asks for a Jacobian "
    "with each.";

class SolverStudy {
 public:
  explicit SolverStudy(const DesignSettings& settings)
      : settings_(settings),
        problems_(settings.designs > 0 ? settings.designs
                  : settings.brief     ? 1
                                       : 10) {}

  void run() {
    auto spaces = spaces_of(settings_);
    if (settings_.brief && spaces.size() > 1) spaces.resize(1);
    for (const auto& space : spaces) {
      of_family_ = none();
      for (const auto task : all_tasks)
        for (const bool perturbed : {false, true}) measure(*space, task, perturbed);
      families_.rows({space->model.family, count(static_cast<double>(space->model.network.lower.size()))}, of_family_);
    }
    for (const auto task : all_tasks)
      for (const bool perturbed : {false, true})
        tasks_.rows({std::string(to_string(task)), kind_of(perturbed)}, of_task(task, perturbed));
    for (const auto place : all_places) places_.rows({to_string(place)}, of_place_[static_cast<std::size_t>(place)]);
    write();
  }

 private:
  static Summaries none() { return Summaries(outer_solvers().size()); }
  static std::string kind_of(bool perturbed) { return perturbed ? "perturbed" : "design"; }
  static std::size_t index_of(design::Task task, bool perturbed) {
    return 2 * static_cast<std::size_t>(task) + (perturbed ? 1 : 0);
  }
  Summaries& of_task(design::Task task, bool perturbed) { return of_task_[index_of(task, perturbed)]; }

  void measure(const LoadedSpace& space, design::Task task, bool perturbed) {
    const auto& solvers = outer_solvers();
    RandomStream random("solvers " + space.model.family, index_of(task, perturbed) + 1);
    for (int p = 0; p < problems_; ++p) {
      const auto problem = draw_problem(space, task, perturbed, random);
      std::vector<OuterRun> runs(solvers.size());
      // Each solver comes first on as many problems as any other.
      for (std::size_t k = 0; k < solvers.size(); ++k) {
        const std::size_t s = (k + static_cast<std::size_t>(p)) % solvers.size();
        runs[s] = solve(space, problem, solvers[s]);
      }
      const OuterRun& best = *std::min_element(runs.begin(), runs.end(),
                                               [](const OuterRun& a, const OuterRun& b) { return a.norm < b.norm; });
      const double limit = best.norm * (1 + reached_share) + reached_margin;
      const double close_limit = best.norm + close_margin;
      const Place place = place_of(runs, best);
      for (std::size_t s = 0; s < runs.size(); ++s) {
        const OuterRun& run = runs[s];
        const std::string outcome = outcome_of(run, limit);
        of_place_[static_cast<std::size_t>(place)][s].add(run, outcome, run.norm <= close_limit);
        if (place != Place::branches) {
          of_family_[s].add(run, outcome, run.norm <= close_limit);
          of_task(task, perturbed)[s].add(run, outcome, run.norm <= close_limit);
          all_[s].add(run, outcome, run.norm <= close_limit);
          comparisons_[s].add(runs.front().norm, run.norm);
        }
        runs_.row({space.model.family, std::string(to_string(task)), kind_of(perturbed), std::to_string(p + 1),
                   to_string(place), solvers[s].key, outcome, number(run.norm, 4), number(1e3 * run.seconds),
                   run.ms_to(limit), run.ms_to(close_limit), std::to_string(run.evaluations),
                   std::to_string(run.jacobians)});
      }
    }
  }

  void write() {
    Report report(settings_.folder, "designs-solvers", "Inverse design: the outer solver against its rivals");
    const Summary& ours = all_.front();
    for (std::size_t s = 1; s < all_.size() && !ours.seconds.empty(); ++s) {
      const Summary& rival = all_[s];
      const auto& name = outer_solvers()[s].name;
      const auto beside = [&report, &name](const std::string& what, double at_least, double measured) {
        report.target(what + ", beside " + name, "at least " + number(at_least) + " %", number(measured) + " %",
                      measured >= at_least);
      };
      beside("Problems whose least deviation is reached", rival.percent("reached"), ours.percent("reached"));
      beside("Problems where it comes close", 100 * mean(rival.close), 100 * mean(ours.close));
      const double limit = median(rival.seconds);
      report.target("Median time, beside " + name, "at most " + number(1e3 * limit) + " ms",
                    number(1e3 * median(ours.seconds)) + " ms", median(ours.seconds) <= limit);
    }
    report.image("designs-solvers.svg", "Share of problems solved over time, relative to the fastest solver");
    report.heading("By place of the best design");
    report.table(places_.table());
    report.text(solvers_reading);
    report.heading("Pairs");
    Table pairs("designs-solvers-pairs", {{"rival", "Rival"},
                                          {"ours_lower", "Ours ended lower"},
                                          {"rival_lower", "The rival ended lower"},
                                          {"alike", "Alike"}});
    for (std::size_t s = 1; s < comparisons_.size(); ++s)
      pairs.row({outer_solvers()[s].name, count(comparisons_[s].ours), count(comparisons_[s].rival),
                 count(comparisons_[s].alike)});
    report.table(pairs);
    report.heading("By task");
    report.table(tasks_.table());
    report.heading("By family");
    report.table(families_.table());
    report.data(runs_);
    report.text("Every run as [CSV](designs-solvers-runs.csv).");
    report.write(design_introduction(settings_, "solvers", solvers_introduction));
  }

  const DesignSettings& settings_;
  int problems_;
  std::vector<Summaries> of_task_ = std::vector<Summaries>(2 * std::size(all_tasks), none());
  std::vector<Summaries> of_place_ = std::vector<Summaries>(all_places.size(), none());
  Summaries of_family_;
  Summaries all_ = none();
  std::vector<Comparison> comparisons_ = std::vector<Comparison>(outer_solvers().size());
  SolverTable places_{"designs-solvers-places", {{"place", "Best design"}}, true};
  SolverTable tasks_{"designs-solvers", {{"task", "Task"}, {"target", "Target"}}, false};
  SolverTable families_{"designs-solvers-families", {{"family", "Family"}, {"parameters", "Parameters"}}, false};
  Table runs_{"designs-solvers-runs",
              {{"family", "Family"},
               {"task", "Task"},
               {"target", "Target"},
               {"problem", "Problem"},
               {"place", "Best design"},
               {"solver", "Solver"},
               {"outcome", "Outcome"},
               {"relative_rms", "Deviation"},
               {"ms", "ms"},
               {"ms_to_least", "ms to the least"},
               {"ms_to_close", "ms until close"},
               {"evaluations", "Residuals"},
               {"jacobians", "Jacobians"}}};
};

}  // namespace

void study_solvers(const DesignSettings& settings) { SolverStudy(settings).run(); }

}  // namespace supple::bench
