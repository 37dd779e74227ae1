// The estimated error of a mesh, compared with results on much finer meshes without extrapolation.
#include <gtest/gtest.h>

#include <cmath>

#include "supple/microscale/accurate_simulation.h"
#include "supple/tiling/family.h"

namespace supple::microscale {
namespace {

tiling::Structure preset_of(const char* id) {
  const tiling::Family& family = tiling::family(id);
  return tiling::make_structure(family, tiling::presets(family));
}

double norm_of(const Eigen::Vector3d& t) { return std::sqrt(t[0] * t[0] + t[1] * t[1] + 2 * t[2] * t[2]); }

SimulationOptions options_on(double size, double corners, Refinement refinement) {
  SimulationOptions options;
  options.mesh.mesh_size = size;
  options.mesh.corner_size = corners;
  options.refinement = refinement;
  return options;
}

const Load stretched = UniaxialLoad{0.3, {1.02, 1.05}};
const Load compressed = UniaxialLoad{0.3, {0.99, 0.98}};

SimulationResult run(const tiling::Structure& structure, const SimulationOptions& options, const Load& load) {
  return Simulator(structure, options).run(load);
}

TEST(DiscretizationError, OfTheDefaultIsBelowHalfAPerCentAndBelowItsEstimate) {
  for (const char* id : {"IH01", "IH22", "IH67"}) {
    const tiling::Structure structure = preset_of(id);
    for (const Load& load : {stretched, compressed}) {
      SCOPED_TRACE(id);
      const auto fine = run(structure, options_on(0.2, 0.03, Refinement::off), load);
      const auto result = run(structure, accurate_options(), load);
      ASSERT_TRUE(result.extrapolated);
      for (std::size_t i = 0; i < fine.states.size(); ++i) {
        const State& state = result.states[i];
        const State& wanted = fine.states[i];
        ASSERT_TRUE(state.mesh_error);
        const double error = norm_of(state.stress - wanted.stress);
        EXPECT_LT(error, 0.005 * norm_of(wanted.stress));
        EXPECT_LT(error, state.mesh_error->stress);
        EXPECT_LT(std::abs(state.energy_density - wanted.energy_density), state.mesh_error->energy_density);
      }
      EXPECT_LT(discretization_error(result.states)->stress, 0.01);
    }
  }
}

TEST(DiscretizationError, OfAGivenMeshIsSaidAndItsStatesStayThoseOfTheMesh) {
  const tiling::Structure structure = preset_of("IH22");
  const auto fine = run(structure, options_on(0.2, 0.03, Refinement::off), stretched);
  const auto plain = run(structure, options_on(0.5, 0.1, Refinement::off), stretched);
  const auto estimated = run(structure, options_on(0.5, 0.1, Refinement::estimated), stretched);
  EXPECT_FALSE(estimated.extrapolated);
  EXPECT_FALSE(discretization_error(plain.states));
  for (std::size_t i = 0; i < plain.states.size(); ++i) {
    EXPECT_EQ(estimated.states[i].stress, plain.states[i].stress);
    EXPECT_EQ(estimated.states[i].energy_density, plain.states[i].energy_density);
    const double error = norm_of(plain.states[i].stress - fine.states[i].stress);
    EXPECT_LT(error, estimated.states[i].mesh_error->stress);
    EXPECT_GT(3 * error, estimated.states[i].mesh_error->stress) << "an estimate, and no bound that says nothing";
  }
}

TEST(DiscretizationError, IsZeroAtRest) {
  const auto result = run(preset_of("IH01"), accurate_options(), GreenStrainLoad{{Eigen::Vector3d::Zero()}});
  ASSERT_TRUE(result.states.at(0).mesh_error);
  EXPECT_LT(result.states[0].mesh_error->stress, 1e-10);
}

TEST(DiscretizationError, IsUnknownWhereTheFinerMeshWouldBeTooLarge) {
  const tiling::Structure structure = preset_of("IH01");
  SimulationOptions options = options_on(0.5, 0.1, Refinement::extrapolated);
  options.mesh.max_nodes = 3 * static_cast<int>(Simulator(structure, options).mesh().nodes.cols());
  const auto result = run(structure, options, stretched);
  EXPECT_FALSE(result.extrapolated);
  EXPECT_FALSE(discretization_error(result.states));
  EXPECT_FALSE(result.states.at(0).mesh_error);
}

TEST(DiscretizationError, LeavesStressTheDerivativeOfTheEnergy) {
  constexpr double step = 1e-4;
  SimulationOptions options = accurate_options();
  options.tolerance = 1e-11;
  const GreenStrainLoad load{{{0.03 - step, 0.01, 0.005}, {0.03, 0.01, 0.005}, {0.03 + step, 0.01, 0.005}}};
  const auto states = run(preset_of("IH01"), options, load).states;
  ASSERT_EQ(states.size(), 3u);
  const double slope = (states[2].energy_density - states[0].energy_density) / (2 * step);
  EXPECT_NEAR(states[1].stress[0], slope, 1e-4 * std::abs(slope));
  const Eigen::Vector3d change = (states[2].stress - states[0].stress) / (2 * step);
  EXPECT_LT((states[1].tangent.col(0) - change).norm(), 1e-3 * change.norm());
}

TEST(DiscretizationError, LeavesFreeSidesFreeAndPrescribedStretchesExact) {
  const auto states = run(preset_of("IH22"), accurate_options(), UniaxialLoad{0, {1.03, 0.98}}).states;
  for (const State& state : states) {
    EXPECT_NEAR(state.deformation_gradient(0, 0), state.green_strain[0] > 0 ? 1.03 : 0.98, 1e-12);
    // The forces on free sides vanish exactly. The stress does so up to products of the small changes between the
    // meshes.
    EXPECT_LT(std::abs(state.stress[1]) + std::abs(state.stress[2]), 1e-4 * std::abs(state.stress[0]));
  }
}

TEST(SimulateWithin, MakesTheMeshAsFineAsTheAcceptedErrorAsks) {
  const tiling::Structure structure = preset_of("IH01");
  int before = 0;
  for (const double accepted : {0.02, 0.002, 0.0005}) {
    const auto found = simulate_within(structure, stretched, accurate_options(), accepted);
    const auto error = discretization_error(found.result.states);
    ASSERT_TRUE(error);
    EXPECT_LE(error->stress, accepted);
    EXPECT_GT(found.result.nodes, before) << accepted;
    before = found.result.nodes;
  }
}

TEST(SimulateWithin, KeepsTheFinestMeshThatTheLimitOfNodesAllows) {
  const tiling::Structure structure = preset_of("IH01");
  SimulationOptions options = accurate_options();
  options.mesh.max_nodes = 8000;
  const auto found = simulate_within(structure, stretched, options, 1e-5);
  EXPECT_EQ(found.result.states.size(), 2u);
  EXPECT_LE(4 * found.result.nodes, options.mesh.max_nodes);
  const auto error = discretization_error(found.result.states);
  ASSERT_TRUE(error);
  EXPECT_GT(error->stress, 1e-5);
}

}  // namespace
}  // namespace supple::microscale
