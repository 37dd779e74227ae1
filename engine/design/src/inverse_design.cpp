#include "supple/design/inverse_design.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <mutex>
#include <new>
#include <utility>

#include "design_report.h"
#include "design_search.h"
#include "supple/base/best_so_far.h"
#include "supple/base/error.h"
#include "supple/base/threads.h"

namespace supple::design {
namespace {

/// Default number of starting points in each of several spaces. One space alone has more, because here the other spaces
/// are further chances.
constexpr int default_starts_per_space = 4;
/// Relative stress error that is assumed of a model without a measured error. It is larger than any measured one, so
/// that models with a known error come first.
constexpr double assumed_model_error = 1;

/// Expected deviation of the real structure. The model's error counts too, because a deviation far below it says
/// nothing about the structure.
double expected_deviation(double relative_rms, std::optional<double> model_error, double uncertainty = 0) {
  return std::hypot(relative_rms, std::max(model_error.value_or(assumed_model_error), uncertainty));
}

/// Why the searches of some spaces have no design.
struct Missing {
  std::optional<BeyondLimits> beyond_limits;
  StopReason stop = StopReason::none;  ///< stop of a search, whether it has a design or not
  std::exception_ptr stopped;          ///< stop of a search without a design

  [[noreturn]] void refuse() const {
    if (stopped) std::rethrow_exception(stopped);
    if (beyond_limits)
      throw BeyondLimits(
          "design.beyond_limits",
          "No design of any family that was tried keeps within the limits. Of the closest one of a family, this is "
          "beyond them: " +
              beyond_limits->details().front().message,
          beyond_limits->details());
    throw NoDesign("design.no_equilibrium",
                   "No design that was tried has an equilibrium at every sample of the targets.");
  }
};

/// The best design comes first.
std::vector<Design> ranked(std::vector<Design> designs) {
  const auto expected = [](const Design& design) {
    return expected_deviation(design.error.relative_rms, design.model_error, design.uncertainty);
  };
  std::stable_sort(designs.begin(), designs.end(),
                   [&](const Design& a, const Design& b) { return expected(a) < expected(b); });
  return designs;
}

}  // namespace

bool StructureLimits::any() const {
  const Range none;
  return relative_density.least > none.least || relative_density.most < none.most || cell_size.least > none.least ||
         cell_size.most < none.most;
}

std::string_view to_string(DesignTermination stop) {
  if (stop == DesignTermination::no_free_parameters) return "no_free_parameters";
  if (stop == DesignTermination::trusted) return "trusted";
  if (stop == DesignTermination::deadline) return "deadline";
  if (stop == DesignTermination::memory) return "memory";
  return numerics::to_string(static_cast<numerics::LeastSquaresTermination>(stop));
}

std::vector<Design> find_designs(std::span<const DesignSpace> spaces, const DesignProblem& problem,
                                 const DesignOptions& options, const Execution& execution, const OnProgress& progress) {
  std::vector<std::optional<Design>> found(spaces.size());
  std::vector<CostLedger> bills(spaces.size());
  std::mutex mutex;
  std::optional<double> best;
  Missing missing;
  std::size_t done = 0;
  const bool several = spaces.size() > 1;
  DesignOptions space_options = options;
  if (several && options.starts == 0) space_options.starts = default_starts_per_space;
  parallel_for(static_cast<int>(spaces.size()), [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    OnProgress report_space;
    if (progress)
      report_space = [&, i](const DesignProgress& update) {
        const std::lock_guard lock(mutex);
        const double expected =
            expected_deviation(update.error.relative_rms, neural::mean_stress_error(spaces[i].model));
        if (best && expected >= *best) return;
        best = expected;
        progress({i, update.parameters, update.orientation, update.samples, update.achieved, update.error,
                  update.iteration});
      };
    const Execution inner{execution.cancellation, several ? nullptr : execution.progress,
                          execution.cost ? &bills[i] : nullptr};
    const auto note_stop = [&](StopReason reason) {
      const std::lock_guard lock(mutex);
      missing.stop = reason;
      if (!found[i]) missing.stopped = std::current_exception();
    };
    try {
      found[i] = search_design(spaces[i], problem, space_options, inner, report_space);
      found[i]->space = i;
      if (is_stopped(found[i]->stopped)) note_stop(reason_of(found[i]->stopped));
    } catch (const BeyondLimits& refusal) {
      if (!several) throw;
      const std::lock_guard lock(mutex);
      if (!missing.beyond_limits) missing.beyond_limits = refusal;
    } catch (const NoDesign&) {
      if (!several) throw;
    } catch (const Cancelled& stop) {
      if (!keeps_best(stop.reason())) throw;
      note_stop(stop.reason());
    } catch (const std::bad_alloc&) {
      note_stop(StopReason::memory);
    }
    if (!several || !execution.progress) return;
    const std::lock_guard lock(mutex);
    execution.progress->report(static_cast<double>(++done) / static_cast<double>(spaces.size()), "optimization");
  });
  std::vector<Design> ranking;
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    if (execution.cost) execution.cost->merge(bills[i]);
    if (found[i]) ranking.push_back(std::move(*found[i]));
  }
  if (ranking.empty()) missing.refuse();
  ranking = ranked(std::move(ranking));
  if (missing.stop != StopReason::none) {
    execution.cancellation.resume(missing.stop);
    if (!is_stopped(ranking.front().stopped)) report_stop(ranking.front(), missing.stop);
  }
  return ranking;
}

}  // namespace supple::design
