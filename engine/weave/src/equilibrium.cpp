#include "supple/weave/equilibrium.h"
#include "supple/base/faults.h"
#include "supple/weave/weave_error.h"

#include <string>
#include <vector>

namespace supple::weave {

std::string_view to_string(Stop stop) {
  switch (stop) {
    case Stop::converged:
      return "converged";
    case Stop::iteration_limit:
      return "iteration_limit";
    case Stop::step_too_small:
      return "step_too_small";
    case Stop::deadline:
      return "deadline";
    case Stop::memory:
      return "memory";
    case Stop::folded_flat:
      break;
  }
  return "folded_flat";
}

void validate(const EquilibriumOptions& options) {
  Faults faults;
  faults.require(options.segments >= 1 && options.segments <= 64, "segments", "must lie within [1, 64]");
  faults.require(options.max_segment_turn > 0 && options.max_segment_turn <= 2, "max_segment_turn",
                 "must lie within (0, 2] rad");
  faults.require(options.tolerance >= 1e-12 && options.tolerance <= 1e-1, "tolerance", "must lie within [1e-12, 0.1]");
  faults.require(options.max_iterations >= 1 && options.max_iterations <= 10'000, "max_iterations",
                 "must lie within [1, 10000]");
  faults.require(options.load_steps >= 0 && options.load_steps <= 10'000, "load_steps", "must lie within [0, 10000]");
  const auto within = [](const std::optional<double>& value, double min, double max) {
    return !value || (*value >= min && *value <= max);
  };
  faults.require(within(options.least_distance, 0, 1e3), "least_distance", "must lie within [0, 1000] mm");
  faults.require(options.limit_tolerance >= 1e-12 && options.limit_tolerance <= 1, "limit_tolerance",
                 "must lie within [1e-12, 1]");
  faults.require(within(options.barrier_range, 0, 1e3) && options.barrier_range != 0.0, "barrier_range",
                 "must lie within (0, 1000] mm");
  faults.require(within(options.sliding_regularization, 0, 1e3), "sliding_regularization",
                 "must lie within [0, 1000] N/mm");
  faults.throw_if_any<InvalidOption>("weave.invalid_option");
}

}  // namespace supple::weave
