// Designs that are hard to correct by simulation, with shipped models and real simulations on coarse meshes. Each
// polish ends with a reason, returns the best simulated design, and never accepts a worse one.
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "supple/design/verification.h"
#include "supple/design/verified_designs.h"
#include "supple/tiling/structure.h"

namespace supple::design {
namespace {

/// A family with its shipped model, simulated on a mesh coarse enough for a test.
struct Family {
  /// Extrapolated simulations have no discretization error. Without extrapolation it is part of what polish corrects.
  explicit Family(const std::string& name, microscale::Refinement refinement = microscale::Refinement::extrapolated)
      : model(neural::read_model(std::filesystem::path(SUPPLE_MODELS) / (name + ".h5"))),
        evaluator(model.network),
        candidates(model.network),
        simulate(simulation_of(tiling::family(model.family), coarse(refinement))) {}

  static microscale::SimulationOptions coarse(microscale::Refinement refinement) {
    microscale::SimulationOptions options;
    options.mesh.mesh_size = 1;
    options.refinement = refinement;
    return options;
  }

  DesignSpace space() const {
    return {model, evaluator, candidates, [this](const Eigen::VectorXd& parameters) {
              return tiling::can_be_built(tiling::family(model.family),
                                          {parameters.data(), static_cast<std::size_t>(parameters.size())});
            }};
  }
  Eigen::VectorXd lower() const { return model.network.lower; }
  Eigen::VectorXd upper() const { return model.network.upper; }

  /// A target that the structure meets in the simulation, times `factor`.
  Target curve_of(const Eigen::VectorXd& parameters, double from, double to, int points = 6, double factor = 1) const {
    Target target;
    target.direction = 0.4;
    target.interpolation = numerics::Interpolation::linear;
    target.samples = points;
    for (int i = 0; i < points; ++i) target.control_points.emplace_back(from + (to - from) * i / (points - 1), 0);
    const Eigen::VectorXd y = simulate(parameters, sample_target(target).samples, {});
    EXPECT_TRUE(y.allFinite());
    for (int i = 0; i < points; ++i) target.control_points[static_cast<std::size_t>(i)][1] = factor * y[i];
    return target;
  }

  Polished polished(const Target& target, const Eigen::VectorXd& from, PolishOptions options = {}) const {
    return polish(space(), {{target}, {}, {}}, from, simulate, options);
  }

  neural::Model model;
  neural::Evaluator evaluator;
  Candidates candidates;
  SimulateProfile simulate;
};

/// Expects that accepted designs are simulated improvements within the bounds, and that the reported profile is the
/// simulated one.
void expect_sense(const Family& family, const Polished& polished) {
  double best = std::numeric_limits<double>::infinity();
  for (const PolishRound& round : polished.rounds) {
    EXPECT_TRUE((round.parameters.array() >= family.lower().array() - 1e-12).all());
    EXPECT_TRUE((round.parameters.array() <= family.upper().array() + 1e-12).all());
    if (!round.accepted) {
      EXPECT_FALSE(round.reason.empty());
      continue;
    }
    ASSERT_TRUE(round.target_error);
    EXPECT_LT(*round.target_error, best);
    best = *round.target_error;
  }
  ASSERT_TRUE(polished.target_error);
  EXPECT_EQ(best, *polished.target_error);
  const Eigen::VectorXd again = family.simulate(polished.parameters, polished.targets[0].samples, {});
  EXPECT_TRUE(again.isApprox(polished.simulated[0], 1e-6));
}

TEST(HardPolish, TargetOnTheEdgeOfReach) {
  const Family family("ih67");
  // A design near the stiffest corner of the box that has a structure.
  const Eigen::VectorXd corner = family.lower() + 0.02 * (family.upper() - family.lower());
  const Target target = family.curve_of(corner, -0.04, 0.08);
  const Design found = find_design(family.space(), {{target}, {}, {}});
  const auto polished = family.polished(target, found.parameters);
  expect_sense(family, polished);
  EXPECT_LE(*polished.target_error, 5e-3) << to_string(polished.stopped);
}

TEST(HardPolish, TargetBeyondReachEndsAtTheClosestDesign) {
  const Family family("ih29");
  const Eigen::VectorXd middle = 0.5 * (family.lower() + family.upper());
  const Target target = family.curve_of(middle, -0.03, 0.06, 4, 40);
  const Design found = find_design(family.space(), {{target}, {}, {}});
  const auto polished = family.polished(target, found.parameters, {.max_rounds = 12});
  expect_sense(family, polished);
  EXPECT_TRUE(polished.stopped == PolishTermination::no_improvement ||
              polished.stopped == PolishTermination::round_limit);
  EXPECT_GT(*polished.target_error, 0.1);
}

// The profile jumps where tiles begin to intersect themselves, so that it is chance what a single start reaches. Ten of
// these twelve starts reach a quarter of their deviation with the present model of the family, and eleven did with the
// previous one.
TEST(HardPolish, DesignsAtATileThatCrossesItself) {
  // The discretization error of the coarse mesh is what polish corrects here.
  const Family family("ih01", microscale::Refinement::off);
  const Eigen::Vector4d crossing(0.097405, 0.406142, 0.05, 0.762537);
  const Target target = family.curve_of(crossing, -0.02, 0.06, 5);
  const Eigen::Vector4d width = family.upper() - family.lower();
  int quartered = 0;
  for (const double size : {0.01, 0.02}) {
    for (const Eigen::Vector4d& way :
         {Eigen::Vector4d(1, 1, 1, 1), Eigen::Vector4d(-1, 1, 1, -1), Eigen::Vector4d(1, -1, 1, 1),
          Eigen::Vector4d(1, 1, 0.5, -1), Eigen::Vector4d(-1, -1, 1, 0.3), Eigen::Vector4d(0.7, -0.4, 1, -1)}) {
      const Eigen::VectorXd start = crossing + size * way.cwiseProduct(width);
      const auto polished = family.polished(target, start, {.max_rounds = 16});
      expect_sense(family, polished);
      const double at_start = *polished.rounds.front().target_error;
      EXPECT_GT(at_start, 0.01) << "or nothing is hard";
      EXPECT_LE(*polished.target_error, 0.9 * at_start) << to_string(polished.stopped);
      quartered += *polished.target_error <= 0.25 * at_start ? 1 : 0;
    }
  }
  EXPECT_GE(quartered, 8);
}

TEST(HardPolish, ProfileAcrossABucklingStrain) {
  const Family family("ih50");
  const Eigen::VectorXd wanted = family.lower() + 0.6 * (family.upper() - family.lower());
  const Target target = family.curve_of(wanted, -0.12, 0.06, 7);
  const Design found = find_design(family.space(), {{target}, {}, {}});
  const auto polished = family.polished(target, found.parameters, {.max_rounds = 16});
  expect_sense(family, polished);
  EXPECT_LE(*polished.target_error, 5e-3) << to_string(polished.stopped);
}

TEST(HardPolish, SimulationLeavesTheNetworksBranch) {
  const Family family("ih67");
  const Eigen::VectorXd wanted = family.lower() + 0.5 * (family.upper() - family.lower());
  const Target target = family.curve_of(wanted, -0.04, 0.08);
  const Design found = find_design(family.space(), {{target}, {}, {}});
  // On one side of the wanted design, structures buckle into another branch in compression, which the network does not
  // know.
  int left = 0;
  const SimulateProfile branching = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples,
                                        const Execution& execution) {
    Eigen::VectorXd y = family.simulate(parameters, samples, execution);
    if (parameters[0] < wanted[0] - 1e-4) {
      ++left;
      for (Eigen::Index i = 0; i < y.size(); ++i)
        if (samples.x[static_cast<std::size_t>(i)] < -0.01) y[i] *= 0.6;
    }
    return y;
  };
  const Eigen::VectorXd start = wanted - 0.05 * (family.upper() - family.lower());
  const auto polished = polish(family.space(), {{target}, {}, {}}, start, branching, {.max_rounds = 20});
  EXPECT_GT(left, 0);
  ASSERT_TRUE(polished.target_error);
  EXPECT_LE(*polished.target_error, 5e-3) << "the other branch is left again: " << to_string(polished.stopped);
}

TEST(HardPolish, NothingToImprove) {
  const Family family("ih29");
  const Eigen::VectorXd middle = 0.5 * (family.lower() + family.upper());
  const Target target = family.curve_of(middle, -0.03, 0.06, 4);
  const auto polished = family.polished(target, middle, {.tolerance = 1e-12, .max_rounds = 8});
  expect_sense(family, polished);
  EXPECT_EQ(polished.parameters, middle);
  EXPECT_LT(*polished.target_error, 1e-9) << "it is the target";
}

TEST(HardPolish, DeadlineInTheMiddleOfARound) {
  const Family family("ih67");
  const Eigen::VectorXd wanted = family.lower() + 0.5 * (family.upper() - family.lower());
  Target target = family.curve_of(wanted, -0.04, 0.08);
  target.control_points.back()[1] *= 3;  // no design has this value, so that there is always another round
  const CancellationToken token;
  int rounds = 0;
  std::thread clock;
  const SimulateProfile watched = [&](const Eigen::VectorXd& parameters, const ProfileSamples& samples,
                                      const Execution& execution) {
    if (++rounds == 3)
      clock = std::thread([&] {
        std::this_thread::sleep_for(std::chrono::milliseconds(30));
        token.request(StopReason::deadline);
      });
    return family.simulate(parameters, samples, execution);
  };
  const auto polished = polish(family.space(), {{target}, {}, {}}, wanted, watched, {.tolerance = 1e-9}, {token});
  ASSERT_TRUE(clock.joinable());
  clock.join();
  EXPECT_EQ(polished.stopped, PolishTermination::deadline);
  ASSERT_TRUE(polished.target_error) << "the first rounds were simulated";
  EXPECT_TRUE(polished.simulated[0].allFinite());
  EXPECT_LE(*polished.target_error, *polished.rounds.front().target_error);
}

}  // namespace
}  // namespace supple::design
