// Materials, orientations and limits that make searches with shipped models hard. Each search ends with a design that
// satisfies the request, or says that there is none.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/design/verified_designs.h"

namespace supple::design {
namespace {

using std::numbers::pi;

struct Shipped {
  explicit Shipped(const std::string& name)
      : model(neural::read_model(std::filesystem::path(SUPPLE_MODELS) / (name + ".h5"))),
        evaluator(model.network),
        candidates(model.network) {}
  DesignSpace space() const { return design_space(model, evaluator, candidates); }
  Eigen::VectorXd at(double share) const {
    return model.network.lower + share * (model.network.upper - model.network.lower);
  }
  Profile profile(const Eigen::VectorXd& parameters, const ProfileSamples& samples) const {
    return evaluate_profile(model, evaluator, {parameters.data(), static_cast<std::size_t>(parameters.size())},
                            samples);
  }
  /// A target that the parameters meet with `factor` times the model's modulus, if the structure is turned by
  /// `orientation`.
  Target target_of(const Eigen::VectorXd& parameters, Task task, double factor = 1, double orientation = 0) const {
    Target target;
    target.task = task;
    target.direction = 0.4;
    target.samples = 12;
    target.interpolation = numerics::Interpolation::linear;
    ProfileSamples samples{task, target.direction, target.strain, StrainMeasure::green, {}, orientation};
    for (int i = 0; i < target.samples; ++i)
      samples.x.push_back(task == Task::stress_strain ? -0.1 + 0.02 * i : pi * i / target.samples);
    const auto y = scaled(profile(parameters, samples), task, factor).y;
    for (int i = 0; i < target.samples; ++i)
      target.control_points.emplace_back(samples.x[static_cast<std::size_t>(i)], y[i]);
    return target;
  }

  neural::Model model;
  neural::Evaluator evaluator;
  Candidates candidates;
};

/// The design with the least deviation, trusted or not. The design that a target was made from may be one at which the
/// model is not trusted.
Design nearest(const Shipped& shipped, const DesignProblem& problem) {
  DesignOptions options;
  options.trust = Switch::off;
  return find_design(shipped.space(), problem, options);
}

TEST(HardFreedoms, ModuliOverTwelvePowersOfTen) {
  const Shipped shipped("ih67");
  for (const double factor : {1e-5, 1.0, 3e4}) {
    DesignProblem problem{{shipped.target_of(shipped.at(0.4), Task::stiffness, factor)}, {}, {}};
    problem.moduli = {{1e-6, 1e6}};
    const auto design = nearest(shipped, problem);
    EXPECT_LT(design.error.relative_rms, 1e-3) << factor;
    EXPECT_NEAR(std::log(design.youngs_modulus / (26 * factor)), 0, 1.5) << factor;
  }
}

TEST(HardFreedoms, ATargetThatNoModulusCanReach) {
  const Shipped shipped("ih67");
  auto target = shipped.target_of(shipped.at(0.4), Task::stress_strain);
  for (auto& point : target.control_points) point[1] = -point[1];
  DesignProblem problem{{target}, {}, {}};
  problem.moduli = {{1, 100}};
  const auto design = find_design(shipped.space(), problem);
  EXPECT_EQ(design.youngs_modulus, 1) << "stresses of the wrong sign: the softest is nearest";
  EXPECT_NE(design.message.find("Young's modulus is at its lower limit."), std::string::npos) << design.message;
}

TEST(HardFreedoms, ATargetOfZeros) {
  const Shipped shipped("ih67");
  auto target = shipped.target_of(shipped.at(0.4), Task::stress_strain);
  for (auto& point : target.control_points) point[1] = 0;
  DesignProblem problem{{target}, {}, {}};
  problem.moduli = {{1e-3, 100}};
  const auto design = find_design(shipped.space(), problem);
  EXPECT_EQ(design.youngs_modulus, 1e-3);
  EXPECT_TRUE(std::isfinite(design.error.relative_rms));
}

TEST(HardFreedoms, BandsInWhichEveryModulusOfARangeLies) {
  const Shipped shipped("ih67");
  auto target = shipped.target_of(shipped.at(0.4), Task::stiffness);
  for (const auto& point : target.control_points) target.bands.push_back(0.5 * point[1]);
  DesignProblem problem{{target}, {}, {}};
  problem.moduli = {{20, 35}};
  const auto design = find_design(shipped.space(), problem);
  EXPECT_EQ(design.error.relative_rms, 0);
  EXPECT_TRUE(design.reached);
}

/// Poisson's ratio does not depend on the modulus.
TEST(HardFreedoms, AModulusOnWhichNothingDepends) {
  const Shipped shipped("ih67");
  DesignProblem problem{{shipped.target_of(shipped.at(0.4), Task::poisson)}, {}, {}};
  problem.moduli = {{3, 7}, {2, 2}};
  const auto design = nearest(shipped, problem);
  EXPECT_LT(design.error.relative_rms, 1e-3);
  EXPECT_EQ(design.material, 0U);
  EXPECT_EQ(design.youngs_modulus, 3);
}

/// Turning a structure changes nothing of an isotropic response, so that the column of the Jacobian vanishes.
TEST(HardFreedoms, AnOrientationThatChangesNothing) {
  const Shipped shipped("ih67");
  auto target = shipped.target_of(shipped.at(0.4), Task::stiffness);
  for (auto& point : target.control_points) point[1] = 1;
  DesignProblem problem{{target}, {}, {}};
  problem.orientation = {0, pi};
  DesignProblem held = problem;
  held.orientation = {0, 0};
  const auto turned = find_design(shipped.space(), problem);
  const auto straight = find_design(shipped.space(), held);
  EXPECT_LE(turned.error.relative_rms, straight.error.relative_rms * (1 + 1e-6)) << "a freedom more";
}

TEST(HardFreedoms, OrientationsAtTheEndsOfTheirRange) {
  const Shipped shipped("ih01");
  for (const double orientation : {0.0, 1e-9, pi - 1e-9, pi}) {
    DesignProblem problem{{shipped.target_of(shipped.at(0.55), Task::stiffness, 1, orientation)}, {}, {}};
    problem.orientation = {0, pi};
    const auto design = nearest(shipped, problem);
    EXPECT_LT(design.error.relative_rms, 0.02) << orientation;
    EXPECT_GE(design.orientation, 0);
    EXPECT_LE(design.orientation, pi);
  }
}

TEST(HardFreedoms, OrientationModulusAndParametersAtOnce) {
  const Shipped shipped("ih67");
  DesignProblem problem{{shipped.target_of(shipped.at(0.4), Task::stiffness, 12, 0.8),
                         shipped.target_of(shipped.at(0.4), Task::poisson, 12, 0.8)},
                        {},
                        {}};
  problem.moduli = {{26, 2600}};
  problem.orientation = {0, pi};
  const auto design = nearest(shipped, problem);
  EXPECT_LT(design.error.relative_rms, 2e-3);
}

TEST(HardFreedoms, ALimitThatLeavesOneDensity) {
  const Shipped shipped("ih67");
  const auto space = shipped.space();
  const double density = space.measure(shipped.at(0.5)).relative_density;
  DesignProblem problem{{shipped.target_of(shipped.at(0.4), Task::stiffness)}, {}, {}};
  problem.limits.relative_density = {density * (1 - 1e-4), density * (1 + 1e-4)};
  const auto design = find_design(space, problem);
  EXPECT_NEAR(space.measure(design.parameters).relative_density, density, 1.01e-4 * density);
}

/// The lightest and the densest structure of a family are at corners of its box, or where holes are about to close.
TEST(HardFreedoms, LimitsAtTheEdgeOfWhatAFamilyHas) {
  for (const char* const name : {"ih01", "ih22", "ih67"}) {
    const Shipped shipped(name);
    const auto space = shipped.space();
    DesignProblem problem{{shipped.target_of(shipped.at(0.5), Task::stiffness)}, {}, {}};
    const DesignOptions few{.starts = 6};
    const auto free = find_design(space, problem, few);
    const double density = space.measure(free.parameters).relative_density;
    for (const double most : {0.95 * density, 0.7 * density, 0.5 * density, 0.01}) {
      problem.limits.relative_density.most = most;
      try {
        const auto design = find_design(space, problem, few);
        EXPECT_LE(space.measure(design.parameters).relative_density, most) << name;
        EXPECT_GE(design.error.relative_rms, free.error.relative_rms - 1e-6) << name;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), "design.beyond_limits") << name << " " << error.what();
        EXPECT_LT(most, 0.8 * density) << name << " " << error.what();
      }
    }
  }
}

TEST(HardFreedoms, AStartBeyondTheLimits) {
  const Shipped shipped("ih67");
  const auto space = shipped.space();
  DesignProblem problem{{shipped.target_of(shipped.at(0.4), Task::stiffness)}, {}, {}};
  problem.initial = shipped.at(0.4);
  const double density = space.measure(*problem.initial).relative_density;
  problem.limits.relative_density.most = 0.85 * density;
  const auto design = find_design(space, problem, {.multi_start = Switch::off});
  EXPECT_LE(space.measure(design.parameters).relative_density, 0.85 * density);
}

}  // namespace
}  // namespace supple::design
