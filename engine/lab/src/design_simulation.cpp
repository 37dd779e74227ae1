#include "supple/lab/design_simulation.h"

#include <algorithm>
#include <chrono>
#include <new>
#include <string>
#include <utility>

#include "supple/base/error.h"
#include "supple/lab/engine_version.h"
#include "supple/microscale/simulation.h"
#include "supple/tiling/structure.h"

namespace supple::lab {
namespace {

using Clock = std::chrono::steady_clock;
double seconds_between(Clock::time_point start, Clock::time_point end) {
  return std::chrono::duration<double>(end - start).count();
}

/// Records when the simulation begins each state of a path, from its progress reports.
class StateTimes : public ProgressSink {
 public:
  explicit StateTimes(StateListener* listener) : listener_(listener) {}

  void report(double, std::string_view stage) override {
    if (stage != "states") return;
    if (listener_ && !begins_.empty()) listener_->state_reached();
    begins_.push_back(Clock::now());
  }
  /// Seconds that state i took. The last state ends at `now`.
  double seconds(std::size_t i, Clock::time_point now) const {
    if (i >= begins_.size()) return 0;
    return seconds_between(begins_[i], i + 1 < begins_.size() ? begins_[i + 1] : now);
  }

 private:
  StateListener* listener_;
  std::vector<Clock::time_point> begins_;
};

dataset::Row row_of(const microscale::State& state) {
  dataset::Row row;
  std::copy_n(state.green_strain.data(), 3, row.green_strain.begin());
  std::copy_n(state.stress.data(), 3, row.stress.begin());
  const auto& c = state.tangent;
  row.tangent = {c(0, 0), c(0, 1), c(0, 2), c(1, 1), c(1, 2), c(2, 2)};
  row.energy_density = state.energy_density;
  row.residual = state.residual;
  row.smallest_jacobian = state.smallest_jacobian;
  row.iterations = state.iterations;
  row.branch = state.branch;
  row.contacts = state.contacts;
  row.cells = state.cells;
  row.stable = state.stable;
  return row;
}

std::vector<dataset::StageCost> costs_of(const CostLedger& ledger) {
  std::vector<dataset::StageCost> costs;
  for (const auto& stage : ledger.stages()) costs.push_back({stage.name, stage.seconds, stage.count});
  // The times of stages do not include those of effects.
  for (const auto& effect : ledger.effects())
    if (effect.seconds > 0) costs.push_back({effect.name, effect.seconds, effect.count});
  return costs;
}

/// Runs one path and appends its rows to the design.
void simulate_path(microscale::Simulator& simulator, const PlannedPath& planned, const Execution& execution,
                   StateListener* listener, dataset::Design& design) {
  dataset::Path path = planned.path;
  StateTimes times(listener);
  const Execution timed{execution.cancellation, &times, execution.cost};
  const microscale::SimulationResult result = simulator.run(planned.load(), timed);
  const auto now = Clock::now();
  if (listener) listener->state_reached();
  design.unknowns = std::max(design.unknowns, result.unknowns);
  path.stopped = "converged";
  for (std::size_t i = 0; i < result.states.size(); ++i) {
    const microscale::State& state = result.states[i];
    if (state.stopped != microscale::Stop::converged || (i + 1 == result.states.size() && !result.message.empty())) {
      path.stopped = state.stopped == microscale::Stop::converged ? "step_too_small" : to_string(state.stopped);
      break;
    }
    dataset::Row row = row_of(state);
    row.path = static_cast<std::int32_t>(design.paths.size());
    row.position = path.reached++;
    row.stretch = planned.stretches[i][0];
    row.lateral_stretch = planned.stretches[i][1];
    row.seconds = times.seconds(i, now);
    design.rows.push_back(row);
  }
  path.message = result.message;
  design.paths.push_back(std::move(path));
}

void add_failed_path(const PlannedPath& planned, const std::string& code, const std::string& message,
                     dataset::Design& design) {
  dataset::Path path = planned.path;
  path.stopped = code;
  path.message = message;
  design.paths.push_back(std::move(path));
}

/// Calls `work`. If it throws an error that concerns the design, calls `failed` with its code and message.
template <class Work, class Failed>
void run_catching_failures(Work&& work, Failed&& failed) {
  try {
    work();
  } catch (const Error& error) {
    failed(error.code(), error.what());
  } catch (const Cancelled&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& error) {
    // This is a bug. It is recorded with the design, because ending the run would lose hours of work.
    failed("dataset.unexpected_failure", error.what());
  }
}

}  // namespace

dataset::Design simulate_design(const DatasetOptions& options, const PlannedDesign& planned,
                                const CancellationToken& cancellation, StateListener* listener) {
  const auto start = Clock::now();
  dataset::Design design;
  design.index = planned.index;
  design.parameters = planned.parameters;
  design.engine = engine_version();
  CostLedger ledger;
  const Execution execution{cancellation, nullptr, &ledger};
  run_catching_failures(
      [&] {
        const auto structure = tiling::make_structure(family_of(options), planned.parameters, options.box_margin);
        microscale::Simulator simulator(structure, options.simulation, execution);
        design.nodes = static_cast<std::int32_t>(simulator.mesh().nodes.cols());
        for (const PlannedPath& path : planned.paths) {
          cancellation.throw_if_requested();
          const std::size_t rows = design.rows.size();
          run_catching_failures([&] { simulate_path(simulator, path, execution, listener, design); },
                                [&](const std::string& code, const std::string& message) {
                                  design.rows.resize(rows);
                                  add_failed_path(path, code, message, design);
                                });
        }
      },
      [&](const std::string& code, const std::string& message) {
        design.error_code = code;
        design.error_message = message;
      });
  design.costs = costs_of(ledger);
  design.seconds = seconds_between(start, Clock::now());
  return design;
}

}  // namespace supple::lab
