// An optimization that reports to be done is tested by moves of single sites, with directions and lengths of the test's
// own. They may not lower the energy by more than a stated fraction. Neither may a restart from the answer. Energies
// are those of the public function `optimize`.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "supple/base/random.h"
#include "supple/surface/moving_points.h"
#include "supple/voronoi/optimization.h"
#include "support/shapes.h"

namespace supple::voronoi {
namespace {

using surface::GeodesicSolver;
using surface::SurfacePoint;
using surface::TriangleMesh;

/// Maximum fraction by which a move of a single site, or a restart, may lower the energy.
constexpr double largest_gain = 0.02;
constexpr int sites_tried = 8;
constexpr int moves_of_a_site = 12;

TriangleMesh random_mesh(RandomStream& random) {
  switch (random.below(6)) {
    case 0:
      return testing::torus(16 + random.below(12), 8 + random.below(8));
    case 1:
      return testing::icosphere(2);
    case 2:
      return testing::genus3(2);
    case 3:
      return testing::saddle(6 + random.below(4));
    case 4:
      return testing::jittered_grid(8, 6 + random.below(4), random);
    default:
      return testing::rabbit(1);
  }
}

/// One or two objectives.
ObjectiveWeights random_weights(RandomStream& random) {
  ObjectiveWeights weights;
  double* all[] = {&weights.edge_length, &weights.planarity, &weights.regularity, &weights.centroidal,
                   &weights.equal_area};
  *all[random.below(5)] = 1;
  if (random.below(3) == 0) *all[random.below(5)] = random.uniform(0.2, 5);
  return weights;
}

std::string to_words(const ObjectiveWeights& w) {
  std::string words;
  for (const auto& [name, weight] : {std::pair("edge_length", w.edge_length),
                                     {"planarity", w.planarity},
                                     {"regularity", w.regularity},
                                     {"centroidal", w.centroidal},
                                     {"equal_area", w.equal_area}})
    if (weight > 0) words += std::string(words.empty() ? "" : ", ") + name + " " + std::to_string(weight);
  return words;
}

double energy_at(const GeodesicSolver& solver, OptimizationOptions options, const std::vector<SurfacePoint>& sites) {
  options.max_iterations = 0;
  return optimize(solver, sites, options).energy;
}

/// The largest fraction by which a move of one of some random sites lowers the energy of the answer. If the answer is
/// only a local minimum, longer moves may find a deeper one.
double gain_of_single_moves(const GeodesicSolver& solver, const OptimizationOptions& options,
                            const Optimization& answer, double longest, RandomStream& random) {
  double area = 0;
  for (const DiagramCell& cell : answer.diagram.cells) area += cell.area;
  const int count = static_cast<int>(answer.diagram.sites.size());
  const double unit = std::sqrt(area / count);
  double least = answer.energy;
  for (int k = 0; k < sites_tried * moves_of_a_site; ++k) {
    const Eigen::Index site = random.below(count);
    const double length = longest * unit * std::pow(10.0, -2 * random.uniform());
    const double angle = 2 * std::numbers::pi * random.uniform();
    Eigen::VectorXd step = Eigen::VectorXd::Zero(2 * static_cast<Eigen::Index>(count));
    step.segment<2>(2 * site) << length * std::cos(angle), length * std::sin(angle);
    surface::MovingPoints points(solver.mesh(), answer.diagram.sites);
    points.move(solver.mesh(), step);
    least = std::min(least, energy_at(solver, options, points.points()));
  }
  return answer.energy > 0 ? 1 - least / answer.energy : 0;
}

int environment_or(const char* name, int usual) {
  const char* const given = std::getenv(name);
  return given != nullptr ? std::atoi(given) : usual;
}

TEST(SingleMoves, DoNotLowerTheEnergyOfAnAnswerThatCallsItselfDone) {
  const int first = environment_or("SUPPLE_MOVES_SEED", 1);
  const int count = environment_or("SUPPLE_MOVES_COUNT", 2);
  for (int seed = first; seed < first + count; ++seed) {
    RandomStream random("single_moves_hard", static_cast<std::uint64_t>(seed));
    const GeodesicSolver solver(testing::share(random_mesh(random)));
    OptimizationOptions options;
    options.weights = random_weights(random);
    options.edge_length = 0;
    options.max_iterations = 150;
    const std::vector<SurfacePoint> sites = random_sites(solver.mesh(), 8 + random.below(25), seed);
    // The target length is given, because otherwise it would differ at each start.
    options.edge_length = statistics(solver, diagram(solver, sites)).edge_length.mean;
    const std::string scene = "seed " + std::to_string(seed) + ": " + std::to_string(solver.mesh().face_count()) +
                              " faces, " + std::to_string(sites.size()) + " sites, " + to_words(options.weights);
    std::cout << scene << std::endl;
    const Optimization answer = optimize(solver, sites, options);
    const bool is_done = answer.stopped == OptimizationTermination::step_too_small;
    const double gain = answer.stopped == OptimizationTermination::iteration_limit
                            ? 0
                            : gain_of_single_moves(solver, options, answer, is_done ? 0.3 : 0.03, random);
    const double restarted = is_done ? 1 - optimize(solver, answer.diagram.sites, options).energy / answer.energy : 0;
    std::cout << "  " << to_string(answer.stopped) << " after " << answer.iterations << " iterations and "
              << answer.site_moves.passes << " passes (" << answer.site_moves.tried << " moves) at " << answer.energy
              << " of " << answer.history.front().energy << "; a move gains " << gain << ", a restart " << restarted
              << std::endl;
    EXPECT_LE(gain, largest_gain) << scene;
    EXPECT_LE(restarted, largest_gain) << scene;
  }
}

}  // namespace
}  // namespace supple::voronoi
