#include "supple/microscale/simulation.h"

namespace supple::microscale {

std::string_view to_string(Law law) { return law == Law::neo_hookean ? "neo_hookean" : "incompressible_plane_stress"; }

std::string_view to_string(Stop stop) {
  switch (stop) {
    case Stop::converged:
      return "converged";
    case Stop::iteration_limit:
      return "iteration_limit";
    case Stop::step_too_small:
      break;
  }
  return "step_too_small";
}

}  // namespace supple::microscale
