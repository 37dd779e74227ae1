// Structures, loads and bookkeeping that the studies share.
#include <cmath>
#include <sstream>
#include <stdexcept>

#include "simulation_bench.h"
#include "supple/base/error.h"
#include "supple/base/random.h"

namespace supple::bench {

double frobenius(const Eigen::Vector3d& t) { return std::sqrt(t[0] * t[0] + t[1] * t[1] + 2 * t[2] * t[2]); }

std::vector<tiling::Structure> random_structures(const std::string& family, int n) {
  RandomStream random("simulation_bench " + family, 1);
  const tiling::Family& entry = tiling::family(family);
  std::vector<tiling::Structure> structures;
  for (int attempt = 0; attempt < 100 * n && static_cast<int>(structures.size()) < n; ++attempt) {
    std::vector<double> parameters;
    for (const tiling::Parameter& p : entry.parameters) parameters.push_back(random.uniform(p.lower, p.upper));
    try {
      structures.push_back(tiling::make_structure(entry, parameters));
    } catch (const Error&) {
      continue;  // each family's bounds contain shapes that the engine refuses
    }
  }
  if (static_cast<int>(structures.size()) < n) throw std::runtime_error("too few designs of " + family);
  return structures;
}

tiling::Structure default_structure(const std::string& family) {
  const tiling::Family& entry = tiling::family(family);
  std::vector<double> parameters;
  for (const tiling::Parameter& p : entry.parameters) parameters.push_back(p.preset);
  return tiling::make_structure(entry, parameters);
}

std::string mesh_name(const tiling::MeshOptions& mesh) {
  const double inverse = std::round(1 / mesh.mesh_size);
  const bool fraction = inverse > 1 && std::abs(inverse * mesh.mesh_size - 1) < 1e-9;
  std::ostringstream name;
  if (fraction)
    name << "1/" << inverse;
  else
    name << mesh.mesh_size;
  if (mesh.corner_size == 1)
    name << ", uniform";
  else
    name << ", " << mesh.corner_size;
  return name.str();
}

const std::vector<std::string>& published_families() {
  static const std::vector<std::string> families{"IH01", "IH21", "IH22", "IH28", "IH29", "IH50", "IH67"};
  return families;
}

microscale::SimulationOptions data_set_options(const std::string& family) {
  microscale::SimulationOptions options;
  options.mesh.mesh_size = tiling::family(family).sufficient_mesh_size;
  options.tolerance = 1e-7;
  return options;
}

TimedPath run_timed(microscale::Simulator& simulator, const microscale::Load& load) {
  return billed([&](const Execution& execution) { return simulator.run(load, execution); });
}

double stress_error(const microscale::State& state, const microscale::State& reference) {
  return frobenius(state.stress - reference.stress) / frobenius(reference.stress);
}

bool before_buckling(const microscale::State& state) {
  return state.stopped == microscale::Stop::converged && state.stable && state.branch == 0 && state.cells == 1;
}

}  // namespace supple::bench
