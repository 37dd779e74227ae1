// Straight springs stick where geodesic ones do not (thesis fig. 3.12).
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "measurement.h"
#include "network_bench.h"
#include "supple/base/random.h"
#include "supple/base/threads.h"
#include "support/sampling.h"
#include "support/shapes.h"

namespace supple::bench {
namespace {

using embedded::Network;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// Points that come to rest within this share of the diagonal are at the same place.
constexpr double same_place = 1e-4;

/// A plane sheet folded along lines x = const into strips of width 2 and length 8, which rise and fall by each of the
/// slopes. Every geodesic of it is a straight line of the plane, so that geodesic springs have exactly one equilibrium.
TriangleMesh folded_sheet(const std::vector<double>& slopes) {
  const TriangleMesh plane = testing::flat_grid(4 * static_cast<int>(slopes.size()), 8);
  std::vector<Eigen::Vector3d> positions = plane.positions();
  for (Eigen::Vector3d& p : positions) {
    double x = 0;
    double z = 0;
    double rest = p.x();
    for (const double slope : slopes) {
      const double up = std::min(rest, 2.0);
      const double down = std::clamp(rest - 2, 0.0, 2.0);
      x += (up + down) * std::cos(slope);
      z += (up - down) * std::sin(slope);
      rest -= up + down;
    }
    p = {x, p.y(), z};
  }
  return TriangleMesh::build(std::move(positions), plane.faces());
}

/// Floor and wall at a right angle, each 4 by 8.
TriangleMesh corner_sheet() {
  const TriangleMesh plane = testing::flat_grid(8, 8);
  std::vector<Eigen::Vector3d> positions = plane.positions();
  for (Eigen::Vector3d& p : positions)
    if (p.x() > 4) p = {4, p.y(), p.x() - 4};
  return TriangleMesh::build(std::move(positions), plane.faces());
}

/// The point of a sheet that flat_grid's coordinates (x, y) name; both sheets keep its faces.
SurfacePoint sheet_point(int nx, int ny, double x, double y) {
  const TriangleMesh plane = testing::flat_grid(nx, ny);
  for (std::int32_t f = 0; f < plane.face_count(); ++f) {
    const surface::Triangle& face = plane.faces()[f];
    Eigen::Matrix3d corners;
    for (int k = 0; k < 3; ++k) corners.col(k) << plane.positions()[face[k]].head<2>(), 1;
    const Eigen::Vector3d barycentric = corners.inverse() * Eigen::Vector3d(x, y, 1);
    if (barycentric.minCoeff() > -1e-12) return surface::checked_point(plane, {FaceId{f}, barycentric});
  }
  return {};
}

struct Problem {
  std::string name;
  std::shared_ptr<const TriangleMesh> mesh;
  Network network;  ///< fixed points in place, free ones wherever
  int starts;
};

std::vector<Problem> straight_problems(const NetworkSettings& settings) {
  const int starts = settings.brief ? 4 : 64;
  std::vector<Problem> problems;
  {
    Network two;
    two.points = {sheet_point(8, 8, 1.3, 2.15), sheet_point(8, 8, 6.65, 6.2), {}};
    two.springs = {{0, 2, 0, 1}, {2, 1, 0, 1}};
    two.fixed_points = {0, 1};
    problems.push_back({"two springs, floor and wall", testing::share(corner_sheet()), two, starts});
  }
  // Low ridges between high ones: the middle between points on two high ones lies above a low one.
  constexpr double high = std::numbers::pi / 3;
  constexpr double low = std::numbers::pi / 7;
  const TriangleMesh folded = folded_sheet({high, low, high, low});
  {
    Network two;
    two.points = {sheet_point(16, 8, 1.8, 2.15), sheet_point(16, 8, 10.3, 6.2), {}};
    two.springs = {{0, 2, 0, 1}, {2, 1, 0, 1}};
    two.fixed_points = {0, 1};
    problems.push_back({"two springs, 7 folds", testing::share(folded), two, starts});
  }
  {
    // A net of 5 by 5 points whose corners are held.
    Network net;
    const auto at = [](int i, int j) { return static_cast<std::int32_t>(5 * i + j); };
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) net.points.push_back(sheet_point(16, 8, 0.7 + 3.6 * i, 0.6 + 1.7 * j));
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 5; ++j) {
        if (i > 0) net.springs.push_back({at(i - 1, j), at(i, j), 0, 1});
        if (j > 0) net.springs.push_back({at(i, j - 1), at(i, j), 0, 1});
      }
    net.fixed_points = {at(0, 0), at(0, 4), at(4, 0), at(4, 4)};
    problems.push_back({"net of 25 points, 7 folds", testing::share(folded), net, starts});
  }
  return problems;
}

double geodesic_energy(const surface::GeodesicSolver& solver, const Network& network,
                       const std::vector<SurfacePoint>& points) {
  double energy = 0;
  for (const embedded::Spring& spring : network.springs) {
    const double length =
        solver.distance(points[static_cast<std::size_t>(spring.from)], points[static_cast<std::size_t>(spring.to)]);
    energy += spring.weight * std::pow(length - spring.rest_length, 2);
  }
  return energy;
}

}  // namespace

void measure_straight_springs(Report& report, const NetworkSettings& settings) {
  report.heading("Straight springs");
  report.text(
      "Springs whose length is that of the straight segment through space (thesis fig. 3.12). The sheets are folded "
      "planes, on which zero-length geodesic springs have exactly one equilibrium, known from plane geometry. Each "
      "network starts from 64 random places of its free points, the same for both kinds; end states whose points lie "
      "within 1e-4 D of each other are one. The energy of every end state is that of geodesic springs, over the energy "
      "of the one equilibrium. Straight springs come to rest on any panel that their energy's minimum can be seen "
      "from, and "
      "stick at a fold where the surface falls away on both sides: their slope jumps there, no step descends, and the "
      "search ends with |g| far from zero (*not converged*).");
  Table table("networks-straight", {{"problem", "Problem"},
                                    {"springs", "Springs"},
                                    {"starts", "Starts"},
                                    {"converged", "Converged"},
                                    {"states", "End states"},
                                    {"least", "Least energy"},
                                    {"median", "Median"},
                                    {"largest", "Largest"},
                                    {"gradient", "Largest \\|g\\| at the end"},
                                    {"cpu_ms", "CPU ms, median"}});
  Table ends("networks-straight-ends", {{"problem", "Problem"},
                                        {"springs", "Springs"},
                                        {"start", "Start"},
                                        {"stopped", "Stopped"},
                                        {"state", "End state"},
                                        {"energy", "Geodesic energy over the equilibrium's"},
                                        {"gradient", "|g|"}});
  set_thread_count(1);
  for (const Problem& problem : straight_problems(settings)) {
    const surface::GeodesicSolver solver(problem.mesh);
    const testing::SurfaceSampler sampler(*problem.mesh);
    double equilibrium = 0;
    for (const auto length : {embedded::SpringLength::geodesic, embedded::SpringLength::euclidean}) {
      const char* name = length == embedded::SpringLength::geodesic ? "geodesic" : "straight";
      RandomStream random("network_bench", 3);
      std::vector<std::vector<Eigen::Vector3d>> states;
      std::vector<double> energies, gradients, times;
      int converged = 0;
      for (int start = 0; start < problem.starts; ++start) {
        Network network = problem.network;
        for (std::size_t i = 0; i < network.points.size(); ++i)
          if (std::ranges::find(network.fixed_points, static_cast<std::int32_t>(i)) == network.fixed_points.end())
            network.points[i] = sampler.point(random);
        embedded::RelaxationOptions options;
        options.spring_length = length;
        options.tolerance = 1e-12;
        const TimedRun run = timed_run(solver, network, options);
        const auto positions = positions_of(*problem.mesh, run.result.points);
        const double energy = geodesic_energy(solver, network, run.result.points);
        if (equilibrium == 0) equilibrium = energy;
        const auto known = std::ranges::find_if(states, [&](const auto& state) {
          return largest_distance(state, positions) < same_place * problem.mesh->diagonal();
        });
        const auto state = known - states.begin();
        if (known == states.end()) states.push_back(positions);
        converged += run.result.stopped == "converged" ? 1 : 0;
        energies.push_back(energy / equilibrium);
        gradients.push_back(run.result.gradient_norm);
        times.push_back(1e3 * run.cpu_seconds);
        ends.row({problem.name, name, std::to_string(start), run.result.stopped, std::to_string(state),
                  number(energies.back(), 8), number(gradients.back(), 3)});
      }
      table.row({problem.name, name, std::to_string(problem.starts), std::to_string(converged),
                 std::to_string(states.size()), number(least(energies), 5), number(median(energies), 5),
                 number(quantile(energies, 1), 5), number(quantile(gradients, 1), 2), number(median(times))});
      if (length == embedded::SpringLength::geodesic)
        report.target("Geodesic springs, " + problem.name, "one end state from all starts",
                      std::to_string(states.size()) + (states.size() == 1 ? " end state, " : " end states, ") +
                          std::to_string(converged) + " of " + std::to_string(problem.starts) + " converged",
                      states.size() == 1 && converged == problem.starts);
    }
  }
  report.table(table);
  report.data(ends);
  report.image("networks-straight.svg", "Energies of the end states of geodesic and straight springs");
}

}  // namespace supple::bench
