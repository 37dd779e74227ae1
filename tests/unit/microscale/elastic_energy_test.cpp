#include "elastic_energy.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "jacobian_bounds.h"
#include "patch_stability.h"
#include "supple/numerics/system.h"
#include "support/drawn_meshes.h"

namespace supple::microscale {
namespace {

using testing::draw;
using testing::equal;
using testing::random_motion;

constexpr Law laws[] = {Law::neo_hookean, Law::incompressible_plane_stress};

/// A skew frame with a hole. It has so few triangles that dense matrices can be compared.
tiling::PeriodicMesh skew_frame() {
  const Eigen::Matrix2d skew = (Eigen::Matrix2d() << 1, 0.2, 0, 0.9).finished();
  return draw({"###", "#.#", "###"}, {0.3, 0.5, 0.2}, {0.25, 0.4, 0.35}, skew);
}

Material of(Law law) {
  Material material;
  material.law = law;
  return material;
}

TEST(ElasticEnergy, HasTheDerivativesOfItsValueAtModerateAndExtremeStates) {
  const tiling::PeriodicMesh mesh = skew_frame();
  for (const Law law : laws) {
    ElasticEnergy energy(mesh, of(law));
    RandomStream random("elastic energy", 1);
    for (const double size : {0.0, 0.01, 0.1, 0.3}) {
      Eigen::VectorXd x = random_motion(mesh, 0.1 * size, size, random);
      if (size == 0) x.setZero();
      numerics::DerivativeCheckOptions options;
      options.step = 1e-3;
      const auto check = numerics::check_derivatives<CellState>(energy, x, options);
      // At rest, the gradient is exactly zero, and the error is an absolute one.
      EXPECT_LT(check.gradient.error, 1e-7) << to_string(law) << " " << size << ": " << check.summary();
      EXPECT_LT(check.hessian.error, 1e-7) << to_string(law) << " " << size << ": " << check.summary();
    }
  }
}

TEST(ElasticEnergy, OfAUniformDeformationIsTheLawTimesTheSolidArea) {
  const tiling::PeriodicMesh mesh = skew_frame();
  const Material material;
  const double mu = material.youngs_modulus / (2 * (1 + material.poisson_ratio));
  const double lambda = 2 * mu * material.poisson_ratio / (1 - 2 * material.poisson_ratio);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * mesh.nodes.cols() + 4);
  x.tail<4>() << 0.3, 0.1, -0.2, -0.25;
  const Eigen::Matrix2d f = (Eigen::Matrix2d() << 1.3, 0.1, -0.2, 0.75).finished();
  const double j = f.determinant();
  numerics::EnergySum sum;
  ElasticEnergy(mesh, material).add(x, 0, sum);
  const double psi = mu / 2 * (f.squaredNorm() - 2 - 2 * std::log(j)) + lambda / 2 * std::pow(std::log(j), 2);
  EXPECT_NEAR(sum.value, psi * mesh.solid_area(), 1e-12 * sum.value);

  numerics::EnergySum sheet;
  ElasticEnergy(mesh, of(Law::incompressible_plane_stress)).add(x, 0, sheet);
  const double sheet_psi = material.youngs_modulus / 6 * (f.squaredNorm() + 1 / (j * j) - 3);
  EXPECT_NEAR(sheet.value, sheet_psi * mesh.solid_area(), 1e-12 * sheet.value);
}

TEST(ElasticEnergy, HasAScaleOfForcesWhichIsTheSumInSquaresOfWhatTrianglesAdd) {
  const tiling::PeriodicMesh mesh = skew_frame();
  const Material material;
  const double mu = material.youngs_modulus / (2 * (1 + material.poisson_ratio));
  const double lambda = 2 * mu * material.poisson_ratio / (1 - 2 * material.poisson_ratio);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * mesh.nodes.cols() + 4);
  x.tail<4>() << 0.3, 0.1, -0.2, -0.25;
  const Eigen::Matrix2d f = (Eigen::Matrix2d() << 1.3, 0.1, -0.2, 0.75).finished();
  const Eigen::Matrix2d inverse = f.inverse().transpose();
  const Eigen::Matrix2d stress = mu * (f - inverse) + lambda * std::log(f.determinant()) * inverse;
  // In a triangle with the uniform stress P, the force on a corner is a third of area P g, and that on the midpoint of
  // a side is four thirds of area P (g + h). g and h are the gradients of the barycentric coordinates of the corner and
  // of the next one.
  double sum = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    Eigen::Matrix3d corners = Eigen::Matrix3d::Ones();
    for (int k = 0; k < 3; ++k) corners.block<2, 1>(0, k) = mesh.corner(t, k);
    const double area = std::abs(corners.determinant()) / 2;
    const Eigen::Matrix<double, 3, 2> gradients = corners.inverse().leftCols<2>();
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector2d g = gradients.row(k);
      const Eigen::Vector2d h = gradients.row((k + 1) % 3);
      sum += (area / 3 * stress * g).squaredNorm() + (4 * area / 3 * stress * (g + h)).squaredNorm();
    }
  }
  EXPECT_NEAR(ElasticEnergy(mesh, material).force_scale(x), std::sqrt(sum), 1e-4 * std::sqrt(sum));
}

TEST(ElasticEnergy, KeepsItsDigitsAtTinyStrains) {
  const tiling::PeriodicMesh mesh = skew_frame();
  const ElasticEnergy energy(mesh, Material{});
  RandomStream random("tiny strains", 0);
  const Eigen::VectorXd direction = random_motion(mesh, 0.1, 1, random);
  const auto value = [&](double size) {
    numerics::EnergySum sum;
    energy.add(Eigen::VectorXd(size * direction), 0, sum);
    return sum.value / (size * size);
  };
  // The energy is quadratic near rest: divided by the square of the size, it differs from its limit linearly in the
  // size.
  EXPECT_NEAR(value(1e-7), value(2e-6), 1e-5 * value(1e-7));
  EXPECT_NEAR(value(1e-5), value(2e-6), 1e-3 * value(1e-5));
}

TEST(ElasticEnergy, ChangesNothingUnderRotationsAndTranslations) {
  const tiling::PeriodicMesh mesh = skew_frame();
  for (const Law law : laws) {
    ElasticEnergy energy(mesh, of(law));
    RandomStream random("rotations", 0);
    const Eigen::VectorXd x = random_motion(mesh, 0.02, 0.1, random);
    const double angle = 0.7;
    const Eigen::Matrix2d rotation =
        (Eigen::Matrix2d() << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle)).finished();
    const CellCoordinates coordinates{mesh.nodes.cols()};
    Eigen::VectorXd rotated = x;
    for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k)
      rotated.segment<2>(2 * k) = rotation * x.segment<2>(2 * k) + Eigen::Vector2d(0.3, -2);
    const Eigen::Matrix2d f = rotation * coordinates.deformation_gradient(x);
    rotated.tail<4>() << f(0, 0) - 1, f(0, 1), f(1, 0), f(1, 1) - 1;
    numerics::EnergySum one;
    numerics::EnergySum other;
    energy.add(x, 0, one);
    energy.add(rotated, 0, other);
    EXPECT_NEAR(one.value, other.value, 1e-12 * one.value) << to_string(law);
  }
}

TEST(ElasticEnergy, IsInfiniteWhereATriangleIsInverted) {
  const tiling::PeriodicMesh mesh = skew_frame();
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * mesh.nodes.cols() + 4);
  x[x.size() - 4] = -1.5;
  numerics::EnergySum sum;
  ElasticEnergy(mesh, Material{}).add(x, 0, sum);
  EXPECT_EQ(sum.value, std::numeric_limits<double>::infinity());
}

TEST(ElasticEnergy, LetsAStepGoShortOfTheFirstInversionAndNotMuchShorter) {
  const tiling::PeriodicMesh mesh = skew_frame();
  const ElasticEnergy energy(mesh, Material{});
  RandomStream random("inversions", 0);
  int bounded = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::VectorXd x = random_motion(mesh, 0.01, 0.05, random);
    const Eigen::VectorXd step = random_motion(mesh, 0.3, 0.5, random);
    const double largest = energy.largest_inversion_free_step(x, step);
    const auto valid = [&](double t) {
      numerics::EnergySum sum;
      energy.add(Eigen::VectorXd(x + t * step), 0, sum);
      return std::isfinite(sum.value);
    };
    for (const double share : {0.25, 0.5, 1.0}) EXPECT_TRUE(valid(std::min(1.0, largest) * share)) << trial;
    if (largest >= 1) continue;
    ++bounded;
    EXPECT_FALSE(valid(1.12 * largest)) << trial;
  }
  EXPECT_GT(bounded, 10) << "too few of the steps invert anything";
}

TEST(ElasticEnergy, FindsTheLeastJacobianOverWholeTriangles) {
  RandomStream random("jacobians", 0);
  for (int trial = 0; trial < 200; ++trial) {
    Eigen::Matrix<double, 2, 3> gradients;
    gradients.col(1) << 1, 0.2;
    gradients.col(2) << -0.1, 1.3;
    gradients.col(0) = -gradients.col(1) - gradients.col(2);
    Eigen::Matrix<double, 2, 6> displacements;
    for (int k = 0; k < 6; ++k) displacements.col(k) << random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3);
    const Eigen::Matrix2d strain = Eigen::Matrix2d::Identity() * random.uniform(-0.1, 0.1);
    double sampled = std::numeric_limits<double>::infinity();
    const int n = 60;
    for (int a = 0; a <= n; ++a)
      for (int b = 0; a + b <= n; ++b) {
        const double l[3] = {1.0 * a / n, 1.0 * b / n, 1.0 * (n - a - b) / n};
        Eigen::Matrix2d f = Eigen::Matrix2d::Identity() + strain;
        for (int k = 0; k < 3; ++k) {
          const int next = (k + 1) % 3;
          f += displacements.col(k) * ((4 * l[k] - 1) * gradients.col(k)).transpose();
          f += displacements.col(3 + k) * (4 * l[k] * gradients.col(next) + 4 * l[next] * gradients.col(k)).transpose();
        }
        sampled = std::min(sampled, f.determinant());
      }
    const double found = smallest_quadratic_jacobian(gradients, displacements, strain);
    EXPECT_LE(found, sampled + 1e-12);
    EXPECT_NEAR(found, sampled, 5e-3);
  }
}

TEST(ElasticEnergy, AlternatingHessiansAreThoseOfTheTwoByTwoPatch) {
  const tiling::PeriodicMesh mesh = skew_frame();
  const tiling::PeriodicMesh patch = tiling::repeat(mesh, 2, 2);
  const ElasticEnergy one(mesh, Material{});
  const ElasticEnergy four(patch, Material{});
  RandomStream random("alternation", 0);
  const Eigen::VectorXd x = random_motion(mesh, 0.02, 0.1, random);
  const Eigen::VectorXd repeated = repeat_over_patch(x);
  numerics::EnergySum sum;
  sum.gradient.setZero(repeated.size());
  four.add(repeated, 2, sum);
  const numerics::SparseMatrix whole = sum.hessian.matrix(repeated.size());
  AlternatingEntries entries;
  one.add_alternating_hessians(x, entries);
  for (std::size_t a = 0; a < alternations.size(); ++a) {
    const Alternation alternation = alternations[a];
    const Eigen::Index n = 2 * mesh.nodes.cols();
    const numerics::SparseMatrix block = entries[a].matrix(n);
    const Eigen::VectorXd mode = Eigen::VectorXd::NullaryExpr(n, [&random] { return random.normal(); });
    const Eigen::VectorXd spread = repeat_over_patch({alternation, mode, 0});
    Eigen::VectorXd expected = repeat_over_patch({alternation, block * mode, 0});
    Eigen::VectorXd got = whole * spread;
    // Modes that alternate have no coupling with the macroscopic strain.
    EXPECT_LT(got.tail<4>().norm(), 1e-10 * got.norm());
    got.tail<4>().setZero();
    EXPECT_LT((got - expected).norm(), 1e-12 * expected.norm()) << alternation.first << " " << alternation.second;
  }
}

}  // namespace
}  // namespace supple::microscale
