// Solids with extreme elements, steps or material constants. Each case is minimized to equilibrium.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "supple/base/random.h"
#include "supple/numerics/minimizer.h"
#include "support/shapes.h"
#include "support/solid_scene.h"

namespace supple::embedded {
namespace {

using testing::SolidScene;

/// Loads far beyond the modulus and rotating stiff parts take about a hundred iterations. Steps are short if many
/// tetrahedra are close to inversion, or if a straight step would stretch what only rotates.
constexpr int max_solid_iterations = 150;

bool below(const Eigen::Vector3d& x, double height) { return x[2] <= height; }

struct Equilibrium {
  numerics::MinimizerResult result;
  double tolerance = 0;
};
Equilibrium equilibrium(numerics::System<NetworkState>& system, double tolerance) {
  numerics::MinimizerOptions options;
  options.gradient_tolerance = tolerance;
  options.max_iterations = max_solid_iterations;
  return {numerics::minimize(system, options), tolerance};
}

void expect_sound(const SolidScene& scene, const SolidHost& host, numerics::System<NetworkState>& system,
                  const Equilibrium& found) {
  EXPECT_EQ(found.result.stop, numerics::MinimizerTermination::converged)
      << "gradient " << found.result.gradient_norm << " after " << found.result.iterations << " iterations";
  EXPECT_LE(found.result.gradient_norm, found.tolerance);
  EXPECT_GT(SolidElements(scene.solid, host).least_volume_ratio(system.state()), 0);
  EXPECT_TRUE(system.state().nodes().allFinite());
}

double sag(const NetworkState& state, const SolidScene& scene) {
  double least = 0;
  for (std::size_t i = 0; i < scene.solid.nodes.size(); ++i)
    least = std::min(least, state.nodes()[3 * static_cast<Eigen::Index>(i) + 2] - scene.solid.nodes[i][2]);
  return -least;
}

TEST(HardSolid, NearlyIncompressibleKeepsItsVolumeUnderALargeLoad) {
  // lambda is 1,667 mu. The Hessian's condition number grows by this factor, and so does an error in log J.
  const SolidScene scene(testing::icosphere(2), {.element_size = 0.25});
  SolidHost host;
  host.poisson_ratio = 0.4999;
  host.gravity = {0, 0, -3};
  auto system = scene.system(host, scene.at_rest(), [](const Eigen::Vector3d& x) { return below(x, -0.8); });
  const Equilibrium found = equilibrium(system, 1e-9);
  expect_sound(scene, host, system, found);
  EXPECT_GT(sag(system.state(), scene), 0.02);
  EXPECT_NEAR(SolidElements(scene.solid, host).volume(system.state()) / scene.solid.volume(), 1, 2e-4);
}

TEST(HardSolid, TheEquilibriumIsTheSameToAllDigitsOnTheWayToIncompressible) {
  // A search from the previous equilibrium and one from rest find the same state.
  const SolidScene scene(testing::icosphere(2), {.element_size = 0.3});
  const auto held = [](const Eigen::Vector3d& x) { return below(x, -0.8); };
  SolidHost host;
  host.gravity = {0.5, 0, -2};
  NetworkState state = scene.at_rest();
  for (const double nu : {0.45, 0.49, 0.499, 0.4999}) {
    host.poisson_ratio = nu;
    auto onward = scene.system(host, state, held);
    expect_sound(scene, host, onward, equilibrium(onward, 1e-10));
    auto from_rest = scene.system(host, scene.at_rest(), held);
    expect_sound(scene, host, from_rest, equilibrium(from_rest, 1e-10));
    EXPECT_LT((onward.state().nodes() - from_rest.state().nodes()).cwiseAbs().maxCoeff(), 1e-8) << nu;
    state = onward.state();
  }
}

TEST(HardSolid, SliversOnTheSurfaceStayAndMakeSliversInside) {
  // Triangles of aspect ratio above 1,000 are faces of tetrahedra that are as flat, and stiffnesses differ by as much.
  const surface::TriangleMesh mesh = testing::sliver_sphere(24, 8, 1e-3);
  const SolidScene scene(mesh);
  for (const double nu : {0.3, 0.49}) {
    SolidHost host;
    host.poisson_ratio = nu;
    host.gravity = {0, 0, -1};
    auto system = scene.system(host, scene.at_rest(), [](const Eigen::Vector3d& x) { return below(x, -0.7); });
    const Equilibrium found = equilibrium(system, 1e-9);
    expect_sound(scene, host, system, found);
    EXPECT_GT(sag(system.state(), scene), 0.01) << nu;
  }
}

TEST(HardSolid, AGravityThatFlattensTheSolidTurnsNothingInsideOut) {
  // The weight is a hundred times the modulus over the solid's height, which leaves a thin layer on the ground.
  const SolidScene scene(testing::icosphere(2), {.element_size = 0.3});
  const auto held = [](const Eigen::Vector3d& x) { return below(x, -0.7); };
  for (const double weight : {10.0, 100.0, 1000.0}) {
    SolidHost host;
    host.poisson_ratio = 0.3;
    host.gravity = {0, 0, weight};
    auto system = scene.system(host, scene.at_rest(), held);
    const Equilibrium pulled = equilibrium(system, 1e-9 * weight);
    expect_sound(scene, host, system, pulled);
    EXPECT_LT(sag(system.state(), scene), 1e-9);
  }
  for (const double weight : {10.0, 30.0, 100.0}) {
    SolidHost host;
    host.poisson_ratio = 0.3;
    host.gravity = {0, 0, -weight};
    auto system = scene.system(host, scene.at_rest(), held);
    const Equilibrium pressed = equilibrium(system, 1e-9 * weight);
    expect_sound(scene, host, system, pressed);
    EXPECT_GT(sag(system.state(), scene), 0.1);
  }
}

TEST(HardSolid, AStartWithTetrahedraNearlyFlatUnfolds) {
  // Every inner node is within 1e-5 of an edge of a place where it would invert a tetrahedron. This distance is shorter
  // than Newton's first steps, which largest_step and the line search reduce.
  const SolidScene scene(testing::icosphere(2), {.element_size = 0.3});
  const auto on_surface = [](const Eigen::Vector3d& x) { return x.norm() > 0.97; };
  SolidHost host;
  host.poisson_ratio = 0.45;
  const SolidElements elements(scene.solid, host);
  RandomStream random("nearly_flat", 1);
  for (int trial = 0; trial < 3; ++trial) {
    const NetworkState rest = scene.at_rest();
    Eigen::VectorXd away = Eigen::VectorXd::Zero(rest.dimension());
    for (std::size_t i = 0; i < scene.solid.nodes.size(); ++i)
      if (!on_surface(scene.solid.nodes[i]))
        for (Eigen::Index k = 0; k < 3; ++k) away[3 * static_cast<Eigen::Index>(i) + k] = random.normal();
    NetworkState start = rest;
    start.move((1 - 1e-5) * elements.largest_step(rest, away) / 0.9 * away);
    ASSERT_GT(elements.least_volume_ratio(start), 0);
    ASSERT_LT(elements.least_volume_ratio(start), 1e-3);
    auto system = scene.system(host, start, on_surface);
    const Equilibrium found = equilibrium(system, 1e-10);
    expect_sound(scene, host, system, found);
    EXPECT_LT((system.state().nodes() - rest.nodes()).cwiseAbs().maxCoeff(), 1e-8) << "trial " << trial;
  }
}

TEST(HardSolid, TrialStepsThatTurnTetrahedraInsideOutAreCut) {
  // One step pushes the upper half of the surface through the lower half: a full Newton step would invert many
  // tetrahedra.
  const SolidScene scene(testing::icosphere(2), {.element_size = 0.3});
  SolidHost host;
  host.poisson_ratio = 0.4;
  host.gravity = {0, 0, -60};
  const SolidElements elements(scene.solid, host);
  auto system = scene.system(host, scene.at_rest(), [](const Eigen::Vector3d& x) { return below(x, -0.7); });
  system.evaluate(2);
  Eigen::VectorXd down = Eigen::VectorXd::Zero(scene.at_rest().dimension());
  for (std::size_t i = 0; i < scene.solid.nodes.size(); ++i)
    if (scene.solid.nodes[i][2] > 0) down[3 * static_cast<Eigen::Index>(i) + 2] = -2;
  NetworkState through = scene.at_rest();
  through.move(down);
  EXPECT_LT(elements.least_volume_ratio(through), 0);
  EXPECT_LT(elements.largest_step(scene.at_rest(), down), 1);
  const Equilibrium found = equilibrium(system, 1e-8);
  expect_sound(scene, host, system, found);
}

TEST(HardSolid, RegionsOfAHundredAndAMillionTimesTheStiffnessMoveAsOne) {
  const SolidScene scene(testing::icosphere(2), {.element_size = 0.25});
  const auto& nodes = scene.solid.nodes;
  for (const auto& [stiffness, weight] : {std::pair(1e3, 1.0), std::pair(1e7, 0.1)}) {
    SolidHost host;
    host.poisson_ratio = 0.45;
    host.gravity = {weight, 0, -weight};
    host.regions = {{{-2, -2, 0.3}, {2, 2, 2}, stiffness}};
    auto system = scene.system(host, scene.at_rest(), [](const Eigen::Vector3d& x) { return below(x, -0.8); });
    const Equilibrium found = equilibrium(system, 1e-8);
    expect_sound(scene, host, system, found);
    // The distances between nodes well inside the stiff part change no more than the load strains it.
    double worst = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        if (nodes[i][2] < 0.6 || nodes[j][2] < 0.6) continue;
        const auto at = [&](std::size_t k) { return system.state().node(static_cast<std::int32_t>(k)); };
        worst = std::max(worst, std::abs((at(i) - at(j)).norm() - (nodes[i] - nodes[j]).norm()));
      }
    EXPECT_LT(worst, 2 * weight / stiffness);
    EXPECT_GT((system.state().nodes() - scene.at_rest().nodes()).cwiseAbs().maxCoeff(), 0.5 * weight);
  }
}

}  // namespace
}  // namespace supple::embedded
