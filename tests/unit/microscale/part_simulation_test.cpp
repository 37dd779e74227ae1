#include "supple/microscale/part_simulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "plate_barrier.h"
#include "supple/base/cancellation.h"
#include "supple/microscale/simulation_error.h"
#include "supple/numerics/system.h"
#include "supple/tiling/refined_mesh.h"
#include "support/drawn_meshes.h"

namespace supple::microscale {
namespace {

using testing::draw;
using testing::Drawing;
using testing::equal;

/// A body of rectangles that lies alone in its cell. Rows of the drawing run from top to bottom.
tiling::PeriodicMesh body(const Drawing& drawing, const std::vector<double>& columns, const std::vector<double>& rows) {
  const auto total = [](const std::vector<double>& lengths) {
    double sum = 0;
    for (const double length : lengths) sum += length;
    return sum;
  };
  const std::string empty(columns.size() + 1, '.');
  Drawing all{empty};
  for (const std::string& row : drawing) all.push_back(row + ".");
  std::vector<double> widths = columns;
  std::vector<double> heights = rows;
  widths.push_back(4 * total(columns));
  heights.push_back(4 * total(rows));
  tiling::PeriodicMesh mesh = draw(all, widths, heights);
  mesh.mesh_size = std::min(columns[0], rows[0]);
  return mesh;
}

/// A solid rectangle whose lower left corner is the origin.
tiling::PeriodicMesh block(double width, double height, int columns, int rows) {
  return body(Drawing(static_cast<std::size_t>(rows), std::string(static_cast<std::size_t>(columns), '#')),
              equal(columns, width / columns), equal(rows, height / rows));
}

Plate plate(Side side, Eigen::Vector2d displacement = {0, 0}, Friction friction = Friction::none, double gap = 0) {
  return {side, gap, friction, displacement};
}

Clamp clamp(Eigen::Vector2d lower, Eigen::Vector2d upper, Eigen::Vector2d displacement = {0, 0}) {
  return {lower, upper, displacement};
}

PartSimulationOptions with_states(int states) {
  PartSimulationOptions options;
  options.states = states;
  return options;
}

struct Lame {
  double mu, lambda;
  explicit Lame(const Material& material = {})
      : mu(material.youngs_modulus / (2 * (1 + material.poisson_ratio))),
        lambda(2 * mu * material.poisson_ratio / (1 - 2 * material.poisson_ratio)) {}
  /// First Piola-Kirchhoff stress along the axis of the stretch s, for the stretch t across it.
  double stress(double s, double t) const { return mu * (s - 1 / s) + lambda * std::log(s * t) / s; }
  /// The stretch across an axis that is stretched by s if there is no stress across it.
  double free_stretch(double s) const {
    double low = 0.5;
    double high = 2;
    for (int k = 0; k < 100; ++k) {
      const double t = (low + high) / 2;
      (stress(t, s) < 0 ? low : high) = t;
    }
    return low;
  }
};

TEST(PlateBarrier, HasTheDerivativesOfItsValue) {
  const tiling::PeriodicMesh mesh = block(1, 1, 2, 2);
  const PartSupports supports(mesh, {plate(Side::bottom), plate(Side::top), plate(Side::left)});
  PlateBarrier barrier(supports, {}, 0.5);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * mesh.nodes.cols() + 4);
  RandomStream random("plate barrier", 1);
  for (double& value : x) value = random.uniform(-0.3, 0.3);
  x.tail<4>().setZero();
  numerics::EnergySum sum;
  barrier.add(x, 0, sum);
  EXPECT_GT(sum.value, 0);
  numerics::DerivativeCheckOptions options;
  options.step = 1e-3;
  const auto check = numerics::check_derivatives<CellState>(barrier, x, options);
  EXPECT_LT(check.gradient.error, 1e-7) << check.summary();
  EXPECT_LT(check.hessian.error, 1e-7) << check.summary();
}

TEST(PartSimulation, ABlockBetweenFourPlatesIsStrainedAlongOneAxis) {
  const double width = 3;
  const double height = 2;
  const PartSimulationResult result = simulate_part(
      block(width, height, 4, 3),
      {plate(Side::bottom), plate(Side::top, {0, -0.3}), plate(Side::left), plate(Side::right)}, with_states(3));
  ASSERT_EQ(result.states.size(), 3U);
  EXPECT_FALSE(result.fixed_translation);
  for (const PartState& state : result.states) {
    const double s = 1 - 0.3 * state.fraction / height;
    const double along = width * Lame().stress(s, 1);
    const double across = height * Lame().stress(1, s);
    EXPECT_NEAR(state.supports[0].force.y(), -along, 1e-8 * std::abs(along));
    EXPECT_NEAR(state.supports[1].force.y(), along, 1e-8 * std::abs(along));
    EXPECT_NEAR(state.supports[2].force.x(), -across, 1e-8 * std::abs(across));
    EXPECT_NEAR(state.supports[3].force.x(), across, 1e-8 * std::abs(across));
    EXPECT_NEAR(state.largest_strain, 1 - s, 1e-9);
    EXPECT_TRUE(state.stable);
  }
}

TEST(PartSimulation, ABlockBetweenTwoPlatesWithoutFrictionIsCompressedHomogeneously) {
  PartSimulationOptions options = with_states(4);
  options.thickness = 2.5;
  options.pressure_length = 0.5;
  const PartSimulationResult result =
      simulate_part(block(3, 2, 4, 4), {plate(Side::bottom), plate(Side::top, {0, -0.4})}, options);
  ASSERT_EQ(result.states.size(), 4U) << result.message;
  EXPECT_TRUE(result.fixed_translation);
  for (const PartState& state : result.states) {
    const double s = 1 - 0.4 * state.fraction / 2;
    const double t = Lame().free_stretch(s);
    const double force = 3 * 2.5 * Lame().stress(s, t);
    EXPECT_NEAR(state.supports[1].force.y(), force, 1e-7 * std::abs(force));
    EXPECT_NEAR(state.supports[0].force.y(), -force, 1e-7 * std::abs(force));
    EXPECT_NEAR(state.supports[0].force.x(), 0, 1e-8 * std::abs(force));
    ASSERT_TRUE(state.supports[1].pressure);
    double sum = 0;
    for (const double value : state.supports[1].pressure->values) sum += value * 0.5 * 2.5;
    EXPECT_NEAR(sum, -state.supports[1].force.y(), 1e-12 * std::abs(force));
  }
}

TEST(PartSimulation, PlatesThatStickLetNothingSlide) {
  const tiling::PeriodicMesh mesh = block(3, 2, 8, 6);
  PartSimulationOptions options = with_states(2);
  options.deformed_nodes = true;
  const auto run = [&](Friction friction) {
    return simulate_part(mesh, {plate(Side::bottom, {0, 0}, friction), plate(Side::top, {0, -0.2}, friction)}, options);
  };
  const PartSimulationResult stuck = run(Friction::stick);
  const PartSimulationResult free = run(Friction::none);
  ASSERT_EQ(stuck.states.size(), 2U);
  EXPECT_FALSE(stuck.fixed_translation);
  EXPECT_GT(-stuck.states[1].supports[1].force.y(), 1.1 * -free.states[1].supports[1].force.y());
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k)
    if (mesh.nodes(1, k) > 2 - 1e-9) {
      EXPECT_EQ(stuck.states[1].displacements(0, k), 0);
      EXPECT_NEAR(stuck.states[1].displacements(1, k), -0.2, 1e-12);
    }
}

TEST(PartSimulation, SupportForcesBalanceAndAreTheDerivativeOfTheEnergy) {
  const tiling::PeriodicMesh mesh = block(1, 4, 3, 12);
  const int states = 40;
  const PartSimulationResult result =
      simulate_part(mesh, {clamp({-1, -1}, {2, 0.01}), clamp({-1, 3.99}, {2, 5}, {0.8, 0.4})}, with_states(states));
  ASSERT_EQ(result.states.size(), static_cast<std::size_t>(states)) << result.message;
  const auto energy = [&](int k) { return result.states[static_cast<std::size_t>(k)].energy; };
  for (const int k : {5, 20, 36}) {
    const PartState& state = result.states[static_cast<std::size_t>(k)];
    const Eigen::Vector2d force = state.supports[1].force;
    EXPECT_LT((state.supports[0].force + force).norm(), 1e-7 * force.norm());
    const double derivative = states * (8 * (energy(k + 1) - energy(k - 1)) - (energy(k + 2) - energy(k - 2))) / 12;
    EXPECT_NEAR(force.dot(Eigen::Vector2d(0.8, 0.4)), derivative, 1e-6 * derivative);
  }
}

TEST(PartSimulation, AStripThatIsStretchedAndShearedHasTheForceOfAnotherProgram) {
  const PartSimulationResult result = simulate_part(
      block(1, 4, 3, 12), {clamp({-1, -1}, {2, 0.01}), clamp({-1, 3.99}, {2, 5}, {0.8, 0.4})}, with_states(1));
  ASSERT_EQ(result.states.size(), 1U) << result.message;
  // These numbers are those of a program for the same triangles in Python, with dense element matrices, Newton's method
  // without line search, and sparse LU.
  EXPECT_NEAR(result.states[0].supports[1].force.x(), 0.8908878845288088, 1e-7);
  EXPECT_NEAR(result.states[0].supports[1].force.y(), 3.495360503556722, 1e-7);
  EXPECT_NEAR(result.states[0].energy, 1.0028937175461976, 1e-9);
}

TEST(PartSimulation, RigidMotionsCostNoEnergy) {
  const PartSimulationResult result =
      simulate_part(block(1, 2, 2, 4), {clamp({-1, -1}, {2, 0.01}, {0.5, 0.3}), clamp({-1, 1.99}, {2, 5}, {0.5, 0.3})},
                    with_states(2));
  ASSERT_EQ(result.states.size(), 2U);
  EXPECT_NEAR(result.states[1].energy, 0, 1e-20);
  EXPECT_NEAR(result.states[1].supports[0].force.norm(), 0, 1e-11);
  EXPECT_NEAR(result.states[1].largest_strain, 0, 1e-12);
}

TEST(PartSimulation, FinerMeshesApproachTheEnergyFromAbove) {
  tiling::PeriodicMesh mesh = block(2, 2, 2, 2);
  std::vector<double> energies;
  for (int level = 0; level < 4; ++level) {
    const PartSimulationResult result = simulate_part(
        mesh, {plate(Side::bottom, {0, 0}, Friction::stick), plate(Side::top, {0, -0.2}, Friction::stick)},
        with_states(1));
    ASSERT_EQ(result.states.size(), 1U);
    energies.push_back(result.states[0].energy);
    mesh = tiling::refine(mesh).mesh;
    mesh.mesh_size /= 2;
  }
  for (std::size_t k = 1; k < energies.size(); ++k) EXPECT_LT(energies[k], energies[k - 1]);
  const double ratio = (energies[1] - energies[2]) / (energies[2] - energies[3]);
  EXPECT_GT(ratio, 2);
}

Material stiff() {
  Material material;
  material.youngs_modulus = 100;
  material.poisson_ratio = 0.3;
  return material;
}
/// Young's modulus of a wide plate.
double plane_modulus(const Material& material) {
  return material.youngs_modulus / (1 - material.poisson_ratio * material.poisson_ratio);
}

TEST(PartSimulation, ABeamHasTheBendingStiffnessOfItsSection) {
  const double length = 40;
  PartSimulationOptions options = with_states(1);
  options.material = stiff();
  const double shift = 1e-3;
  const PartSimulationResult result = simulate_part(
      block(1, length, 4, 160), {clamp({-1, -1}, {2, 0}), clamp({-1, length}, {2, length + 1}, {shift, 0})}, options);
  const double bending = plane_modulus(stiff()) / 12;
  const double shear = 5.0 / 6 * stiff().youngs_modulus / (2 * (1 + stiff().poisson_ratio));
  const double expected = shift / (std::pow(length, 3) / (12 * bending) + length / shear);
  EXPECT_NEAR(result.states[0].supports[1].force.x(), expected, 5e-3 * expected);
}

TEST(PartSimulation, ASlenderColumnBucklesAtEulersLoad) {
  const double length = 40;
  const double euler = 4 * std::numbers::pi * std::numbers::pi * plane_modulus(stiff()) / 12 / (length * length);
  const double critical_strain = euler / plane_modulus(stiff());
  PartSimulationOptions options = with_states(4);
  options.material = stiff();
  const std::vector<Support> supports{clamp({-1, -1}, {2, 0}),
                                      clamp({-1, length}, {2, length + 1}, {0, -2 * critical_strain * length})};
  const tiling::PeriodicMesh column = block(1, length, 2, 80);
  const PartSimulationResult result = simulate_part(column, supports, options);
  ASSERT_EQ(result.states.size(), 4U) << result.message;
  EXPECT_NEAR(-result.states[0].supports[1].force.y(), 0.5 * euler, 0.01 * euler);
  EXPECT_EQ(result.states[0].branch, 0);
  EXPECT_NEAR(-result.states[2].supports[1].force.y(), euler, 0.02 * euler);
  EXPECT_NEAR(-result.states[3].supports[1].force.y(), euler, 0.02 * euler);
  EXPECT_GE(result.states[3].branch, 1);
  EXPECT_TRUE(result.states[3].stable);

  options.buckling = Switch::off;
  const PartSimulationResult straight = simulate_part(column, supports, options);
  ASSERT_EQ(straight.states.size(), 4U) << straight.message;
  EXPECT_EQ(straight.states[3].branch, 0);
}

TEST(PartSimulation, APlateThatArrivesLateTouchesWhenItArrives) {
  const tiling::PeriodicMesh mesh = block(2, 2, 4, 4);
  PartSimulationOptions options = with_states(4);
  options.deformed_nodes = true;
  const PartSimulationResult result =
      simulate_part(mesh, {clamp({-1, -1}, {3, 0}), plate(Side::top, {0, -0.4}, Friction::none, 0.2)}, options);
  ASSERT_EQ(result.states.size(), 4U) << result.message;
  EXPECT_EQ(result.states[0].supports[1].touching, 0);
  EXPECT_EQ(result.states[0].supports[1].force.norm(), 0);
  EXPECT_EQ(result.states[0].energy, 0);
  for (const int k : {2, 3}) {
    const PartState& state = result.states[static_cast<std::size_t>(k)];
    EXPECT_GT(state.supports[1].touching, 0);
    EXPECT_LT(state.supports[1].force.y(), 0);
    const double surface = 2.2 - 0.4 * state.fraction;
    EXPECT_LE((mesh.nodes + state.displacements).row(1).maxCoeff(), surface + 1e-9);
  }
}

/// A block with a slit that closes when the block is pressed.
tiling::PeriodicMesh slit_block() {
  return body({"########", "########", "#......#", "########", "########"}, equal(8, 0.5), {0.5, 0.5, 0.2, 0.5, 0.5});
}

TEST(PartSimulation, ASlitThatClosesCarriesThePressure) {
  PartSimulationOptions options = with_states(4);
  const std::vector<Support> supports{plate(Side::bottom), plate(Side::top, {0, -0.35})};
  const PartSimulationResult touching = simulate_part(slit_block(), supports, options);
  ASSERT_EQ(touching.states.size(), 4U) << touching.message;
  EXPECT_GT(touching.states[3].contacts, 0);
  options.contact = Switch::off;
  const PartSimulationResult passing = simulate_part(slit_block(), supports, options);
  ASSERT_FALSE(passing.states.empty());
  EXPECT_EQ(passing.states.back().contacts, 0);
  ASSERT_EQ(passing.states.size(), 4U) << passing.message;
  EXPECT_GT(-touching.states[3].supports[1].force.y(), -1.05 * passing.states[3].supports[1].force.y());
}

TEST(PartSimulation, PlatesThatMoveApartExertNoForce) {
  const PartSimulationResult result =
      simulate_part(block(2, 2, 3, 3), {plate(Side::bottom), plate(Side::top, {0, 0.2})}, with_states(2));
  ASSERT_EQ(result.states.size(), 2U) << result.message;
  const std::vector<SupportState>& supports = result.states[1].supports;
  EXPECT_NE(supports[0].touching == 0, supports[1].touching == 0);
  EXPECT_NEAR(supports[0].force.norm() + supports[1].force.norm(), 0, 1e-11);
  EXPECT_NEAR(result.states[1].energy, 0, 1e-20);
}

TEST(PartSimulation, APartThatTipsOverComesToRestOnOtherCorners) {
  // The plates press on opposite sides of the middle, so that the part turns until other corners touch them.
  const tiling::PeriodicMesh step = body({"....##", "######", "######", "##...."}, equal(6, 0.5), equal(4, 0.5));
  const PartSimulationResult result =
      simulate_part(step, {plate(Side::bottom), plate(Side::top, {0, -0.2})}, with_states(2));
  ASSERT_EQ(result.states.size(), 2U) << result.message;
  EXPECT_LE((result.states[1].supports[0].force + result.states[1].supports[1].force).norm(), 1e-8);
}

TEST(PartSupports, ASinglePointDoesNotKeepAPartFromTurning) {
  const tiling::PeriodicMesh mesh = block(2, 2, 3, 3);
  const PartSupports supports(mesh, {plate(Side::bottom, {0, 0}, Friction::stick), plate(Side::top)});
  Constraints constraints = supports.at_rest();
  EXPECT_FALSE(supports.leaves_rigid_motion(constraints));
  int fixed = 0;
  for (int& support : constraints.support)
    if (support != Constraints::none && ++fixed > 2) support = Constraints::none;
  EXPECT_TRUE(supports.leaves_rigid_motion(constraints));
}

/// The detail of the refusal of supports.
Error::Detail refusal(const std::vector<Support>& supports) {
  try {
    simulate_part(block(2, 2, 3, 3), supports);
  } catch (const InvalidLoad& error) {
    EXPECT_EQ(error.code(), "simulation.invalid_load");
    return error.details().at(0);
  }
  return {"nothing was refused", ""};
}

TEST(PartSimulation, SupportsThatMakeNoSenseAreNamedWithTheirLimit) {
  const Clamp grip = clamp({-1, -1}, {3, 0.4});
  EXPECT_EQ(refusal({}).where, "supports");
  EXPECT_EQ(refusal({grip, plate(Side::top, {0, 0}, Friction::none, -1)}).where, "supports/1/gap");
  EXPECT_EQ(refusal({grip, clamp({5, 5}, {6, 6})}).where, "supports/1/box");
  EXPECT_EQ(refusal({grip, clamp({0, -1}, {3, 3})}).where, "supports/1/box");
  EXPECT_EQ(refusal({grip, clamp({3, 0}, {0, 3})}).where, "supports/1/box");
  EXPECT_EQ(refusal({grip, plate(Side::top), plate(Side::top)}).where, "supports/2/side");
  EXPECT_EQ(refusal({grip, plate(Side::top, {0, -3})}).where, "supports/1/displacement");
  EXPECT_EQ(refusal({grip, plate(Side::top, {0, -1.95})}).where, "supports/1/displacement");
  EXPECT_EQ(refusal({plate(Side::bottom, {0, 1.5}), plate(Side::top, {0, -1})}).where, "supports/1/displacement");
  EXPECT_EQ(refusal({grip, clamp({-1, 1.9}, {3, 3}, {0, -1.95})}).where, "supports/1/displacement");
}

TEST(PartSimulation, PlatesAlongOneSideOnlyLeaveARigidMotion) {
  EXPECT_EQ(
      refusal({plate(Side::bottom, {0, 0}, Friction::none, 0.1), plate(Side::top, {0, 0}, Friction::none, 0.1)}).where,
      "supports");
  EXPECT_NE(refusal({plate(Side::left), plate(Side::top, {0, 0}, Friction::stick, 0.5)}).message.find("along y"),
            std::string::npos);
}

TEST(PartSimulation, TheBillSaysWhyContactAndBucklingDidNotRun) {
  const auto billed = [](const PartSimulationOptions& options) {
    CostLedger ledger;
    Execution execution;
    execution.cost = &ledger;
    simulate_part(block(2, 2, 3, 3), {plate(Side::bottom), plate(Side::top, {0, -0.1})}, options, execution);
    std::string text;
    for (const auto& effect : ledger.effects())
      if (effect.name == "contact" || effect.name == "buckling")
        text += effect.name + (effect.ran ? " ran" : "") + ": " + effect.why + "; ";
    return text;
  };
  PartSimulationOptions options = with_states(1);
  EXPECT_EQ(billed(options),
            "contact: no pair of boundary points came within the barrier's range; buckling: the stiffness stayed "
            "positive definite; ");
  options.contact = Switch::off;
  options.buckling = Switch::off;
  EXPECT_EQ(billed(options), "contact: switched off by the request; buckling: switched off by the request; ");
}

TEST(PartSimulation, StopsWhenItIsAskedTo) {
  Execution execution;
  execution.cancellation.request(StopReason::cancelled);
  EXPECT_THROW(simulate_part(block(2, 2, 3, 3), {plate(Side::bottom), plate(Side::top, {0, -0.1})}, {}, execution),
               Cancelled);
}

}  // namespace
}  // namespace supple::microscale
