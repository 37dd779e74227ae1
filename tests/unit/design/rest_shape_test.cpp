#include "supple/design/rest_shape.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "random_compliance.h"

namespace supple::design {
namespace {

using std::numbers::pi;

/// The compliance as a matrix in Kelvin's notation, whose Frobenius norm does not depend on the axes.
Eigen::Matrix3d kelvin(const Compliance& compliance) {
  const Eigen::Vector3d factors(1, 1, 1 / std::sqrt(2));
  return factors.asDiagonal() * compliance * factors.asDiagonal();
}

/// A material that is turned counterclockwise by an angle, by the transformation of stresses.
Compliance turned(const Compliance& compliance, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  Eigen::Matrix3d to_material;  // stress in the material's axes from that in space
  to_material << c * c, s * s, 2 * c * s, s * s, c * c, -2 * c * s, -c * s, c * s, c * c - s * s;
  return to_material.transpose() * compliance * to_material;
}

const ReferenceProfile& reference(std::string_view name) {
  for (const auto& profile : reference_profiles())
    if (profile.name == name) return profile;
  throw std::runtime_error("no such profile");
}

TEST(RestShape, IsTheSameForAMaterialThatIsTurnedAndScaled) {
  RandomStream random("rest_shape", 1);
  for (int k = 0; k < 50; ++k) {
    const Compliance compliance = random_compliance(random, 0.05);
    const RestShape shape(compliance);
    EXPECT_NEAR(shape.distance(RestShape(7.5 * turned(compliance, random.uniform(0, pi)))), 0, 1e-5);
    EXPECT_NEAR(shape.distance(shape), 0, 1e-7);
  }
}

TEST(RestShape, DistanceIsTheLeastDifferenceOfNormalizedMatricesOverAllAngles) {
  RandomStream random("rest_shape", 2);
  for (int k = 0; k < 50; ++k) {
    const Compliance a = random_compliance(random, 0.05), b = random_compliance(random, 0.05);
    double least = 10;
    for (int step = 0; step < 3600; ++step) {
      const Eigen::Matrix3d other = kelvin(turned(b, pi * step / 3600));
      least = std::min(least, (kelvin(a) / kelvin(a).norm() - other / other.norm()).norm());
    }
    const double distance = RestShape(a).distance(RestShape(b));
    EXPECT_NEAR(distance, least, 1e-5);
    EXPECT_LE(distance, least + 1e-12);
    EXPECT_NEAR(distance, RestShape(b).distance(RestShape(a)), 1e-9);
    EXPECT_LE(RestShape(a).min_distance(RestShape(b)), distance + 1e-12);
  }
}

TEST(ReferenceProfile, OfAnIsotropicRatioIsMetByTheIsotropicMaterialAlone) {
  const auto isotropic = [](double ratio) {
    Compliance compliance;
    compliance << 1, -ratio, 0, -ratio, 1, 0, 0, 0, 2 * (1 + ratio);
    return compliance;
  };
  const auto met = distance(isotropic(-0.5), reference("poisson_-0.5"));
  EXPECT_NEAR(met.deviation, 0, 1e-12);
  EXPECT_TRUE(met.is_met);
  EXPECT_NEAR(distance(isotropic(-0.4), reference("poisson_-0.5")).deviation, 0.2, 1e-9);
  // Near 0 a deviation of 0.02 counts as met, although it is 20 % of the least scale.
  const auto near = distance(isotropic(0.019), reference("poisson_0"));
  EXPECT_NEAR(near.deviation, 0.19, 1e-9);
  EXPECT_TRUE(near.is_met);
  EXPECT_FALSE(distance(isotropic(0.03), reference("poisson_0")).is_met);
  EXPECT_NEAR(distance(isotropic(0.3), reference("stiffness_isotropic")).deviation, 0, 1e-12);
}

TEST(ReferenceProfile, OfStiffnessIsFoundAtAnyAngleAndSize) {
  // 1 / (c^2 + 5 s^2): the stiffness of an elliptic material.
  Compliance elliptic;
  elliptic << 1, 0, 0, 0, 5, 0, 0, 0, 6;
  for (const double angle : {0.0, 0.4, 1.5, 3.1}) {
    const auto found = distance(0.01 * turned(elliptic, angle), reference("stiffness_elliptic_5"));
    EXPECT_NEAR(found.deviation, 0, 1e-3) << angle;
    // The material is turned back.
    EXPECT_NEAR(std::remainder(found.orientation + angle, pi), 0, 1e-3) << angle;
  }
  EXPECT_GT(distance(elliptic, reference("stiffness_elliptic_10")).deviation, 0.05);
}

}  // namespace
}  // namespace supple::design
