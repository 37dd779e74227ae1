#include "supple/design/verification.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "supple/microscale/accurate_simulation.h"
#include "supple/tiling/structure.h"

namespace supple::design {
namespace {

using std::numbers::pi;

tiling::Structure structure() {
  return tiling::make_structure(tiling::family("IH01"), std::vector{0.12, 0.5, 0.14, 0.6});
}

microscale::SimulationOptions coarse() {
  microscale::SimulationOptions options;
  options.mesh.mesh_size = 1.5;
  options.mesh.corner_size = 1;
  options.patch = Switch::off;
  return options;
}

TEST(SimulatedProfile, StressIsTheWorkOfTheLoad) {
  const ProfileSamples samples{Task::stress_strain, 0.7, 0, StrainMeasure::engineering, {0.04, -0.01, 0, 0.05, 0.06}};
  const auto y = simulate_profile(structure(), samples, coarse());
  ASSERT_TRUE(y.allFinite());
  EXPECT_NEAR(y[2], 0, 1e-9);
  EXPECT_LT(y[1], 0);
  EXPECT_GT(y[4], y[3]);
  // The work per rest area is the integral of the force over rest width along the stretch.
  microscale::Simulator simulator(structure(), coarse());
  const auto states =
      simulator.run(microscale::UniaxialLoad{0.7, {1.04, 1.06}, microscale::LoadFrame::material}).states;
  const double work = states[1].energy_density - states[0].energy_density;
  EXPECT_NEAR(0.02 / 6 * (y[0] + 4 * y[3] + y[4]), work, 1e-4 * work) << "Simpson's rule";
}

TEST(SimulatedProfile, StiffnessAndPoissonsRatioAreSlopesOfTheSimulatedPath) {
  const double h = 1e-3;
  const auto profile_at = [](Task task, double strain, std::vector<double> x) {
    return simulate_profile(structure(), {task, 1.1, strain, StrainMeasure::green, std::move(x)}, coarse());
  };
  const auto stress = profile_at(Task::stress_strain, 0, {0.03 - h, 0.03 + h});
  const double slope = (stress[1] - stress[0]) / (2 * h);
  EXPECT_NEAR(profile_at(Task::stiffness, 0.03, {1.1})[0], slope, 1e-4 * slope);

  microscale::Simulator simulator(structure(), coarse());
  const auto stretch = [](double strain) { return std::sqrt(1 + 2 * strain); };
  const auto states =
      simulator
          .run(microscale::UniaxialLoad{1.1, {stretch(0.03 - h), stretch(0.03 + h)}, microscale::LoadFrame::material})
          .states;
  const Eigen::Vector3d change = states[1].green_strain - states[0].green_strain;
  const double s = std::sin(1.1);
  const double c = std::cos(1.1);
  const double across = s * s * change[0] + c * c * change[1] - 2 * s * c * change[2];
  EXPECT_NEAR(profile_at(Task::poisson, 0.03, {1.1})[0], -across / (2 * h), 1e-4);
}

TEST(SimulatedProfile, RepeatsAfterHalfATurn) {
  const auto y =
      simulate_profile(structure(), {Task::stiffness, 0, 0.01, StrainMeasure::green, {0.2, 0.2 + pi}}, coarse());
  EXPECT_NEAR(y[0], y[1], 1e-6 * y[0]);
}

TEST(SimulatedProfile, BillsItsEffectAndCanBeCancelled) {
  CostLedger bill;
  simulate_profile(structure(), {Task::stress_strain, 0, 0, StrainMeasure::green, {0.01}}, coarse(), {.cost = &bill});
  ASSERT_FALSE(bill.effects().empty());
  const auto& effects = bill.effects();
  EXPECT_TRUE(
      std::any_of(effects.begin(), effects.end(), [](const auto& e) { return e.name == "verification" && e.ran; }));
  const CancellationToken token;
  token.request(StopReason::cancelled);
  EXPECT_THROW(simulate_profile(structure(), {Task::stress_strain, 0, 0, StrainMeasure::green, {0.01}}, coarse(),
                                {.cancellation = token}),
               std::exception);
}

// The oracle is a mesh so fine that extrapolation is not needed.
TEST(Verification, ErrsByLessThanItsEstimate) {
  const ProfileSamples samples{Task::stress_strain, 0.4, 0, StrainMeasure::green, {0.03}};
  microscale::SimulationOptions fine;
  fine.mesh.mesh_size = 0.15;
  fine.mesh.corner_size = 0.03;
  const double exact = simulate_profile(structure(), samples, fine)[0];
  const auto& family = tiling::family("IH01");
  const auto verification = verification_of(family, {});
  const Eigen::VectorXd parameters = Eigen::Map<const Eigen::VectorXd>(
      structure().parameters.data(), static_cast<Eigen::Index>(structure().parameters.size()));
  const Eigen::VectorXd stress = verification.simulate(parameters, samples, {});
  const Eigen::VectorXd coarser = verification.coarser(parameters, samples, {});
  EXPECT_LT(std::abs(stress[0] - exact), 0.004 * exact);
  EXPECT_LT(std::abs(stress[0] - exact), verification.error_ratio * *relative_difference(stress, coarser) * exact);
}

TEST(Verification, IsTheDefaultSimulation) {
  const auto options = verification_options();
  EXPECT_EQ(options.refinement, microscale::Refinement::extrapolated);
  EXPECT_EQ(options.mesh.mesh_size, microscale::extrapolated_mesh().mesh_size);
  EXPECT_EQ(options.mesh.corner_size, microscale::extrapolated_mesh().corner_size);
}

TEST(RelativeDifference, IsOverWhatTheSimulationGotTo) {
  const double missing = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NEAR(*relative_difference(Eigen::Vector3d(3, 4, missing), Eigen::Vector3d(3, 5, 6)), 0.2, 1e-15);
  EXPECT_FALSE(relative_difference(Eigen::Vector2d(0, missing), Eigen::Vector2d(1, 2)));
}

}  // namespace
}  // namespace supple::design
