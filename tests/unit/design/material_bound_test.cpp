#include "supple/design/material_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "random_compliance.h"
#include "rest_misfit.h"
#include "supple/base/random.h"

namespace supple::design {
namespace {

using std::numbers::pi;
using Curve = std::function<double(double direction)>;

SampledTarget target_of(Task task, const Curve& curve, int samples = 50) {
  SampledTarget target;
  target.samples.task = task;
  target.samples.strain = 0.05;
  target.y.resize(samples);
  target.weights.setConstant(samples, 1.0 / samples);
  target.bands.setZero(samples);
  for (int i = 0; i < samples; ++i) {
    const double direction = pi * i / samples;
    target.samples.x.push_back(direction);
    target.y[i] = curve(direction);
  }
  target.scale = std::max(min_scale(task), std::sqrt(target.y.squaredNorm() / samples));
  return target;
}

SampledTarget stiffness(const Curve& curve) { return target_of(Task::stiffness, curve); }
SampledTarget poisson(const Curve& curve) { return target_of(Task::poisson, curve); }

Curve constant(double value) {
  return [value](double) { return value; };
}

MaterialBounds bounds_of(const std::vector<SampledTarget>& targets, const Compliance& least = Compliance::Zero()) {
  return material_bounds(targets, std::vector<double>(targets.size(), 1), least);
}

double bound_of(const SampledTarget& target, const Compliance& least = Compliance::Zero()) {
  return bounds_of({target}, least).targets.at(0).value().alone.deviation;
}

TEST(RestProfile, IsThatOfTheTangentUnderAUniaxialLoad) {
  RandomStream random("compliances", 1);
  for (int i = 0; i < 20; ++i) {
    const Compliance compliance = random_compliance(random);
    const Eigen::Matrix3d tangent = compliance.inverse();
    const std::vector<double> directions{0, 0.3, 1.2, 2.9};
    for (const Task task : {Task::stiffness, Task::poisson}) {
      const auto values = rest_profile(compliance, task, directions);
      for (std::size_t k = 0; k < directions.size(); ++k) {
        const double expected = profile_value(task, StrainMeasure::green, directions[k], 0, {0, 0, 0}, tangent);
        EXPECT_NEAR(values[static_cast<Eigen::Index>(k)], expected, 1e-8 * (1 + std::abs(expected)));
      }
    }
  }
}

TEST(MaterialBound, IsZeroForEachProfileThatAMaterialHas) {
  RandomStream random("materials", 2);
  for (int i = 0; i < 50; ++i) {
    const Compliance compliance = random_compliance(random);
    std::vector<SampledTarget> targets{stiffness(constant(0)), poisson(constant(0))};
    for (auto& target : targets) {
      target.y = rest_profile(compliance, target.samples.task, target.samples.x);
      target.scale = std::sqrt(target.y.squaredNorm() / 50);
    }
    const auto bounds = bounds_of(targets);
    for (const auto& bound : bounds.targets) EXPECT_LT(bound->alone.deviation, 1e-3) << i;
    EXPECT_LT(bounds.together.value(), 1e-3) << i;
  }
}

TEST(MaterialBound, OfAnIsotropicProfileIsZeroForPoissonsRatiosFromMinusOneToOne) {
  for (const double ratio : {-0.99, -0.9, -0.3, 0.0, 0.3, 0.8, 0.99})
    EXPECT_LT(bound_of(poisson(constant(ratio))), 1e-4) << ratio;
  EXPECT_NEAR(bound_of(poisson(constant(1.2))), 1 / 6.0, 1e-4) << "1 is the nearest";
  EXPECT_NEAR(bound_of(poisson(constant(-1.2))), 1 / 6.0, 1e-4);
  EXPECT_LT(bound_of(stiffness(constant(3))), 1e-6);
}

TEST(MaterialBound, OfProfilesThatNoMaterialHasIsTheKnownOne) {
  EXPECT_NEAR(bound_of(poisson([](double a) { return 0.5 * std::cos(2 * a); })), 0.789, 0.001);
  EXPECT_NEAR(bound_of(stiffness([](double a) { return 1 + 0.4 * std::cos(4 * a); })), 0.0515, 0.0005);
  EXPECT_NEAR(bound_of(stiffness([](double a) { return 0.1 + 0.9 * std::cos(a) * std::cos(a); })), 0.072, 0.001)
      << "a lobe of 10 to 1";
}

/// Least root mean square deviation of materials from the targets that a random search finds.
double random_search(const std::vector<SampledTarget>& targets, const Compliance& least, RandomStream& random) {
  const auto deviation = [&](const Eigen::Matrix3d& factor) {
    const Compliance compliance = least + factor * factor.transpose();
    double squares = 0;
    for (const auto& target : targets) {
      const auto profile = rest_profile(compliance, target.samples.task, target.samples.x);
      squares += std::pow(target.relative_rms(profile).value_or(INFINITY), 2);
    }
    return std::sqrt(squares / static_cast<double>(targets.size()));
  };
  double best = INFINITY;
  for (int start = 0; start < 4; ++start) {
    Eigen::Matrix3d factor = random_compliance(random);
    double current = deviation(factor);
    double step = 0.5;
    for (int i = 0; i < 2000; ++i) {
      Eigen::Matrix3d tried = factor;
      for (int k = 0; k < 9; ++k) tried(k) += step * factor.norm() * random.uniform(-1, 1);
      const double value = deviation(tried);
      if (value < current) {
        current = value;
        factor = tried;
        step *= 1.5;
      } else {
        step = step < 1e-6 ? 0.1 : 0.95 * step;
      }
    }
    best = std::min(best, current);
  }
  return best;
}

TEST(MaterialBound, IsNotUndercutByARandomSearch) {
  RandomStream random("random search", 3);
  for (int i = 0; i < 60; ++i) {
    const double c[] = {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-0.6, 0.6),
                        random.uniform(-0.6, 0.6), random.uniform(-0.4, 0.4)};
    const double turn = random.uniform(0, 3);
    std::vector<SampledTarget> targets;
    if (i % 3 != 1)
      targets.push_back(
          stiffness([&](double a) { return std::exp(c[0] * std::cos(2 * a - turn) + c[1] * std::cos(4 * a)); }));
    if (i % 3 != 0)
      targets.push_back(
          poisson([&](double a) { return c[2] + c[3] * std::cos(2 * a + turn) + c[4] * std::cos(4 * a - turn); }));
    // With every other solid some of these targets are too stiff.
    const Compliance least = i % 2 == 0 ? Compliance::Zero() : solid_compliance(1.5, 0.48);
    const auto bounds = bounds_of(targets, least);
    const double found = targets.size() == 1 ? bounds.targets[0]->alone.deviation : bounds.together.value();
    const Compliance used = i % 3 == 1 ? Compliance::Zero() : least;
    EXPECT_LE(found, 1.001 * random_search(targets, used, random) + 1e-6) << "case " << i;
  }
}

// Rough profiles have several local minima, and Newton's method from two starts may end at a worse one.
TEST(MaterialBound, OfRoughProfilesIsNotThatOfAWorseLocalMinimum) {
  RandomStream random("rough profiles", 4);
  for (int i = 0; i < 60; ++i) {
    std::array<double, 9> c{};
    for (double& one : c) one = random.uniform(-0.5, 0.5);
    const std::vector<SampledTarget> targets{poisson([&](double a) {
      double y = c[0];
      for (int k = 1; k <= 4; ++k) y += c[2 * k - 1] * std::cos(2 * k * a) + c[2 * k] * std::sin(2 * k * a);
      return y;
    })};
    EXPECT_LE(bound_of(targets[0]), 1.001 * random_search(targets, Compliance::Zero(), random)) << "case " << i;
  }
}

TEST(MaterialBound, OfAStiffnessKnowsHowStiffTheSolidIs) {
  const Compliance solid = solid_compliance(26, 0.48);
  const double modulus = 26 / (1 - 0.48 * 0.48);
  const auto bound = bounds_of({stiffness(constant(2 * modulus))}, solid).targets[0];
  EXPECT_NEAR(bound->alone.deviation, 0.5, 1e-4) << "nothing made of the solid is stiffer than the solid";
  EXPECT_NEAR(bound->alone.y[7], modulus, 1e-3);
  EXPECT_LT(bound_of(stiffness(constant(0.9 * modulus)), solid), 1e-4);
  EXPECT_LT(bound_of(poisson(constant(-0.9)), solid), 1e-4) << "softer materials have each Poisson's ratio";
}

TEST(MaterialBound, OfSeveralTargetsIsThatOfOneMaterial) {
  // Where the stiffness is isotropic, so is Poisson's ratio: -S12 = nu S11 varies with S11 alone.
  const auto targets =
      std::vector<SampledTarget>{stiffness(constant(1)), poisson([](double a) { return 0.3 + 0.2 * std::cos(4 * a); })};
  const auto bounds = bounds_of(targets);
  ASSERT_TRUE(bounds.together);
  EXPECT_LT(bounds.targets[0]->alone.deviation, 1e-4);
  EXPECT_GT(*bounds.together, 0.1);
  EXPECT_GE(bounds.targets[0]->together->deviation, bounds.targets[0]->alone.deviation);
  EXPECT_GE(bounds.targets[1]->together->deviation, bounds.targets[1]->alone.deviation);
  const double mean_square =
      0.5 * (std::pow(bounds.targets[0]->together->deviation, 2) + std::pow(bounds.targets[1]->together->deviation, 2));
  EXPECT_NEAR(*bounds.together, std::sqrt(mean_square), 1e-12);
  // A target that hardly counts hardly moves the material that is nearest to the other.
  const auto weighted = material_bounds(targets, {1, 1e-6}, Compliance::Zero());
  EXPECT_LT(weighted.targets[0]->together->deviation, 1e-3);
}

TEST(MaterialBound, CountsBandsAndWeights) {
  auto target = poisson([](double a) { return 0.5 * std::cos(2 * a); });
  target.bands.setConstant(0.6);
  EXPECT_LT(bound_of(target), 1e-9) << "a material without Poisson's ratio is within the band";
  target.bands.setZero();
  target.weights.setZero();
  target.weights[0] = 1;
  target.scale = 0.5;
  EXPECT_LT(bound_of(target), 1e-4) << "only one sample counts";
}

TEST(MaterialBound, IsThatOfProfilesNearRestAlone) {
  auto target = stiffness(constant(1));
  for (const double strain : {-0.05, 0.0, 0.05}) {
    target.samples.strain = strain;
    EXPECT_TRUE(is_bounded(target));
  }
  target.samples.strain = 0.0501;
  EXPECT_FALSE(is_bounded(target));
  auto stress = target_of(Task::stress_strain, constant(1));
  EXPECT_FALSE(is_bounded(stress));
  target.samples.strain = 0.05;
  const auto bounds = bounds_of({stress, target});
  EXPECT_FALSE(bounds.targets[0]);
  ASSERT_TRUE(bounds.targets[1]);
  EXPECT_FALSE(bounds.targets[1]->together || bounds.together) << "there is only one";
}

TEST(MaterialBound, IsFiniteForTargetsThatMakeNoSense) {
  for (const auto& target : {stiffness(constant(-1)), stiffness(constant(0)), stiffness(constant(1e6)),
                             stiffness([](double a) { return std::cos(2 * a); }), poisson(constant(1e6)),
                             poisson([](double a) { return a < 1 ? 1e6 : -1e6; })}) {
    const auto bound = bounds_of({target}, solid_compliance(26, 0.48)).targets[0];
    EXPECT_TRUE(std::isfinite(bound->alone.deviation) && bound->alone.y.allFinite());
    EXPECT_LE(bound->alone.deviation, 1.0001) << "that of a material of almost no stiffness or Poisson's ratio is 1";
  }
}

TEST(RestMisfit, HasTheDerivativesOfItsValue) {
  RandomStream random("derivatives", 4);
  RestMisfit misfit(solid_compliance(3, 0.3), 1);
  misfit.add(stiffness([](double a) { return 1 + 0.4 * std::cos(4 * a); }), 0.7);
  misfit.add(poisson([](double a) { return 0.5 * std::cos(2 * a); }), 0.3);
  for (int i = 0; i < 10; ++i) {
    Vector6 x;
    for (double& entry : x) entry = random.uniform(-1, 1);
    Vector6 gradient;
    Matrix6 hessian;
    misfit.derivatives(x, gradient, hessian);
    constexpr double step = 1e-6;
    for (int k = 0; k < 6; ++k) {
      const Vector6 high = x + step * Vector6::Unit(k);
      const Vector6 low = x - step * Vector6::Unit(k);
      const double slope = (misfit.value(high) - misfit.value(low)) / (2 * step);
      EXPECT_NEAR(gradient[k], slope, 1e-6 * (1 + gradient.norm()));
      Vector6 gradient_high;
      Vector6 gradient_low;
      Matrix6 unused;
      misfit.derivatives(high, gradient_high, unused);
      misfit.derivatives(low, gradient_low, unused);
      EXPECT_LT((hessian.col(k) - (gradient_high - gradient_low) / (2 * step)).norm(), 1e-5 * (1 + hessian.norm()));
    }
  }
}

}  // namespace
}  // namespace supple::design
