// Error of stress and energy against time, for tolerances and load steps.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "measurement.h"
#include "simulation_bench.h"

namespace supple::bench {
namespace {

using microscale::SimulationOptions;
using microscale::Simulator;
using microscale::State;
using microscale::UniaxialLoad;

struct Case {
  std::string family;
  std::string load_name;
  UniaxialLoad load;
};

/// Loads along 30 degrees: moderate and large tension, and compression in which beams touch or buckle.
std::vector<Case> cases(const SimulationSettings& settings) {
  const double direction = std::numbers::pi / 6;
  std::vector<Case> all;
  for (const std::string& family : settings.families_or(
           settings.brief ? std::vector<std::string>{"IH01"} : std::vector<std::string>{"IH01", "IH21", "IH50"}))
    for (const auto& [name, stretch] :
         {std::pair("tension to 1.1", 1.1), std::pair("tension to 1.3", 1.3), std::pair("compression to 0.9", 0.9)})
      all.push_back({family, name, {direction, {stretch}}});
  return all;
}

TimedPath run_case(const Case& studied, SimulationOptions options) {
  options.mesh = data_set_options(studied.family).mesh;
  options.tangents = false;
  Simulator simulator(default_structure(studied.family), options);
  return run_timed(simulator, studied.load);
}

Table table_of(const std::string& file, const Table::Column& knob) {
  return {file,
          {{"family", "Family"},
           {"load", "Load"},
           knob,
           {"load_steps", "Load steps"},
           {"iterations", "Newton iterations"},
           {"ms", "CPU ms"},
           {"stress_percent", "Error of the stress, %"},
           {"energy_percent", "Error of the energy, %"}}};
}

/// Adds a row and returns the error of the stress, or nothing if one of the two did not arrive.
std::optional<double> add_row(Table& table, const Case& studied, const std::string& value, const TimedPath& run,
                              const TimedPath& reference) {
  const State& own = run.result.states.back();
  const State& exact = reference.result.states.back();
  std::vector<std::string> cells{studied.family,
                                 studied.load_name,
                                 value,
                                 std::to_string(own.load_steps),
                                 std::to_string(own.iterations),
                                 number(1e3 * run.cpu_seconds)};
  const bool arrived = own.stopped == microscale::Stop::converged && exact.stopped == microscale::Stop::converged;
  const double error = stress_error(own, exact);
  cells.push_back(arrived ? number(100 * error, 2) : "not reached");
  cells.push_back(arrived ? number(100 * std::abs(own.energy_density / exact.energy_density - 1), 2) : "");
  table.row(std::move(cells));
  return arrived ? std::optional(error) : std::nullopt;
}

void study_tolerance(Report& report, const SimulationSettings& settings) {
  constexpr double tightest = 1e-12;
  const std::vector<double> tolerances =
      settings.brief ? std::vector<double>{1e-3, 1e-8} : std::vector<double>{1e-2, 1e-3, 1e-4, 1e-6, 1e-8, 1e-10};
  Table table = table_of("simulations-tolerance", {"tolerance", "Tolerance"});
  double worst_of_default = 0;
  for (const Case& studied : cases(settings)) {
    const auto with = [](double tolerance) {
      SimulationOptions options;
      options.tolerance = tolerance;
      return options;
    };
    const TimedPath reference = run_case(studied, with(tightest));
    for (const double tolerance : tolerances) {
      const auto error = add_row(table, studied, number(tolerance, 1), run_case(studied, with(tolerance)), reference);
      if (error && tolerance == SimulationOptions{}.tolerance) worst_of_default = std::max(worst_of_default, *error);
    }
  }
  report.target("What the default tolerance leaves of error in a stress", "at most 0.001 %",
                number(100 * worst_of_default, 2) + " %", worst_of_default <= 1e-5);
  report.heading("Tolerance");
  report.text("The relative residual of an equilibrium (`accuracy.tolerance`), against " + number(tightest, 1) +
              ". The last Newton steps are quadratic, so that a tight tolerance costs an iteration or two.");
  report.table(table);
}

void study_load_step(Report& report, const SimulationSettings& settings) {
  constexpr double shortest = 0.002;
  const std::vector<double> steps =
      settings.brief ? std::vector<double>{0.2, 0.05} : std::vector<double>{0.4, 0.2, 0.1, 0.05, 0.02, 0.01, 0.005};
  Table table = table_of("simulations-load-step", {"load_step", "Largest load step"});
  for (const Case& studied : cases(settings)) {
    const auto with = [](double step) {
      SimulationOptions options;
      options.max_load_step = step;
      return options;
    };
    const TimedPath reference = run_case(studied, with(shortest));
    for (const double step : steps) add_row(table, studied, number(step, 1), run_case(studied, with(step)), reference);
  }
  report.heading("Load step");
  report.text(
      "The largest change of a component of the deformation gradient in one step (`accuracy.max_load_step`), "
      "against " +
      number(shortest, 1) +
      ". An equilibrium does not depend on the way to it unless there are several: an error of per cents is "
      "another equilibrium, beyond a point at which the structure buckles.");
  report.table(table);
}

}  // namespace

void study_simulation_accuracy(const SimulationSettings& settings) {
  Report report(settings.folder, "simulations", "accuracy", "Error against time: tolerance and load step");
  study_tolerance(report, settings);
  report.image("simulations-accuracy.svg", "Error of the stress against time for tolerances and load steps");
  study_load_step(report, settings);
  report.write("simulation_bench accuracy", settings.brief,
               "The structures are those of the families' default parameters, on the meshes of their data sets, from "
               "rest to one state, along 30 degrees. Errors of stresses are in the Frobenius norm.");
}

}  // namespace supple::bench
