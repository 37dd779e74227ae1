// Solids that carry networks: one Newton step against DOLFINx's on the same mesh, and the error of linear tetrahedra of
// a nearly incompressible material. Writes a section of hosts.md.
//
//   solid_bench [--short] [--out DIR]      default: into docs/bench
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "command_line.h"
#include "measurement.h"
#include "report.h"
#include "supple/base/cost_ledger.h"
#include "supple/base/threads.h"
#include "supple/numerics/cholesky.h"
#include "supple/numerics/minimizer.h"
#include "support/shapes.h"
#include "support/solid_scene.h"

namespace supple::bench {
namespace {

using embedded::NetworkState;
using embedded::SolidHost;
using testing::SolidScene;
using Fixed = bool (*)(const Eigen::Vector3d&);

struct SolidSettings {
  bool brief = false;
  std::filesystem::path folder = "docs/bench";
};

/// Repetitions of each side, before the other side takes its turn.
constexpr int repetitions = 3;

/// The file that dolfinx_solid_peer.py reads.
void write_case(const std::filesystem::path& path, const SolidScene& scene, const NetworkState& state,
                const SolidHost& host, Fixed fixed, int degree) {
  const double mu = host.youngs_modulus / (2 * (1 + host.poisson_ratio));
  const double lambda = 2 * mu * host.poisson_ratio / (1 - 2 * host.poisson_ratio);
  std::ofstream out(path);
  out.precision(17);
  out << scene.solid.nodes.size() << ' ' << scene.solid.tetrahedra.size() << ' ' << degree << ' ' << repetitions << '\n'
      << mu << ' ' << lambda << ' ' << host.gravity.transpose() << '\n';
  for (std::size_t i = 0; i < scene.solid.nodes.size(); ++i) {
    const Eigen::Vector3d& rest = scene.solid.nodes[i];
    out << rest.transpose() << ' ' << (state.node(static_cast<std::int32_t>(i)) - rest).transpose() << ' '
        << (fixed(rest) ? 1 : 0) << '\n';
  }
  for (const auto& [a, b, c, d] : scene.solid.tetrahedra) out << a << ' ' << b << ' ' << c << ' ' << d << '\n';
  if (!out.flush()) throw std::runtime_error("cannot write " + path.string());
}

struct PeerResult {
  struct Solver {
    std::string name;
    double assembly = 0;
    double solution = 0;
  };
  std::vector<Solver> solvers;
  std::vector<double> step;  ///< three for each node
  double energy = 0;
  double unknowns = 0;
};

/// Nothing if DOLFINx is missing or fails; the script says which on standard error.
std::optional<PeerResult> run_peer(const SolidScene& scene, const NetworkState& state, const SolidHost& host,
                                   Fixed fixed, int degree) {
  const std::filesystem::path scratch = std::filesystem::temp_directory_path();
  const std::filesystem::path case_file = scratch / "solid_bench.case";
  const std::filesystem::path result_file = scratch / "solid_bench.result";
  write_case(case_file, scene, state, host, fixed, degree);
  const std::string command = std::string("OMP_NUM_THREADS=1 /usr/bin/python3 '") + SUPPLE_BENCH_SCRIPTS +
                              "/dolfinx_solid_peer.py' '" + case_file.string() + "' '" + result_file.string() + "'";
  const int status = std::system(command.c_str());
  std::filesystem::remove(case_file);
  if (status != 0) return std::nullopt;
  PeerResult result;
  std::ifstream in(result_file);
  for (std::string word; in >> word;) {
    if (word == "solver") {
      PeerResult::Solver solver;
      in >> solver.name >> solver.assembly >> solver.solution;
      result.solvers.push_back(solver);
    } else if (word == "energy") {
      in >> result.energy >> result.unknowns;
    } else {
      for (int k = 0; k < 3; ++k) in >> result.step.emplace_back();
    }
  }
  in.close();
  std::filesystem::remove(result_file);
  return result;
}

struct Step {
  double assembly = 0;
  double solution = 0;
  double analysis = 0;        ///< additional time of the first solution
  Eigen::VectorXd direction;  ///< step of all nodes
};

/// The least times of several repetitions, which use the analysis of the pattern again.
Step our_step(const SolidScene& scene, const NetworkState& state, const SolidHost& host, Fixed fixed) {
  auto system = scene.system(host, state, fixed);
  numerics::ShiftedCholesky factorization;
  Step best;
  double first = 0;
  for (int repetition = 0; repetition <= repetitions; ++repetition) {
    numerics::Evaluation at;
    system.forget();
    const double assembly = cpu_time([&] { at = system.evaluate(2); });
    Eigen::VectorXd step;
    const double solution = cpu_time([&] {
      if (!factorization.factorize(at.hessian, 0)) throw std::runtime_error("the state is not stable");
      step = -factorization.solve(at.gradient);
    });
    if (repetition == 0) {
      first = solution;
      continue;
    }
    if (repetition == 1 || assembly < best.assembly) best.assembly = assembly;
    if (repetition == 1 || solution < best.solution) best.solution = solution;
    best.direction = system.expand(step);
  }
  best.analysis = first - best.solution;
  return best;
}

double largest_difference(const Eigen::VectorXd& ours, const std::vector<double>& theirs) {
  const Eigen::Map<const Eigen::VectorXd> other(theirs.data(), static_cast<Eigen::Index>(theirs.size()));
  if (other.size() != ours.size()) throw std::runtime_error("the peer did not give all nodes");
  return (ours - other).cwiseAbs().maxCoeff() / ours.cwiseAbs().maxCoeff();
}

struct Ball {
  int subdivisions;
  double element_size;
};

/// Returns false if the peer is missing.
bool compare_steps(const SolidSettings& settings, Report& report) {
  const std::vector<Ball> balls = settings.brief
                                      ? std::vector<Ball>{{2, 0.3}}
                                      : std::vector<Ball>{{3, 0.15}, {3, 0.1}, {3, 0.068}, {4, 0.053}, {4, 0.042}};
  const Fixed fixed = [](const Eigen::Vector3d& x) { return x[2] < -0.8; };
  SolidHost host;
  host.gravity = {0, 0, -0.5};
  Table table("solids-steps", {{"unknowns", "Unknowns"},
                               {"tetrahedra", "Tetrahedra"},
                               {"meshing_ms", "Filling, ms"},
                               {"assembly_ms", "Assembly, ms"},
                               {"solution_ms", "Factorization and solution, ms"},
                               {"analysis_ms", "Analysis, once, ms"},
                               {"solver", "DOLFINx with"},
                               {"peer_assembly_ms", "Its assembly, ms"},
                               {"peer_solution_ms", "Its solution, ms"},
                               {"ratio", "Theirs over ours"},
                               {"difference", "Steps differ by"}});
  double least_ratio = std::numeric_limits<double>::infinity();
  double least_assembly_ratio = least_ratio;
  double largest = 0;
  double assembly_fraction = 0;
  for (const Ball& ball : balls) {
    const surface::TriangleMesh mesh = testing::icosphere(ball.subdivisions);
    std::optional<SolidScene> scene;
    const double meshing =
        cpu_time([&] { scene.emplace(mesh, meshing::FillOptions{.element_size = ball.element_size}); });
    const NetworkState state = scene->state([](const Eigen::Vector3d& x) {
      return Eigen::Vector3d(x + 0.01 * Eigen::Vector3d(std::sin(2 * x[1]), std::cos(3 * x[2]), std::sin(2 * x[0])));
    });
    Step ours = our_step(*scene, state, host, fixed);
    const std::optional<PeerResult> peer = run_peer(*scene, state, host, fixed, 1);
    const Step again = our_step(*scene, state, host, fixed);
    ours.assembly = std::min(ours.assembly, again.assembly);
    ours.solution = std::min(ours.solution, again.solution);
    if (!peer) return false;
    const double difference = largest_difference(ours.direction, peer->step);
    largest = std::max(largest, difference);
    const auto unknowns = scene->system(host, state, fixed).dimension();
    if (unknowns > 15'000 && assembly_fraction == 0)
      assembly_fraction = ours.assembly / (ours.assembly + ours.solution);
    for (const PeerResult::Solver& solver : peer->solvers) {
      const double ratio = (solver.assembly + solver.solution) / (ours.assembly + ours.solution);
      least_ratio = std::min(least_ratio, ratio);
      least_assembly_ratio = std::min(least_assembly_ratio, solver.assembly / ours.assembly);
      table.row({count(static_cast<double>(unknowns)), count(static_cast<double>(scene->solid.tetrahedra.size())),
                 number(1e3 * meshing), number(1e3 * ours.assembly), number(1e3 * ours.solution),
                 number(1e3 * ours.analysis), solver.name, number(1e3 * solver.assembly), number(1e3 * solver.solution),
                 number(ratio), number(difference, 2)});
    }
  }
  report.target("DOLFINx's time over ours for assembly and solution, its fastest solver, every size", "at least 1",
                number(least_ratio), least_ratio >= 1);
  report.target("DOLFINx's time over ours for assembly alone", "at least 2", number(least_assembly_ratio),
                least_assembly_ratio >= 2);
  if (assembly_fraction > 0)
    report.target("Share of assembly in a step of about 20,000 unknowns", "at most 0.2", number(assembly_fraction),
                  assembly_fraction <= 0.2);
  report.target("Largest difference of the two steps, relative", "at most 1e-9", number(largest, 2), largest <= 1e-9);
  report.heading("One Newton step");
  report.text(
      "A unit ball, its lowest tenth fixed, slightly deformed: energy, forces and stiffness are assembled, the "
      "stiffness is "
      "factorized, the step solved for. *Analysis* is what the first factorization of a pattern takes more: a scene "
      "pays it "
      "once. Filling is what gmsh takes to make the mesh, once for a scene too.");
  report.table(table);
  return true;
}

constexpr int bar_length = 5;  ///< in widths

/// Compares the energy of a bar that is fixed at one end and bends under its weight with the peer's, and takes the time
/// of an equilibrium.
void compare_accuracy(const SolidSettings& settings, Report& report) {
  const Fixed fixed = [](const Eigen::Vector3d& x) { return x[2] == 0; };
  const auto bar = [](int n) {
    return SolidScene(testing::box({1, 1, bar_length}, {n, n, bar_length * n}), {.element_size = 1.0 / n});
  };
  const std::vector<int> sizes = settings.brief ? std::vector<int>{1, 2} : std::vector<int>{1, 2, 4, 8, 12};
  const SolidScene reference = bar(settings.brief ? 1 : 5);
  Table table("solids-accuracy", {{"poisson_ratio", "nu"},
                                  {"cells", "Edges over the width"},
                                  {"unknowns", "Unknowns"},
                                  {"gives_way", "Gives way, of what it should"},
                                  {"milliseconds", "Equilibrium, ms"},
                                  {"iterations", "Iterations"}});
  for (const double nu : {0.3, 0.45, 0.49, 0.499, 0.4999}) {
    SolidHost host;
    host.poisson_ratio = nu;
    host.gravity = {1e-6 * host.youngs_modulus, 0, 0};
    const std::optional<PeerResult> exact = run_peer(reference, reference.at_rest(), host, fixed, 2);
    if (!exact) return;
    for (const int n : sizes) {
      const SolidScene scene = bar(n);
      numerics::MinimizerResult result;
      auto system = scene.system(host, scene.at_rest(), fixed);
      const double seconds = cpu_time([&] { result = numerics::minimize(system, {.gradient_tolerance = 1e-10}); });
      if (result.stop != numerics::MinimizerTermination::converged) throw std::runtime_error("no equilibrium");
      table.row({number(nu, 4), std::to_string(n), count(static_cast<double>(system.dimension())),
                 number(result.value / exact->energy), number(1e3 * seconds), std::to_string(result.iterations)});
    }
  }
  report.heading("Accuracy, and locking near incompressibility");
  report.text(
      "A bar of 1 x 1 x 5 that is fixed at one end bends a little under its weight, across. How far it gives way under "
      "the "
      "load is what its energy at equilibrium says, as a share of that of quadratic tetrahedra of DOLFINx, 5 over the "
      "width. Linear tetrahedra are too stiff in bending, and near nu = 0.5 far too stiff: each of them has to keep "
      "its "
      "volume, which leaves too few ways to move (volumetric locking). The computation is stable at 0.4999, and "
      "converges "
      "as fast, but to the equilibrium of a body that is stiffer than asked for: there, results are to be read as "
      "shapes, "
      "not as forces.");
  report.table(table);
}

void study_solids(const SolidSettings& settings) {
  set_thread_count(1);
  Report report(settings.folder, "hosts", "solids", "Solids beside DOLFINx");
  if (compare_steps(settings, report))
    compare_accuracy(settings, report);
  else
    report.text("DOLFINx was missing or failed: nothing to compare with. It is Debian's python3-dolfinx.");
  report.write(
      "solid_bench", settings.brief,
      "Closed surfaces filled with linear neo-Hookean tetrahedra, E = 10, nu = 0.49 where nothing else is said. "
      "`tests/bench/dolfinx_solid_peer.py` is the peer: the same tetrahedra, law and load; compiled forms with "
      "`-O3 -march=native`; Cholesky of PETSc, symbolic analysis kept. The sides take turns, and each time is the "
      "least of several repetitions: CPU time of one thread.");
}

}  // namespace
}  // namespace supple::bench

int main(int argc, char** argv) {
  using namespace supple::bench;
  SolidSettings settings;
  return run_program(argc, argv, {flag("--short", settings.brief), folder_option("--out", settings.folder)},
                     {{"solids", [&] { study_solids(settings); }}});
}
