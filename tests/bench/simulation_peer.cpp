// The same equilibria by DOLFINx, on the same mesh to the same tolerance: time and stress side by side.
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "measurement.h"
#include "simulation_bench.h"
#include "supple/microscale/unwrapped_mesh.h"

namespace supple::bench {
namespace {

using microscale::Simulator;
using microscale::State;
using microscale::Switch;

constexpr double peer_tolerance = 1e-8;

/// Options for equilibria and stress alone, without contact, unstable modes and tangents.
microscale::SimulationOptions plain_options() {
  microscale::SimulationOptions options;
  options.tolerance = peer_tolerance;
  options.contact = Switch::off;
  options.patch = Switch::off;
  options.buckling = Switch::off;
  options.tangents = false;
  return options;
}

/// One load step for each state.
microscale::BiaxialLoad load() {
  return {0.3, {{1.01, 0.998}, {1.02, 0.996}, {1.03, 0.994}, {1.04, 0.992}, {1.05, 0.99}}};
}

/// The file that dolfinx_peer.py reads.
void write_case(const std::filesystem::path& path, const tiling::PeriodicMesh& mesh, const std::vector<State>& states) {
  const microscale::UnwrappedMesh cut = microscale::unwrap(mesh);
  const Eigen::Matrix2Xd places = microscale::positions(cut, mesh.lattice, mesh.nodes);
  const microscale::Material material;
  std::ofstream out(path);
  out.precision(17);
  out << mesh.nodes.cols() << ' ' << cut.points.size() << ' ' << cut.triangles.size() << ' ' << states.size() << '\n'
      << mesh.cell_area() << ' ' << material.youngs_modulus << ' ' << material.poisson_ratio << ' ' << peer_tolerance
      << '\n';
  for (std::size_t i = 0; i < cut.points.size(); ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    out << places(0, column) << ' ' << places(1, column) << ' ' << cut.points[i].node << '\n';
  }
  for (const auto& triangle : cut.triangles) {
    for (const int point : triangle) out << point << ' ';
    out << '\n';
  }
  for (const State& state : states) {
    const Eigen::Matrix2d& f = state.deformation_gradient;
    out << f(0, 0) << ' ' << f(0, 1) << ' ' << f(1, 0) << ' ' << f(1, 1) << '\n';
  }
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

struct PeerResult {
  struct Solver {
    std::string name;
    double seconds = 0;
    int iterations = 0;
  };
  std::vector<Solver> solvers;
  std::vector<Eigen::Vector3d> stresses;
};

/// Nothing if DOLFINx is missing or fails; the script says which on standard error.
std::optional<PeerResult> run_peer(const std::filesystem::path& case_file, const std::filesystem::path& result_file) {
  const std::string command = std::string("OMP_NUM_THREADS=1 /usr/bin/python3 '") + SUPPLE_BENCH_SCRIPTS +
                              "/dolfinx_peer.py' '" + case_file.string() + "' '" + result_file.string() + "'";
  if (std::system(command.c_str()) != 0) return std::nullopt;
  PeerResult result;
  std::ifstream in(result_file);
  for (std::string word; in >> word;) {
    if (word == "solver") {
      PeerResult::Solver solver;
      in >> solver.name >> solver.seconds >> solver.iterations;
      result.solvers.push_back(solver);
    } else {
      Eigen::Vector3d stress;
      in >> stress[0] >> stress[1] >> stress[2];
      result.stresses.push_back(stress);
    }
  }
  return result;
}

/// The fastest of three runs.
TimedPath run_ours(const tiling::PeriodicMesh& mesh) {
  TimedPath best;
  best.cpu_seconds = std::numeric_limits<double>::infinity();
  Simulator simulator(mesh, plain_options());
  for (int i = 0; i < 3; ++i) {
    TimedPath path = run_timed(simulator, load());
    if (path.cpu_seconds < best.cpu_seconds) best = std::move(path);
  }
  return best;
}

double largest_difference(const std::vector<State>& ours, const std::vector<Eigen::Vector3d>& theirs) {
  if (ours.size() != theirs.size()) throw std::runtime_error("the peer did not give all states");
  double largest = 0;
  for (std::size_t i = 0; i < ours.size(); ++i)
    largest = std::max(largest, (ours[i].stress - theirs[i]).norm() / ours[i].stress.norm());
  return largest;
}

}  // namespace

void study_peer(const SimulationSettings& settings) {
  const std::vector<std::string> families =
      settings.brief ? std::vector<std::string>{"IH01"} : std::vector<std::string>{"IH01", "IH22", "IH67", "IH21"};
  Report report(settings.folder, "simulations", "peer", "Beside DOLFINx");
  Table table("simulations-peer", {{"family", "Family"},
                                   {"unknowns", "Unknowns"},
                                   {"ours_ms", "Ours, ms per state"},
                                   {"ours_iterations", "Iterations"},
                                   {"solver", "DOLFINx with"},
                                   {"peer_ms", "ms per state"},
                                   {"peer_iterations", "Iterations"},
                                   {"ratio", "Theirs over ours"},
                                   {"difference", "Stress differs by"}});
  double least_ratio = std::numeric_limits<double>::infinity(), largest = 0;
  bool missing = false;
  const std::filesystem::path scratch = std::filesystem::temp_directory_path();
  for (const std::string& family : families) {
    const tiling::PeriodicMesh mesh = tiling::mesh_structure(default_structure(family));
    TimedPath ours = run_ours(mesh);
    const std::filesystem::path case_file = scratch / ("simulation_bench-" + family + ".case");
    const std::filesystem::path result_file = scratch / ("simulation_bench-" + family + ".result");
    write_case(case_file, mesh, ours.result.states);
    const std::optional<PeerResult> peer = run_peer(case_file, result_file);
    ours.cpu_seconds = std::min(ours.cpu_seconds, run_ours(mesh).cpu_seconds);
    std::filesystem::remove(case_file);
    std::filesystem::remove(result_file);
    missing |= !peer;
    if (!peer) continue;
    const auto states = static_cast<double>(ours.result.states.size());
    int iterations = 0;
    for (const State& state : ours.result.states) iterations += state.iterations;
    const double difference = largest_difference(ours.result.states, peer->stresses);
    largest = std::max(largest, difference);
    for (const PeerResult::Solver& solver : peer->solvers) {
      const double ratio = solver.seconds / ours.cpu_seconds;
      least_ratio = std::min(least_ratio, ratio);
      table.row({family, count(ours.result.unknowns), number(1e3 * ours.cpu_seconds / states),
                 std::to_string(iterations), solver.name, number(1e3 * solver.seconds / states),
                 std::to_string(solver.iterations), number(ratio), number(difference, 2)});
    }
  }
  if (!table.empty()) {
    report.target("DOLFINx's time over ours, its fastest solver, every family", "at least 5", number(least_ratio),
                  least_ratio >= 5);
    report.target("Largest relative difference of stress", "at most 1e-6", number(largest, 2), largest <= 1e-6);
    report.table(table);
  }
  if (missing) report.text("DOLFINx was missing or failed: nothing to compare with. It is Debian's python3-dolfinx.");
  report.write(
      "simulation_bench peer", settings.brief,
      "Default designs of some families on the data sets' mesh, five states of a biaxial path to (1.05, 0.99), "
      "one load step each, until |*g*| <= 1e-8 *f* (see `SimulationOptions::tolerance`). Both sides solve for "
      "periodic displacements only and give stress; contact, checks of stability and tangents are off. "
      "`tests/bench/dolfinx_peer.py` is the peer: the same triangles, integration points and torus numbering; "
      "compiled forms with `-O3 -march=native`; Newton from the state before, symbolic analysis kept. Setting "
      "up is timed on neither side. Each time is the least of three or six runs.");
}

}  // namespace supple::bench
