// Targets that are hard to meet or almost meaningless, with every shipped model. Each search ends with a reason and
// finite numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "supple/base/error.h"
#include "supple/base/random.h"
#include "supple/design/inverse_design.h"

namespace supple::design {
namespace {

using std::numbers::pi;

struct Loaded {
  explicit Loaded(const std::string& name)
      : model(neural::read_model(std::filesystem::path(SUPPLE_MODELS) / (name + ".h5"))),
        evaluator(model.network),
        candidates(model.network) {}
  DesignSpace space() const { return {model, evaluator, candidates}; }
  neural::Model model;
  neural::Evaluator evaluator;
  Candidates candidates;
};

std::vector<std::string> shipped_models() {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(SUPPLE_MODELS))
    if (entry.path().extension() == ".h5") names.push_back(entry.path().stem().string());
  std::sort(names.begin(), names.end());
  return names;
}

class HardTargets : public ::testing::TestWithParam<std::string> {
 protected:
  HardTargets() : loaded_(GetParam()) {}

  Eigen::VectorXd lower() const { return loaded_.model.network.lower; }
  Eigen::VectorXd upper() const { return loaded_.model.network.upper; }
  Eigen::VectorXd middle() const { return 0.5 * (lower() + upper()); }

  /// A target that the parameters meet. Over strain, its 8 samples reach from -reach / 2 to `reach`.
  Target target_of(const Eigen::VectorXd& parameters, Task task, double strain = 0.05, double reach = 0.2) const {
    Target target;
    target.task = task;
    target.direction = 0.4;
    target.strain = strain;
    target.interpolation = numerics::Interpolation::linear;
    target.samples = 8;
    ProfileSamples samples{task, target.direction, strain, StrainMeasure::green, {}};
    for (int i = 0; i < 8; ++i)
      samples.x.push_back(task == Task::stress_strain ? -0.5 * reach + 1.5 * reach * i / 7 : pi * i / 8);
    const std::vector<double> values(parameters.begin(), parameters.end());
    const auto profile = evaluate_profile(loaded_.model, loaded_.evaluator, values, samples);
    for (int i = 0; i < 8; ++i)
      target.control_points.emplace_back(samples.x[static_cast<std::size_t>(i)],
                                         std::isfinite(profile.y[i]) ? profile.y[i] : 0);
    return target;
  }

  Design find(const DesignProblem& problem, const DesignOptions& options = {}) const {
    auto design = find_design(loaded_.space(), problem, options);
    EXPECT_TRUE(design.parameters.allFinite());
    EXPECT_TRUE(((design.parameters - lower()).array() >= 0).all() &&
                ((upper() - design.parameters).array() >= 0).all());
    EXPECT_TRUE(std::isfinite(design.error.relative_rms) && std::isfinite(design.error.max));
    for (const auto& profile : design.profiles) EXPECT_TRUE(profile.achieved.allFinite());
    EXPECT_LE(design.residual, options.equilibrium_tolerance);
    EXPECT_TRUE(design.reached || !design.message.empty()) << "a target out of reach is said so";
    return design;
  }

  Loaded loaded_;
};
INSTANTIATE_TEST_SUITE_P(, HardTargets, ::testing::ValuesIn(shipped_models()),
                         [](const auto& name) { return name.param; });

// The optimum is at the bounds, where the projected gradient vanishes and the gradient does not.
TEST_P(HardTargets, ADesignInACornerOfTheBoxIsFoundFromTheOppositeOne) {
  DesignProblem problem{{target_of(upper(), Task::stiffness)}, lower(), {}};
  const auto design = find(problem);
  EXPECT_LT(design.error.relative_rms, 0.01) << design.message;
}

// In a corner half of the directions along each parameter lead out of the box.
TEST_P(HardTargets, ASearchStartsInEveryCorner) {
  const auto target = target_of(middle(), Task::stress_strain);
  const auto n = lower().size();
  for (long bits = 0; bits < 1L << n; ++bits) {
    Eigen::VectorXd corner(n);
    for (long k = 0; k < n; ++k) corner[k] = (bits >> k & 1) != 0 ? upper()[k] : lower()[k];
    EXPECT_LT(find({{target}, corner, {}}).error.relative_rms, 0.01) << corner.transpose();
  }
}

// The targets contradict each other: the same direction should be stiff and soft.
TEST_P(HardTargets, ContradictoryTargetsEndInACompromise) {
  auto soft = target_of(middle(), Task::stress_strain);
  auto stiff = soft;
  for (auto& point : soft.control_points) point[1] *= 0.5;
  for (auto& point : stiff.control_points) point[1] *= 2;
  const auto design = find({{soft, stiff}, {}, {}});
  EXPECT_FALSE(design.reached);
  EXPECT_NE(design.stopped, DesignTermination::reached);
}

// The residuals stay large, so that Gauss-Newton models alone converge slowly.
TEST_P(HardTargets, ATargetAThousandTimesTooStiffEndsAtTheClosestDesign) {
  auto target = target_of(middle(), Task::stiffness);
  for (auto& point : target.control_points) point[1] *= 1000;
  const auto design = find({{target}, {}, {}});
  EXPECT_FALSE(design.reached);
  EXPECT_NE(design.stopped, DesignTermination::iteration_limit);
}

// Every design meets the target, and the gradient vanishes everywhere.
TEST_P(HardTargets, AFlatObjectiveEndsWhereItStarts) {
  auto target = target_of(middle(), Task::poisson);
  target.bands.assign(target.control_points.size(), 1e3);
  const auto design = find({{target}, middle(), {}});
  EXPECT_EQ(design.stopped, DesignTermination::reached);
  EXPECT_EQ(design.parameters, middle());
}

// The root mean square of a zero target is no scale for deviations.
TEST_P(HardTargets, PoissonsRatioZeroInAllDirectionsIsAsked) {
  auto target = target_of(middle(), Task::poisson);
  for (auto& point : target.control_points) point[1] = 0;
  find({{target}, {}, {}});
}

// Near rest the stress is as small as its rounding errors.
TEST_P(HardTargets, StiffnessAtRestAndAtVanishingStrainAreTheSame) {
  for (const double strain : {0.0, 1e-12, 1e-7}) {
    const auto design = find({{target_of(middle(), Task::stiffness, strain)}, {}, {}});
    EXPECT_LT(design.error.relative_rms, 0.01) << strain;
  }
}

// Strains up to the end of the training data.
TEST_P(HardTargets, StrainsAtTheEdgeOfTheRange) {
  // Uniaxial training data end at a stretch of 1.5, a Green strain of 0.625. Biaxial data may go farther.
  const double most = 0.98 * std::min(0.625, loaded_.model.strain_range.largest_principal);
  // The target's own design has samples at which the energy exceeds that of the training data.
  DesignOptions options;
  options.trust = Switch::off;
  const auto design = find({{target_of(middle(), Task::stress_strain, 0.05, most)}, {}, {}}, options);
  EXPECT_LT(design.error.relative_rms, 0.05) << design.message;
}

// Beyond the training data, results are finite and flagged, or the search says that there is no equilibrium.
TEST_P(HardTargets, StrainsFarOutOfTheRangeAreFlagged) {
  // Beyond all simulations of the family. Some lattices expand far sideways.
  const double far = std::max(1.5, 1.2 * loaded_.model.strain_range.largest_principal);
  const auto target = target_of(middle(), Task::stiffness, far);
  try {
    const auto design = find_design(loaded_.space(), {{target}, middle(), {}});
    const auto& in_range = design.profiles[0].in_range;
    EXPECT_EQ(std::count(in_range.begin(), in_range.end(), 1), 0);
    EXPECT_TRUE(design.profiles[0].achieved.allFinite());
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "design.no_equilibrium");
  }
}

// Many families buckle in compression, with nearly singular tangents along the path.
TEST_P(HardTargets, DeepCompressionWithNearlySingularTangents) {
  for (const Task task : {Task::stiffness, Task::poisson}) {
    const auto design = find({{target_of(middle(), task, -0.2)}, {}, {}});
    EXPECT_NE(design.stopped, DesignTermination::iteration_limit);
  }
}

// Noise in every sample causes many shallow minima.
TEST_P(HardTargets, ANoisyTargetIsFittedAsCloselyAsItsNoise) {
  constexpr std::uint64_t seed = 11;
  RandomStream random("noisy target", seed);
  auto target = target_of(middle(), Task::stiffness);
  for (auto& point : target.control_points) point[1] *= 1 + 0.1 * random.normal();
  EXPECT_LT(find({{target}, {}, {}}).error.relative_rms, 0.2) << "seed " << seed;
}

}  // namespace
}  // namespace supple::design
