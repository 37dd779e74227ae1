#include "supple/microscale/simulation.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "supple/base/threads.h"
#include "supple/microscale/simulation_error.h"
#include "supple/tiling/family.h"
#include "supple/tiling/structure.h"
#include "support/drawn_meshes.h"
#include "support/expect_error.h"

namespace supple::microscale {
namespace {

using supple::testing::expect_cancelled;
using supple::testing::expect_error;
using supple::testing::places;
using testing::draw;
using testing::equal;

Eigen::Matrix2d tensor(const Eigen::Vector3d& c) { return (Eigen::Matrix2d() << c[0], c[2], c[2], c[1]).finished(); }
Eigen::Vector3d components(const Eigen::Matrix2d& t) { return {t(0, 0), t(1, 1), t(0, 1)}; }

tiling::PeriodicMesh solid_cell() {
  const Eigen::Matrix2d skew = (Eigen::Matrix2d() << 1.1, 0.3, -0.1, 0.9).finished();
  tiling::PeriodicMesh mesh =
      draw({"####", "####", "####", "####"}, {0.3, 0.2, 0.3, 0.2}, {0.25, 0.3, 0.2, 0.25}, skew);
  return mesh;
}

/// A skew frame around one hole.
tiling::PeriodicMesh stiff_frame() {
  const Eigen::Matrix2d skew = (Eigen::Matrix2d() << 1, 0.2, 0, 0.9).finished();
  return draw({"######", "##..##", "##..##", "######"}, equal(6, 1.0 / 6), equal(4, 0.25), skew);
}

/// Slender crossing beams, which buckle under compression with a period of two cells.
tiling::PeriodicMesh lattice() {
  const std::vector<double> widths = {0.06, 0.06, 0.11, 0.11, 0.11, 0.11, 0.11, 0.11, 0.11, 0.11};
  testing::Drawing drawing(8, "##........");
  drawing.insert(drawing.end(), 2, "##########");
  return draw(drawing, widths, widths);
}

/// The law's second Piola-Kirchhoff stress, computed from C alone.
Eigen::Matrix2d analytic_stress(const Material& material, const Eigen::Matrix2d& c) {
  const Eigen::Matrix2d inverse = c.inverse();
  const double j = std::sqrt(c.determinant());
  if (material.law == Law::incompressible_plane_stress)
    return material.youngs_modulus / 3 * (Eigen::Matrix2d::Identity() - inverse / (j * j));
  const double mu = material.youngs_modulus / (2 * (1 + material.poisson_ratio));
  const double lambda = 2 * mu * material.poisson_ratio / (1 - 2 * material.poisson_ratio);
  return mu * (Eigen::Matrix2d::Identity() - inverse) + lambda * std::log(j) * inverse;
}

TEST(Simulator, GivesASolidCellTheMaterialsOwnLaw) {
  for (const Law law : {Law::neo_hookean, Law::incompressible_plane_stress}) {
    SimulationOptions options;
    options.material.law = law;
    Simulator simulator(solid_cell(), options);
    const GreenStrainLoad load{{{0.01, 0.02, -0.01}, {0.3, -0.1, 0.1}, {-0.2, 0.25, -0.15}}};
    const SimulationResult result = simulator.run(load);
    ASSERT_EQ(result.states.size(), load.strains.size()) << result.message;
    for (std::size_t i = 0; i < load.strains.size(); ++i) {
      const State& state = result.states[i];
      const auto stress = [&](const Eigen::Vector3d& strain) {
        return components(analytic_stress(options.material, Eigen::Matrix2d::Identity() + 2 * tensor(strain)));
      };
      EXPECT_LT((state.green_strain - load.strains[i]).norm(), 1e-14);
      EXPECT_LT((state.stress - stress(load.strains[i])).norm(), 1e-10 * state.stress.norm()) << i;
      Eigen::Matrix3d tangent;
      const double h = 1e-6;
      for (int k = 0; k < 3; ++k) {
        Eigen::Vector3d change = h * Eigen::Vector3d::Unit(k);
        change[2] /= 2;
        tangent.col(k) = (stress(load.strains[i] + change) - stress(load.strains[i] - change)) / (2 * h);
      }
      EXPECT_LT((state.tangent - tangent).norm(), 1e-8 * tangent.norm()) << i;
      EXPECT_EQ(state.stopped, Stop::converged);
      EXPECT_TRUE(state.stable);
    }
  }
}

TEST(Simulator, PassesThePatchTestOnADistortedMesh) {
  tiling::PeriodicMesh mesh = draw({"####", "####", "####", "####"}, equal(4, 0.25), equal(4, 0.25));
  // Corners are moved at random, and midpoints with them, so that sides remain straight.
  RandomStream random("patch test", 0);
  const Eigen::Index n = mesh.nodes.cols();
  std::vector<bool> corner(static_cast<std::size_t>(n), false);
  for (const auto& triangle : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) corner[static_cast<std::size_t>(triangle[k])] = true;
  for (Eigen::Index k = 0; k < n; ++k)
    if (corner[static_cast<std::size_t>(k)])
      mesh.nodes.col(k) += Eigen::Vector2d(random.uniform(-0.05, 0.05), random.uniform(-0.05, 0.05));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int side = 0; side < 3; ++side) {
      const auto& shift = mesh.shifts[t][static_cast<std::size_t>(3 + side)];
      const Eigen::Vector2d middle =
          0.5 * (mesh.corner(static_cast<int>(t), side) + mesh.corner(static_cast<int>(t), (side + 1) % 3));
      mesh.nodes.col(mesh.triangles[t][static_cast<std::size_t>(3 + side)]) =
          middle - mesh.lattice * Eigen::Vector2d(shift.first, shift.second);
    }
  SimulationOptions options;
  options.deformed_meshes = true;
  Simulator simulator(mesh, options);
  const SimulationResult result = simulator.run(BiaxialLoad{0.4, {{1.2, 0.9}}});
  const State& state = result.states.at(0);
  EXPECT_LT((state.stress - components(analytic_stress(options.material,
                                                       Eigen::Matrix2d::Identity() + 2 * tensor(state.green_strain))))
                .norm(),
            1e-10 * state.stress.norm());
  // Every node moves with the macroscopic deformation, apart from one common translation.
  const Eigen::Matrix2Xd moved = state.deformed->nodes - state.deformation_gradient * mesh.nodes;
  EXPECT_LT((moved.colwise() - moved.col(0)).norm(), 1e-10);
}

TEST(Simulator, StressIsTheDerivativeOfEnergyAndTangentThatOfStress) {
  SimulationOptions options;
  options.tolerance = 1e-11;
  Simulator simulator(stiff_frame(), options);
  for (const Eigen::Vector3d& strain :
       {Eigen::Vector3d(0.02, -0.01, 0.01), Eigen::Vector3d(0.2, 0.1, -0.1), Eigen::Vector3d(-0.08, 0.05, 0.03)}) {
    const State state = simulator.run(GreenStrainLoad{{strain}}).states.at(0);
    Eigen::Vector3d stress;
    Eigen::Matrix3d tangent;
    const double h = 1e-5;
    for (int k = 0; k < 3; ++k) {
      Eigen::Vector3d change = h * Eigen::Vector3d::Unit(k);
      if (k == 2) change /= 2;
      const State ahead = simulator.run(GreenStrainLoad{{strain + change}}).states.at(0);
      const State behind = simulator.run(GreenStrainLoad{{strain - change}}).states.at(0);
      stress[k] = (ahead.energy_density - behind.energy_density) / (2 * h);
      tangent.col(k) = (ahead.stress - behind.stress) / (2 * h);
    }
    EXPECT_LT((state.stress - stress).norm(), 1e-6 * stress.norm()) << strain.transpose();
    EXPECT_LT((state.tangent - tangent).norm(), 1e-6 * tangent.norm()) << strain.transpose();
    EXPECT_LT((state.tangent - state.tangent.transpose()).norm(), 1e-12 * tangent.norm());
  }
}

TEST(Simulator, TangentsOfSoftCellsAreDerivativesOfTheStressToo) {
  // Long thin beams are so soft in bending that a response can have a large error although its residual is small.
  SimulationOptions options;
  options.material = {Law::incompressible_plane_stress, 7.4, 0.48};
  options.mesh.mesh_size = 0.7;
  options.mesh.corner_size = 0.25;
  options.contact = Switch::off;
  options.tolerance = 1e-12;
  const std::vector<double> parameters{0.15345997607757192, 0.32818359283570625};
  Simulator simulator(tiling::make_structure(tiling::family("IH50"), parameters), options);
  const Eigen::Vector3d first(-0.0175, -0.0167, -0.0095), strain(-0.0346, -0.033, -0.0186);
  const Eigen::Vector3d change(3e-6, 0, 0);
  const State state = simulator.run(GreenStrainLoad{{first, strain}}).states.at(1);
  const State ahead = simulator.run(GreenStrainLoad{{first, strain + change}}).states.at(1);
  const State behind = simulator.run(GreenStrainLoad{{first, strain - change}}).states.at(1);
  const Eigen::Vector3d slope = (ahead.stress - behind.stress) / (2 * change[0]);
  EXPECT_LT((state.tangent.col(0) - slope).norm(), 2e-6 * slope.norm());
}

TEST(Simulator, RotatingTheLoadWithTheLatticeRotatesTheAnswer) {
  const double angle = 0.6;
  const Eigen::Matrix2d rotation = Eigen::Rotation2Dd(angle).toRotationMatrix();
  tiling::PeriodicMesh mesh = stiff_frame();
  Simulator simulator(mesh, {});
  mesh.lattice = rotation * mesh.lattice;
  mesh.nodes = rotation * mesh.nodes;
  Simulator rotated(mesh, {});
  const UniaxialLoad load{0.3, {0.97, 0.9}};
  UniaxialLoad turned = load;
  turned.direction += angle;
  const SimulationResult one = simulator.run(load);
  const SimulationResult other = rotated.run(turned);
  for (std::size_t i = 0; i < load.stretches.size(); ++i) {
    const State& a = one.states.at(i);
    const State& b = other.states.at(i);
    EXPECT_NEAR(a.energy_density, b.energy_density, 1e-9 * a.energy_density);
    EXPECT_LT((rotation * tensor(a.stress) * rotation.transpose() - tensor(b.stress)).norm(), 1e-7 * a.stress.norm());
    EXPECT_LT((rotation * tensor(a.green_strain) * rotation.transpose() - tensor(b.green_strain)).norm(), 1e-9);
  }
}

TEST(Simulator, LeavesNoStressButTheAxialOneUnderUniaxialLoad) {
  Simulator simulator(stiff_frame(), {});
  const UniaxialLoad load{1.1, {1.001, 1.1, 1.3}};
  const SimulationResult result = simulator.run(load);
  const Eigen::Vector2d d(std::cos(load.direction), std::sin(load.direction));
  for (std::size_t i = 0; i < load.stretches.size(); ++i) {
    const State& state = result.states.at(i);
    const Eigen::Matrix2d& f = state.deformation_gradient;
    EXPECT_LT((f.transpose() * d - load.stretches[i] * d).norm(), 1e-14);
    const Eigen::Matrix2d p = f * tensor(state.stress);
    const Eigen::Vector2d n(-d[1], d[0]);
    EXPECT_LT((p.transpose() * n).norm(), 1e-7 * p.norm());
  }
}

TEST(Simulator, LeavesOnlyStressAlongADirectionOfTheMaterialThatIsPulled) {
  Simulator simulator(stiff_frame(), {});
  const UniaxialLoad load{1.1, {1.001, 1.1, 1.3}, LoadFrame::material};
  const SimulationResult result = simulator.run(load);
  const Eigen::Vector2d d(std::cos(load.direction), std::sin(load.direction));
  const Eigen::Vector2d n(-d[1], d[0]);
  for (std::size_t i = 0; i < load.stretches.size(); ++i) {
    const State& state = result.states.at(i);
    EXPECT_LT((state.deformation_gradient * d - load.stretches[i] * d).norm(), 1e-14);
    EXPECT_LT((tensor(state.stress) * n).norm(), 1e-7 * state.stress.norm());
    EXPECT_GT(d.dot(tensor(state.stress) * d), 0);
  }
}

TEST(Simulator, ImposesBiaxialStretchesExactly) {
  Simulator simulator(stiff_frame(), {});
  const BiaxialLoad load{0.7, {{1.05, 0.95}, {1.2, 0.9}}};
  const SimulationResult result = simulator.run(load);
  const Eigen::Vector2d d(std::cos(0.7), std::sin(0.7));
  const Eigen::Vector2d n(-d[1], d[0]);
  for (std::size_t i = 0; i < load.stretches.size(); ++i) {
    const Eigen::Matrix2d f = load.stretches[i][0] * d * d.transpose() + load.stretches[i][1] * n * n.transpose();
    EXPECT_LT((result.states.at(i).deformation_gradient - f).norm(), 1e-14);
  }
}

TEST(Simulator, AnswersAPathAsItAnswersItsStatesOneByOne) {
  Simulator simulator(stiff_frame(), {});
  const std::vector<double> stretches = {1.02, 1.1, 1.25};
  const SimulationResult path = simulator.run(UniaxialLoad{0.2, stretches});
  for (std::size_t i = 0; i < stretches.size(); ++i) {
    const State alone = simulator.run(UniaxialLoad{0.2, {stretches[i]}}).states.at(0);
    EXPECT_LT((alone.stress - path.states.at(i).stress).norm(), 1e-6 * alone.stress.norm());
  }
  const SimulationResult again = simulator.run(UniaxialLoad{0.2, stretches});
  for (std::size_t i = 0; i < stretches.size(); ++i)
    EXPECT_EQ(again.states.at(i).stress, path.states.at(i).stress) << "a path depends on those before it";
}

TEST(Simulator, GivesTheSameBitsForAnyNumberOfThreads) {
  std::vector<SimulationResult> results;
  for (const int threads : {1, 2, 3}) {
    set_thread_count(threads);
    Simulator simulator(lattice(), {});
    results.push_back(simulator.run(BiaxialLoad{0, {{0.99, 0.99}, {0.97, 0.97}}}));
  }
  set_thread_count(0);
  ASSERT_EQ(results[0].states.size(), 2U);
  EXPECT_EQ(results[0].states[1].cells, 2) << "the check of the 2x2 patch and the patch itself are on the way";
  for (const auto& result : results)
    for (std::size_t i = 0; i < 2; ++i) {
      EXPECT_EQ(result.states.at(i).stress, results[0].states[i].stress);
      EXPECT_EQ(result.states.at(i).tangent, results[0].states[i].tangent);
      EXPECT_EQ(result.states.at(i).energy_density, results[0].states[i].energy_density);
    }
}

TEST(Simulator, TakesTheTwoByTwoPatchWhenOneCellBucklesWithTwiceItsPeriod) {
  SimulationOptions options;
  options.contact = Switch::off;
  const BiaxialLoad load{0, {{0.99, 0.99}, {0.97, 0.97}}};
  Simulator automatic(lattice(), options);
  CostLedger cost;
  Execution execution;
  execution.cost = &cost;
  const SimulationResult result = automatic.run(load, execution);
  options.patch = Switch::on;
  const SimulationResult patch = Simulator(lattice(), options).run(load);
  options.patch = Switch::off;
  const SimulationResult one_cell = Simulator(lattice(), options).run(load);
  ASSERT_EQ(result.states.size(), 2U) << result.message;
  ASSERT_EQ(patch.states.size(), 2U) << patch.message;
  ASSERT_EQ(one_cell.states.size(), 2U) << one_cell.message;
  EXPECT_EQ(result.states[1].cells, 2);
  EXPECT_GE(result.states[1].branch, 1);
  EXPECT_TRUE(result.states[1].stable);
  EXPECT_NEAR(result.states[1].energy_density, patch.states[1].energy_density, 1e-6 * patch.states[1].energy_density);
  EXPECT_LT(result.states[1].energy_density, 0.9 * one_cell.states[1].energy_density);
  EXPECT_EQ(one_cell.states[1].cells, 1);
}

TEST(Simulator, ReportsTheUnstableStateWhereBucklingIsOff) {
  SimulationOptions options;
  options.contact = Switch::off;
  options.buckling = Switch::off;
  Simulator simulator(lattice(), options);
  const SimulationResult result = simulator.run(BiaxialLoad{0, {{0.97, 0.97}}});
  ASSERT_EQ(result.states.size(), 1U) << result.message;
  EXPECT_FALSE(result.states[0].stable);
  EXPECT_EQ(result.states[0].branch, 0);
}

// The sides of the hole touch each other at stretches below about 0.6.
TEST(Simulator, TightensContactOfStatesAndGoesOnFromTheOnesThatItFollowed) {
  Simulator simulator(stiff_frame(), {});
  const SimulationResult path = simulator.run(UniaxialLoad{0.3, {0.62, 0.58, 0.54, 0.5}});
  ASSERT_EQ(path.message, "");
  const State& last = path.states.back();
  EXPECT_GT(last.contacts, 0);
  EXPECT_LT(last.smallest_gap, 2e-3 * stiff_frame().beam_width);
  EXPECT_GT(last.smallest_gap, 0);
  EXPECT_LT(last.residual, 1e-6);
  const State alone = simulator.run(UniaxialLoad{0.3, {0.5}}).states.at(0);
  EXPECT_LT((alone.stress - last.stress).norm(), 1e-5 * last.stress.norm());
  const SimulationResult again = simulator.run(UniaxialLoad{0.3, {0.62, 0.58, 0.54, 0.5}});
  for (std::size_t i = 0; i < path.states.size(); ++i)
    EXPECT_LT((again.states[i].stress - path.states[i].stress).norm(), 1e-9 * path.states[i].stress.norm());
}

TEST(Simulator, SaysOfEachEffectThatDidNotRunWhy) {
  for (const Switch contact : {Switch::automatic, Switch::off}) {
    SimulationOptions options;
    options.contact = contact;
    Simulator simulator(stiff_frame(), options);
    CostLedger cost;
    Execution execution;
    execution.cost = &cost;
    simulator.run(BiaxialLoad{0, {{1.05, 1}}}, execution);
    const auto found = std::find_if(cost.effects().begin(), cost.effects().end(),
                                    [](const CostLedger::Effect& e) { return e.name == "contact"; });
    ASSERT_NE(found, cost.effects().end());
    EXPECT_FALSE(found->ran);
    EXPECT_EQ(found->why, contact == Switch::off ? "switched off by the request"
                                                 : "no pair of boundary points came within the barrier's range");
  }
}

TEST(Simulator, ReportsTheLastEquilibriumWhereAPathCannotBeFollowed) {
  SimulationOptions options;
  options.max_iterations = 3;
  options.max_load_step = 0.5;
  options.tolerance = 1e-12;
  Simulator strict(stiff_frame(), options);
  const SimulationResult stopped = strict.run(UniaxialLoad{0.3, {0.5}});
  const State& last = stopped.states.at(0);
  ASSERT_NE(last.stopped, Stop::converged);
  ASSERT_GT(last.energy_density, 0) << "no step was made";
  EXPECT_NE(stopped.message, "");
  // Stress and energy belong to the strain that is reported, and not to an attempt that failed.
  const State again = strict.run(GreenStrainLoad{{last.green_strain}}).states.at(0);
  EXPECT_NEAR(last.energy_density, again.energy_density, 1e-6 * again.energy_density + 1e-12);
}

TEST(Simulator, SaysThatAStateIsOutOfReachWhereItBucklesButCannotSettle) {
  SimulationOptions options;
  options.contact = Switch::off;
  // One iteration suffices for one cell under so small a load. It does not for the patch, which has left an unstable
  // equilibrium.
  options.max_iterations = 1;
  const SimulationResult result = Simulator(lattice(), options).run(BiaxialLoad{0, {{0.98, 0.98}}});
  const State& last = result.states.at(0);
  EXPECT_EQ(last.cells, 2);
  EXPECT_EQ(last.stopped, Stop::iteration_limit);
  EXPECT_GT(last.deformation_gradient(0, 0), 0.9801);
  EXPECT_NE(result.message.find("State 0 could not be reached"), std::string::npos) << result.message;
}

TEST(Simulator, StartsAtRestWithoutStressAndWithThePositiveStiffnessOfSmallStrains) {
  Simulator simulator(stiff_frame(), {});
  const State state = simulator.run(GreenStrainLoad{{Eigen::Vector3d::Zero()}}).states.at(0);
  EXPECT_EQ(state.energy_density, 0);
  EXPECT_EQ(state.stress, Eigen::Vector3d::Zero());
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(state.tangent).eigenvalues()[0], 0);
}

TEST(Simulator, NamesTheStateOfALoadThatItRefuses) {
  Simulator simulator(stiff_frame(), {});
  auto error = expect_error<InvalidLoad>("simulation.invalid_load", [&] {
    simulator.run(UniaxialLoad{0, {1.1, -0.5, 9}});
  });
  EXPECT_EQ(places(error), (std::vector<std::string>{"uniaxial/stretches/1", "uniaxial/stretches/2"}));
  error = expect_error<InvalidLoad>("simulation.invalid_load", [&] {
    simulator.run(GreenStrainLoad{{{0, 0, 0}, {-0.6, 0, 0}}});
  });
  EXPECT_EQ(places(error), std::vector<std::string>{"green_strain/1"});
  error = expect_error<InvalidLoad>("simulation.invalid_load", [&] {
    simulator.run(BiaxialLoad{std::nan(""), {{1, 1}}});
  });
  EXPECT_EQ(places(error), std::vector<std::string>{"biaxial/direction"});
  expect_error<InvalidLoad>("simulation.invalid_load", [&] { simulator.run(UniaxialLoad{0, {}}); });
}

TEST(Simulator, NamesTheOptionThatItRefuses) {
  SimulationOptions options;
  options.tolerance = 0;
  options.material.youngs_modulus = -1;
  const auto error = expect_error("simulation.invalid_option", [&] { Simulator(stiff_frame(), options); });
  EXPECT_EQ(places(error), (std::vector<std::string>{"material/youngs_modulus", "tolerance"}));
}

TEST(Simulator, TakesOptionsUpToTheirLimitsAndNoFurther) {
  const auto refused = [](auto change) {
    SimulationOptions options;
    change(options);
    try {
      Simulator(stiff_frame(), options);
    } catch (const Error& error) {
      return places(error);
    }
    return std::vector<std::string>{};
  };
  using Refused = std::vector<std::string>;
  // clang 14 cannot capture a structured binding by reference. Therefore the captures are written `value = value`.
  for (const auto& [value, within] : {std::pair(0.99e-12, false), {1e-12, true}, {1e-2, true}, {1.01e-2, false}})
    EXPECT_EQ(refused([value = value](auto& o) { o.tolerance = value; }), within ? Refused{} : Refused{"tolerance"})
        << value;
  for (const auto& [value, within] : {std::pair(0, false), {1, true}, {10'000, true}, {10'001, false}})
    EXPECT_EQ(refused([value = value](auto& o) { o.max_iterations = value; }),
              within ? Refused{} : Refused{"max_iterations"});
  for (const auto& [value, within] : {std::pair(0.99e-5, false), {1e-5, true}, {10.0, true}, {10.1, false}})
    EXPECT_EQ(refused([value = value](auto& o) { o.max_load_step = value; }),
              within ? Refused{} : Refused{"max_load_step"})
        << value;
  const Refused ratio{"material/poisson_ratio"};
  for (const auto& [value, within] : {std::pair(-1.0, false), {-0.99, true}, {0.4998, true}, {0.4999, false}}) {
    EXPECT_EQ(refused([value = value](auto& o) { o.material.poisson_ratio = value; }), within ? Refused{} : ratio)
        << value;
    EXPECT_EQ(refused([value = value](auto& o) {
                o.material = {Law::incompressible_plane_stress, 1, value};
              }),
              Refused{})
        << "no ratio decides this law";
  }
}

TEST(Simulator, DividesALoadIntoStepsOfATwentiethUnlessToldOtherwise) {
  const auto steps = [](double stretch, const SimulationOptions& options) {
    return Simulator(solid_cell(), options).run(BiaxialLoad{0, {{stretch, 1}}}).states.at(0).load_steps;
  };
  EXPECT_EQ(steps(1.0499, {}), 1);
  EXPECT_EQ(steps(1.0501, {}), 2);
  SimulationOptions options;
  options.max_load_step = 0.02;
  EXPECT_EQ(steps(1.0499, options), 3);
}

TEST(Simulator, TellsWhichShareOfItsStatesIsDone) {
  struct Shares : ProgressSink {
    void report(double fraction, std::string_view stage) override {
      if (stage == "states") told.push_back(fraction);
    }
    std::vector<double> told;
  } shares;
  Execution execution;
  execution.progress = &shares;
  Simulator(stiff_frame(), {}).run(UniaxialLoad{0.2, {1.01, 1.02, 1.03, 1.04}}, execution);
  EXPECT_EQ(shares.told, (std::vector<double>{0, 0.25, 0.5, 0.75}));
}

TEST(Simulator, StopsWhereItIsAskedTo) {
  Simulator simulator(stiff_frame(), {});
  Execution execution;
  execution.cancellation.request(StopReason::cancelled);
  expect_cancelled(StopReason::cancelled, [&] { simulator.run(UniaxialLoad{0, {1.1}}, execution); });
}

}  // namespace
}  // namespace supple::microscale
