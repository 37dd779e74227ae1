// Random families, parameters and load paths over the full range of loads.
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <numbers>
#include <sstream>

#include "simulation_case.h"
#include "supple/base/error.h"

namespace supple::microscale {
namespace {

constexpr int seed = 1;
constexpr int states_of_a_path = 4;

/// A random load in equal steps from rest: uniaxial to a stretch from 0.7 to 1.5, or biaxial to two from 0.9 to 1.2.
Load draw_load(RandomStream& random) {
  const double direction = random.uniform(0, std::numbers::pi);
  if (random.below(2) == 0) {
    UniaxialLoad load{direction, {}};
    const double end = random.uniform(0.7, 1.5);
    for (int k = 1; k <= states_of_a_path; ++k) load.stretches.push_back(1 + (end - 1) * k / states_of_a_path);
    return load;
  }
  BiaxialLoad load{direction, {}};
  const double first = random.uniform(0.9, 1.2);
  const double second = random.uniform(0.9, 1.2);
  for (int k = 1; k <= states_of_a_path; ++k) {
    const double share = static_cast<double>(k) / states_of_a_path;
    load.stretches.emplace_back(1 + (first - 1) * share, 1 + (second - 1) * share);
  }
  return load;
}

std::string describe(const Load& load) {
  std::ostringstream text;
  if (const auto* uniaxial = std::get_if<UniaxialLoad>(&load))
    text << "uniaxial " << uniaxial->direction << " to " << uniaxial->stretches.back();
  else if (const auto* biaxial = std::get_if<BiaxialLoad>(&load))
    text << "biaxial " << biaxial->direction << " to " << biaxial->stretches.back().transpose();
  return text.str();
}

/// The request and the result of one path.
struct Outcome {
  Design design;
  Load load;
  int converged = 0;
  int contacts = 0;
  int branch = 0;
  bool sound = true;  ///< no inverted element and no intersection in any state
  std::string stopped = "converged";
};

Outcome follow_random_path(std::uint64_t path) {
  RandomStream random("random simulation paths", seed + path);
  Outcome outcome{draw_design(random), draw_load(random)};
  try {
    Simulator simulator(outcome.design.structure, hard_case_options(1));
    const SimulationResult result = simulator.run(outcome.load);
    for (const State& state : result.states) {
      if (state.stopped == Stop::converged && state.residual <= 1e-6) ++outcome.converged;
      outcome.contacts = std::max(outcome.contacts, state.contacts);
      outcome.branch = state.branch;
      outcome.stopped = to_string(state.stopped);
      outcome.sound = outcome.sound && state.smallest_jacobian > 0 && !intersects(state.deformed.value());
    }
  } catch (const Error& error) {
    outcome.stopped = error.code();
  }
  return outcome;
}

void write(std::ostream& out, const Outcome& o) {
  out << o.design.family << ',';
  for (const double p : o.design.parameters) out << p << ' ';
  out << ',' << describe(o.load) << ',' << size(o.load) << ',' << o.converged << ',' << o.contacts << ',' << o.branch
      << ',' << o.stopped << '\n';
}

// The environment variable SUPPLE_RANDOM_PATHS sets the number of paths, and SUPPLE_RANDOM_REPORT the file that lists
// them.
TEST(RandomPaths, StepsConvergeAndNoneInvertsOrIntersects) {
  const char* wanted = std::getenv("SUPPLE_RANDOM_PATHS");
  const int paths = wanted ? std::stoi(wanted) : 20;
  std::ofstream report;
  if (const char* name = std::getenv("SUPPLE_RANDOM_REPORT")) report.open(name);
  report.precision(10);
  report << "family,parameters,load,steps,converged,contacts,branch,stopped\n";
  std::cout << "seed " << seed << ", " << paths << " paths\n";
  int steps = 0;
  int converged = 0;
  for (int path = 0; path < paths; ++path) {
    const Outcome outcome = follow_random_path(path);
    steps += size(outcome.load);
    converged += outcome.converged;
    write(report, outcome);
    report.flush();
    EXPECT_TRUE(outcome.sound) << "path " << path;
    if (outcome.converged < size(outcome.load)) {
      std::cout << "path " << path << ": ";
      write(std::cout, outcome);
    }
  }
  std::cout << converged << " of " << steps << " steps converged\n";
  EXPECT_GE(converged, 0.995 * steps);
}

}  // namespace
}  // namespace supple::microscale
