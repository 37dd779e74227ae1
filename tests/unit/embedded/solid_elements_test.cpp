#include "solid_elements.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "first_inversion.h"
#include "supple/base/cost_ledger.h"
#include "supple/base/random.h"
#include "supple/base/threads.h"
#include "supple/numerics/minimizer.h"
#include "support/sampling.h"
#include "support/shapes.h"
#include "support/solid_scene.h"

namespace supple::embedded {
namespace {

using testing::SolidScene;

Eigen::Matrix3d random_matrix(RandomStream& random, double size) {
  return size * Eigen::Matrix3d::NullaryExpr([&] { return random.uniform(-1, 1); });
}

/// A wavy deformation that inverts no tetrahedron.
auto waves(double amplitude) {
  return [amplitude](const Eigen::Vector3d& x) {
    return Eigen::Vector3d(
        x + amplitude * Eigen::Vector3d(std::sin(2 * x[1] + 1), std::cos(3 * x[2]), std::sin(2 * x[0] - x[1])));
  };
}

numerics::EnergySum sum_at(const numerics::Term<NetworkState>& term, const NetworkState& state, int order) {
  numerics::EnergySum sum;
  sum.clear(state.dimension(), order);
  term.add(state, order, sum);
  return sum;
}

double energy_at(const numerics::Term<NetworkState>& term, const NetworkState& state) {
  return sum_at(term, state, 0).value;
}

struct Lame {
  explicit Lame(const SolidHost& solid, double youngs_modulus)
      : mu(youngs_modulus / (2 * (1 + solid.poisson_ratio))),
        lambda(2 * mu * solid.poisson_ratio / (1 - 2 * solid.poisson_ratio)) {}
  explicit Lame(const SolidHost& solid) : Lame(solid, solid.youngs_modulus) {}
  double mu;
  double lambda;
};

double solid_density(const Eigen::Matrix3d& f, const Lame& lame) {
  const double log_j = std::log(f.determinant());
  return lame.mu / 2 * (f.squaredNorm() - 3) - lame.mu * log_j + lame.lambda / 2 * log_j * log_j;
}

TEST(SolidElements, HaveTheEnergyOfTheLawWhereTheDeformationIsHomogeneous) {
  const SolidScene scene(testing::icosphere(1));
  SolidHost host;
  host.poisson_ratio = 0.4;
  const SolidElements elements(scene.solid, host);
  RandomStream random("solid_homogeneous", 1);
  int tried = 0;
  for (int trial = 0; trial < 40; ++trial) {
    const double strength = 0.05 * (1 + trial % 20);
    const Eigen::Matrix3d f = Eigen::Matrix3d::Identity() + random_matrix(random, strength);
    if (f.determinant() < 0.02) continue;
    ++tried;
    const NetworkState state = scene.state([&](const Eigen::Vector3d& x) { return Eigen::Vector3d(f * x); });
    const double expected = scene.solid.volume() * solid_density(f, Lame(host));
    EXPECT_NEAR(energy_at(elements, state), expected, 1e-12 * expected + 1e-14);
    EXPECT_NEAR(elements.volume(state), f.determinant() * scene.solid.volume(), 1e-12 * scene.solid.volume());
    EXPECT_NEAR(elements.least_volume_ratio(state), f.determinant(), 1e-10);
  }
  EXPECT_GT(tried, 15);
}

TEST(SolidElements, HaveTheDerivativesOfTheirEnergy) {
  const SolidScene scene(testing::cube(1));
  for (const double nu : {0.0, 0.3, 0.49}) {
    SolidHost host;
    host.youngs_modulus = 3;
    host.poisson_ratio = nu;
    SolidElements elements(scene.solid, host);
    for (const double amplitude : {0.0, 0.02, 0.1}) {
      const NetworkState state = scene.state(waves(amplitude));
      ASSERT_TRUE(std::isfinite(energy_at(elements, state)));
      const auto check = numerics::check_derivatives(elements, state, {.step = 2e-3});
      EXPECT_LT(check.gradient.error, 1e-8) << check.summary();
      EXPECT_LT(check.hessian.error, 1e-8) << check.summary();
    }
  }
}

TEST(SolidElements, LeaveThePointsOfANetworkAlone) {
  const SolidScene scene(testing::cube(2));
  RandomStream random("solid_points", 1);
  const std::vector<surface::SurfacePoint> points = {testing::random_point(*scene.surface, random),
                                                     testing::random_point(*scene.surface, random)};
  SolidElements elements(scene.solid, {});
  Gravity gravity(scene.solid, {1, 2, 3});
  const NetworkState state = scene.state(waves(0.05), points);
  const NetworkState alone = scene.state(waves(0.05));
  for (const numerics::Term<NetworkState>* term :
       {static_cast<numerics::Term<NetworkState>*>(&elements), static_cast<numerics::Term<NetworkState>*>(&gravity)}) {
    const Eigen::VectorXd gradient = sum_at(*term, state, 1).gradient;
    EXPECT_TRUE(gradient.head(4).isZero(0));
    EXPECT_EQ(Eigen::VectorXd(gradient.tail(gradient.size() - 4)), sum_at(*term, alone, 1).gradient);
  }
  const auto check = numerics::check_derivatives(elements, state, {.step = 2e-3});
  EXPECT_LT(std::max(check.gradient.error, check.hessian.error), 1e-8) << check.summary();
}

TEST(SolidElements, ForcesAndMomentsSumUpToZero) {
  const SolidScene scene(testing::icosphere(2));
  const SolidElements elements(scene.solid, {});
  const NetworkState state = scene.state(waves(0.1));
  const Eigen::VectorXd gradient = sum_at(elements, state, 1).gradient;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();
  Eigen::Vector3d moment = Eigen::Vector3d::Zero();
  double scale = 0;
  for (Eigen::Index i = 0; i < gradient.size(); i += 3) {
    const Eigen::Vector3d own = gradient.segment<3>(i);
    force += own;
    moment += state.nodes().segment<3>(i).cross(own);
    scale += own.norm();
  }
  ASSERT_GT(scale, 1);
  EXPECT_LT(force.norm(), 1e-14 * scale);
  EXPECT_LT(moment.norm(), 1e-13 * scale);
}

TEST(SolidElements, RigidMotionsCostNothingAndTurnForcesAlong) {
  const SolidScene scene(testing::icosphere(2));
  const SolidElements elements(scene.solid, {});
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const auto rigid = [&](const Eigen::Vector3d& x) { return Eigen::Vector3d(turn * x + Eigen::Vector3d(3, -1, 2)); };
  // The strain is the rounding of the coordinates, and the energy is proportional to its square.
  EXPECT_LT(energy_at(elements, scene.state(rigid)), 1e-24);
  EXPECT_EQ(energy_at(elements, scene.at_rest()), 0);
  const NetworkState here = scene.state(waves(0.1));
  const NetworkState there = scene.state([&](const Eigen::Vector3d& x) { return rigid(waves(0.1)(x)); });
  const double energy = energy_at(elements, here);
  EXPECT_NEAR(energy_at(elements, there), energy, 1e-13 * energy);
  const Eigen::VectorXd before = sum_at(elements, here, 1).gradient;
  const Eigen::VectorXd after = sum_at(elements, there, 1).gradient;
  for (Eigen::Index i = 0; i < before.size(); i += 3)
    EXPECT_LT((after.segment<3>(i) - turn * before.segment<3>(i)).norm(), 1e-12 * before.norm());
}

TEST(SolidElements, SmallStrainsKeepTheirDigits) {
  const SolidScene scene(testing::icosphere(1));
  SolidHost host;
  host.poisson_ratio = 0.3;
  const SolidElements elements(scene.solid, host);
  const Lame lame(host);
  RandomStream random("solid_small_strains", 1);
  const Eigen::Matrix3d gradient = random_matrix(random, 1);
  const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  const double linear =
      scene.solid.volume() * (lame.mu * strain.squaredNorm() + lame.lambda / 2 * strain.trace() * strain.trace());
  for (const double size : {1e-4, 1e-6, 1e-8}) {
    const auto place = [&](const Eigen::Vector3d& x) { return Eigen::Vector3d(x + size * gradient * x); };
    // The deviations are the next order of the law and the rounding of positions.
    EXPECT_NEAR(energy_at(elements, scene.state(place)) / (size * size * linear), 1, 5 * size + 1e-15 / size);
  }
  // The solid is rotated as well.
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1, Eigen::Vector3d(3, 2, 1).normalized()).toRotationMatrix();
  const double size = 1e-6;
  const auto place = [&](const Eigen::Vector3d& x) { return Eigen::Vector3d(turn * (x + size * gradient * x)); };
  EXPECT_NEAR(energy_at(elements, scene.state(place)) / (size * size * linear), 1, 6 * size);
}

/// The unit cube as six tetrahedra without inner nodes.
SolidScene cube_of_six() {
  SolidScene scene(testing::cube(1));
  scene.solid.nodes.resize(8);
  scene.solid.tetrahedra.clear();
  const auto node = [&](const Eigen::Vector3d& at) {
    std::int32_t found = 0;
    while (scene.solid.nodes[static_cast<std::size_t>(found)] != at) ++found;
    return found;
  };
  std::array<int, 3> axes{0, 1, 2};
  do {
    const Eigen::Vector3d a = Eigen::Vector3d::Unit(axes[0]);
    const Eigen::Vector3d b = a + Eigen::Vector3d::Unit(axes[1]);
    meshing::Tetrahedron corners{node(Eigen::Vector3d::Zero()), node(a), node(b), node(Eigen::Vector3d::Ones())};
    if (a.cross(b).dot(Eigen::Vector3d::Ones()) < 0) std::swap(corners[1], corners[2]);
    scene.solid.tetrahedra.push_back(corners);
  } while (std::ranges::next_permutation(axes).found);
  return scene;
}

TEST(SolidElements, HaveAllDigitsOfStrainsWherePlacesDo) {
  const SolidScene scene = cube_of_six();
  Eigen::Matrix3d gradient;
  gradient << 3, 1, -2, 0, -1, 4, 2, 5, 1;
  const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  for (const double nu : {0.0, 0.3, 0.4999}) {
    SolidHost host;
    host.poisson_ratio = nu;
    const SolidElements elements(scene.solid, host);
    const Lame lame(host);
    const double linear = lame.mu * strain.squaredNorm() + lame.lambda / 2 * strain.trace() * strain.trace();
    const double size = 0x1p-40;
    // Positions and displacements are multiples of powers of two, so that their sums are exact. The mean over opposite
    // displacements has no third-order term.
    const auto energy = [&](double way) {
      return energy_at(elements,
                       scene.state([&](const Eigen::Vector3d& x) { return Eigen::Vector3d(x + way * gradient * x); }));
    };
    EXPECT_NEAR((energy(size) + energy(-size)) / (2 * size * size * linear), 1, 1e-13) << nu;
  }
}

TEST(SolidElements, AnAffineMotionOfTheSurfaceIsTheInnerNodesEquilibrium) {
  const SolidScene scene(testing::icosphere(2), {.element_size = 0.25});
  ASSERT_GT(scene.solid.nodes.size(), scene.surface->positions().size() + 100);
  Eigen::Matrix3d f;
  f << 1.3, 0.2, 0, -0.1, 0.9, 0.1, 0, 0.15, 1.1;
  const auto affine = [&](const Eigen::Vector3d& x) { return Eigen::Vector3d(f * x); };
  const auto on_surface = [](const Eigen::Vector3d& x) { return x.norm() > 0.999; };
  // Inner nodes start elsewhere.
  RandomStream random("solid_patch", 1);
  const NetworkState start = scene.state([&](const Eigen::Vector3d& x) {
    const double away = on_surface(x) ? 0 : 0.02;
    return Eigen::Vector3d(affine(x) + away * Eigen::Vector3d::NullaryExpr([&] { return random.uniform(-1, 1); }));
  });
  for (const double nu : {0.3, 0.499}) {
    SolidHost host;
    host.poisson_ratio = nu;
    auto system = scene.system(host, start, on_surface);
    const auto result = numerics::minimize(system, {.gradient_tolerance = 1e-10});
    EXPECT_EQ(result.stop, numerics::MinimizerTermination::converged);
    const Eigen::VectorXd wanted = scene.state(affine).nodes();
    EXPECT_LT((system.state().nodes() - wanted).cwiseAbs().maxCoeff(), 1e-10) << nu;
    EXPECT_NEAR(result.value, scene.solid.volume() * solid_density(f, Lame(host)), 1e-10 * result.value);
  }
}

TEST(SolidElements, OfSeveralRegionsTheLastCounts) {
  const SolidScene scene(testing::cube(4));
  SolidHost host;
  host.youngs_modulus = 2;
  host.regions = {{{0, 0, 0}, {1, 1, 0.5}, 10}, {{0, 0, 0}, {0.5, 1, 1}, 300}, {{5, 5, 5}, {6, 6, 6}, 1e6}};
  const Eigen::Matrix3d f = Eigen::Vector3d(1.1, 0.95, 1.05).asDiagonal();
  double expected = 0;
  for (const auto& [a, b, c, d] : scene.solid.tetrahedra) {
    const auto at = [&](std::int32_t node) { return scene.solid.nodes[static_cast<std::size_t>(node)]; };
    const Eigen::Vector3d center = (at(a) + at(b) + at(c) + at(d)) / 4;
    const double modulus = center[0] <= 0.5 ? 300 : center[2] <= 0.5 ? 10 : 2;
    expected += meshing::tetrahedron_volume(at(a), at(b), at(c), at(d)) * solid_density(f, Lame(host, modulus));
  }
  const NetworkState state = scene.state([&](const Eigen::Vector3d& x) { return Eigen::Vector3d(f * x); });
  EXPECT_NEAR(energy_at(SolidElements(scene.solid, host), state), expected, 1e-12 * expected);
}

TEST(SolidElements, StepsEndBeforeTheFirstTetrahedronIsTurnedInsideOut) {
  const SolidScene scene(testing::icosphere(2));
  const SolidElements elements(scene.solid, {});
  const NetworkState start = scene.state(waves(0.05));
  RandomStream random("solid_steps", 1);
  for (int trial = 0; trial < 20; ++trial) {
    const Eigen::VectorXd step = Eigen::VectorXd::NullaryExpr(start.dimension(), [&] { return random.normal(); });
    const double t = elements.largest_step(start, step);
    ASSERT_TRUE(std::isfinite(t));
    const auto ratio = [&](double share) {
      NetworkState moved = start;
      moved.move(share * t * step);
      return elements.least_volume_ratio(moved);
    };
    for (const double share : {0.25, 0.5, 0.75, 1.0, 1.11}) EXPECT_GT(ratio(share), 0) << share;
    EXPECT_LT(ratio(1 / 0.9 + 1e-3), 0);
  }
  // Rigid translations and growth have no largest step.
  const Eigen::VectorXd along = Eigen::VectorXd::Ones(start.dimension());
  EXPECT_EQ(elements.largest_step(start, along), std::numeric_limits<double>::infinity());
  EXPECT_EQ(elements.largest_step(scene.at_rest(), scene.at_rest().nodes()), std::numeric_limits<double>::infinity());
  EXPECT_NEAR(elements.largest_step(scene.at_rest(), -2 * scene.at_rest().nodes()), 0.45, 1e-4);
}

TEST(SolidElements, ATetrahedronThatIsTurnedInsideOutHasNoEnergy) {
  const SolidScene scene(testing::icosphere(1));
  const SolidElements elements(scene.solid, {});
  const Eigen::Matrix3d mirror = Eigen::Vector3d(1, 1, -1).asDiagonal();
  const NetworkState state = scene.state([&](const Eigen::Vector3d& x) { return Eigen::Vector3d(mirror * x); });
  EXPECT_EQ(energy_at(elements, state), std::numeric_limits<double>::infinity());
  EXPECT_EQ(sum_at(elements, state, 2).value, std::numeric_limits<double>::infinity());
  EXPECT_EQ(elements.largest_step(state, Eigen::VectorXd::Ones(state.dimension())), 0);
  meshing::TetrahedralMesh flat = scene.solid;
  std::swap(flat.tetrahedra[0][0], flat.tetrahedra[0][1]);
  EXPECT_THROW(SolidElements(flat, {}), std::invalid_argument);
}

TEST(SolidElements, AreSummedUpToTheSameBitsByAnyNumberOfThreads) {
  const SolidScene scene(testing::icosphere(3));
  const SolidElements elements(scene.solid, {});
  const NetworkState state = scene.state(waves(0.05));
  set_thread_count(1);
  const numerics::EnergySum alone = sum_at(elements, state, 2);
  set_thread_count(4);
  const numerics::EnergySum together = sum_at(elements, state, 2);
  set_thread_count(0);
  EXPECT_EQ(alone.value, together.value);
  EXPECT_EQ(alone.gradient, together.gradient);
}

TEST(SolidElements, AreOnTheBill) {
  const SolidScene scene(testing::icosphere(1));
  SolidHost host;
  host.gravity = {0, 0, -1};
  CostLedger ledger;
  numerics::System<NetworkState> system(
      scene.at_rest(),
      {std::make_shared<SolidElements>(scene.solid, host), std::make_shared<Gravity>(scene.solid, host.gravity)},
      numerics::Unknowns(scene.at_rest().dimension()), {.execution = {.cost = &ledger}});
  system.evaluate(2);
  std::vector<std::string> names;
  for (const auto& effect : ledger.effects()) names.push_back(effect.name);
  EXPECT_EQ(names, (std::vector<std::string>{"solid", "gravity"}));
}

TEST(FirstInversion, IsTheFirstRootOfTheVolume) {
  RandomStream random("first_inversion", 1);
  int found = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const Eigen::Matrix3d edges = Eigen::Matrix3d::Identity() + random_matrix(random, 0.5);
    if (edges.determinant() < 0.1) continue;
    const Eigen::Matrix3d change = random_matrix(random, trial % 2 == 0 ? 1 : 0.1);
    const double root = first_inversion(edges, change);
    const auto volume = [&](double t) { return (edges + t * change).determinant() / edges.determinant(); };
    const double end = std::min(root, 50.0);
    for (int k = 0; k < 200; ++k) EXPECT_GT(volume(0.999999 * end * k / 200), 0) << trial;
    if (root > 50) continue;
    ++found;
    EXPECT_NEAR(volume(root), 0, 1e-9) << trial;
    EXPECT_EQ(first_inversion(edges, change, 0.99 * root), std::numeric_limits<double>::infinity());
    EXPECT_NEAR(first_inversion(edges, change, 1.01 * root), root, 1e-10 * root);
    EXPECT_NEAR(first_inversion(edges, 1e-9 * change), 1e9 * root, root);
  }
  EXPECT_GT(found, 500);
}

TEST(FirstInversion, FindsRootsOfEvenOrderAndNoneWhereThereIsNone) {
  const Eigen::Matrix3d one = Eigen::Matrix3d::Identity();
  constexpr double never = std::numeric_limits<double>::infinity();
  const auto diagonal = [](double a, double b, double c) {
    return Eigen::Matrix3d(Eigen::Vector3d(a, b, c).asDiagonal());
  };
  EXPECT_NEAR(first_inversion(one, diagonal(-1, 0, 0)), 1, 1e-11);
  // (1 - t)^2 touches zero without changing sign. A rounding error of 1e-12 in its value moves the root by 1e-6.
  EXPECT_NEAR(first_inversion(one, diagonal(-1, -1, 0)), 1, 2e-6);
  EXPECT_NEAR(first_inversion(one, diagonal(-1, -1, -1)), 1, 2e-4);
  EXPECT_NEAR(first_inversion(one, diagonal(-1, -1, 5)), 1, 2e-6);
  // The same in random coordinates: rounding alone decides the sign of the least volume.
  RandomStream random("double_roots", 1);
  for (int trial = 0; trial < 100; ++trial) {
    const Eigen::Matrix3d left = random_matrix(random, 1);
    const Eigen::Matrix3d right = left.determinant() > 0 ? one : diagonal(-1, 1, 1);
    EXPECT_NEAR(first_inversion(left * right, left * diagonal(-1, -1, 0.5) * right), 1, 1e-5) << trial;
  }
  EXPECT_EQ(first_inversion(one, diagonal(1, 2, 0)), never);
  EXPECT_EQ(first_inversion(one, Eigen::Matrix3d::Zero()), never);
  EXPECT_EQ(first_inversion(diagonal(1, 1, -1), one), 0);
  EXPECT_EQ(first_inversion(diagonal(1, 1, 0), one), 0);
  // A rotation along a straight line: the volume is 1 + t^2.
  Eigen::Matrix3d spin = Eigen::Matrix3d::Zero();
  spin(0, 1) = -1;
  spin(1, 0) = 1;
  EXPECT_EQ(first_inversion(one, spin), never);
}

TEST(Gravity, PullsEveryVolumeAlike) {
  const SolidScene scene(testing::icosphere(2));
  const Eigen::Vector3d force(1, -2, 0.5);
  Gravity gravity(scene.solid, force);
  const Eigen::Vector3d way(0.3, 0.2, 0.1);
  const NetworkState moved = scene.state([&](const Eigen::Vector3d& x) { return Eigen::Vector3d(x + way); });
  EXPECT_NEAR(energy_at(gravity, moved), -scene.solid.volume() * force.dot(way), 1e-12);
  EXPECT_EQ(energy_at(gravity, scene.at_rest()), 0);
  // The derivatives agree with finite differences.
  const SolidScene small(testing::cube(1));
  Gravity pull(small.solid, force);
  const auto check = numerics::check_derivatives(pull, small.at_rest());
  EXPECT_LT(std::max(check.gradient.error, check.hessian.error), 1e-9) << check.summary();
  EXPECT_FALSE(Gravity(scene.solid, Eigen::Vector3d::Zero()).active());
  EXPECT_TRUE(gravity.active());
}

TEST(Gravity, ABarStretchesUnderItsOwnWeightAsMuchAsItsTheorySays) {
  // With nu = 0 each cross section keeps its shape, and the energy is that of the rod, -g^2 A L^3 / 6 E.
  SolidHost host;
  host.youngs_modulus = 50;
  host.poisson_ratio = 0;
  host.gravity = {0, 0, -1e-4};
  constexpr double length = 4;
  const double exact = -1e-8 * length * length * length / (6 * host.youngs_modulus);
  std::vector<double> errors;
  for (const int n : {2, 4, 8}) {
    const SolidScene scene(testing::box({1, 1, length}, {n, n, 4 * n}), {.element_size = 1.0 / n});
    auto system = scene.system(host, scene.at_rest(), [](const Eigen::Vector3d& x) { return x[2] > length - 1e-9; });
    const auto result = numerics::minimize(system, {.gradient_tolerance = 1e-12});
    EXPECT_EQ(result.stop, numerics::MinimizerTermination::converged);
    EXPECT_LE(result.iterations, 3);
    errors.push_back(1 - result.value / exact);
    // The lower end sinks by g L^2 / 2 E.
    double sinks = 0;
    int count = 0;
    for (std::size_t i = 0; i < scene.solid.nodes.size(); ++i) {
      if (scene.solid.nodes[i][2] > 1e-9) continue;
      sinks -= system.state().nodes()[3 * static_cast<Eigen::Index>(i) + 2];
      ++count;
    }
    EXPECT_NEAR(sinks / count / (1e-4 * length * length / (2 * host.youngs_modulus)), 1, 0.3 * errors.back()) << n;
  }
  // The error is of second order in the element size, as far as unstructured meshes can show it.
  EXPECT_LT(errors.back(), 5e-4);
  EXPECT_GT(errors.back(), 0);
  EXPECT_GT(errors.front() / errors.back(), 10);
}

TEST(SolidElements, HaveAConvexMatrixThatDiffersFromTheHessianWhereTheSolidIsCompressedOnly) {
  const SolidScene scene(testing::cube(1));
  SolidHost host;
  host.poisson_ratio = 0.4;
  const SolidElements elements(scene.solid, host);
  const auto matrix_at = [&](const NetworkState& state, bool convex) -> Eigen::MatrixXd {
    numerics::EnergySum sum;
    sum.clear(state.dimension(), 2);
    sum.convex = convex;
    elements.add(state, 2, sum);
    return sum.hessian.matrix(state.dimension());
  };
  RandomStream random("solid_convex", 1);
  for (const double scale : {1.05, 0.6}) {
    for (int trial = 0; trial < 5; ++trial) {
      const Eigen::Matrix3d f = scale * Eigen::Matrix3d::Identity() + random_matrix(random, 0.02);
      const NetworkState state = scene.state([&](const Eigen::Vector3d& x) { return Eigen::Vector3d(f * x); });
      const Eigen::MatrixXd exact = matrix_at(state, false);
      const Eigen::MatrixXd convex = matrix_at(state, true);
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> modes(convex);
      EXPECT_GT(modes.eigenvalues()[0], -1e-12 * exact.norm());
      // In every direction the convex matrix is at least the Hessian.
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> added(convex - exact);
      EXPECT_GT(added.eigenvalues()[0], -1e-12 * exact.norm());
      if (scale > 1) {
        EXPECT_LT((convex - exact).norm(), 1e-12 * exact.norm());
      } else {
        EXPECT_GT((convex - exact).norm(), 1e-2 * exact.norm());
      }
    }
  }
}

}  // namespace
}  // namespace supple::embedded
