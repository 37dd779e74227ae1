#include "rotation_retraction.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "elastic_energy.h"
#include "supple/microscale/simulation.h"
#include "support/drawn_meshes.h"

namespace supple::microscale {
namespace {

using testing::draw;
using testing::equal;

/// A thin beam across the cell.
tiling::PeriodicMesh beam() { return draw({"..........", "##########"}, equal(10, 0.3), {0.2, 2.8}); }

/// A transverse motion of the beam: a wave with no displacement at node 0.
Eigen::VectorXd wave(const tiling::PeriodicMesh& mesh, double amplitude) {
  Eigen::VectorXd step = Eigen::VectorXd::Zero(2 * mesh.nodes.cols() + 4);
  const double period = mesh.lattice(0, 0);
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k)
    step[2 * k + 1] = amplitude * (1 - std::cos(2 * std::numbers::pi * (mesh.nodes(0, k) - mesh.nodes(0, 0)) / period));
  return step;
}

double energy(const tiling::PeriodicMesh& mesh, const Eigen::VectorXd& x) {
  numerics::EnergySum sum;
  ElasticEnergy(mesh, Material{}).add(x, 0, sum);
  return sum.value;
}

TEST(RotationRetraction, StepsThatHardlyTurnAreStraight) {
  const tiling::PeriodicMesh mesh = beam();
  const Eigen::VectorXd step = wave(mesh, 1e-3);
  const Eigen::VectorXd x = wave(mesh, 0.1);
  EXPECT_EQ(RotationRetraction(mesh).retract(x, step), x + step);
}

TEST(RotationRetraction, TheCurveTouchesTheStraightLine) {
  const tiling::PeriodicMesh mesh = beam();
  const RotationRetraction retraction(mesh);
  const Eigen::VectorXd x = wave(mesh, 0.2);
  const Eigen::VectorXd step = wave(mesh, 0.4);
  const double whole = (retraction.retract(x, step) - x - step).norm();
  const double half = (retraction.retract(x, 0.5 * step) - x - 0.5 * step).norm();
  EXPECT_GT(whole, 1e-2 * step.norm());
  EXPECT_NEAR(whole / half, 4, 0.5);
}

TEST(RotationRetraction, TheStrainChangesExactlyByTheSteps) {
  const tiling::PeriodicMesh mesh = beam();
  Eigen::VectorXd step = wave(mesh, 0.4);
  step.tail<4>() << 0.1, -0.3, 0.2, -0.05;
  const Eigen::VectorXd moved = RotationRetraction(mesh).retract(Eigen::VectorXd::Zero(step.size()), step);
  EXPECT_EQ(moved.tail<4>(), step.tail<4>());
  EXPECT_EQ(moved.head<2>(), step.head<2>()) << "the node that is held moved";
}

TEST(RotationRetraction, DisplacementsThatAreFixedMoveByTheirOwnStepsAlone) {
  const tiling::PeriodicMesh mesh = beam();
  const Eigen::VectorXd step = wave(mesh, 0.4);
  std::vector<bool> fixed(static_cast<std::size_t>(2 * mesh.nodes.cols()), false);
  for (const std::size_t dof : {0U, 1U, 9U, 24U}) fixed[dof] = true;
  RotationRetraction retraction(mesh, fixed);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(step.size());
  const Eigen::VectorXd moved = retraction.retract(rest, step);
  EXPECT_GT((moved - step).norm(), 1e-2 * step.norm());
  for (const Eigen::Index dof : {0, 1, 9, 24}) EXPECT_EQ(moved[dof], step[dof]);

  fixed[24] = false;
  fixed[30] = true;
  retraction.fix(fixed);
  const Eigen::VectorXd other = retraction.retract(rest, step);
  EXPECT_NE(other[24], step[24]);
  EXPECT_EQ(other[30], step[30]);
}

TEST(RotationRetraction, APartThatTurnsKeepsItsShape) {
  const tiling::PeriodicMesh mesh = draw({"....", ".##.", ".##.", "...."}, equal(4, 0.3), equal(4, 0.2));
  const double angle = 1.2;
  Eigen::VectorXd step = Eigen::VectorXd::Zero(2 * mesh.nodes.cols() + 4);
  Eigen::VectorXd turned = step;
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k) {
    const Eigen::Vector2d arm = mesh.nodes.col(k) - mesh.nodes.col(0);
    step.segment<2>(2 * k) = angle * Eigen::Vector2d(-arm.y(), arm.x());
    turned.segment<2>(2 * k) = Eigen::Rotation2Dd(angle) * arm - arm;
  }
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(step.size());
  const Eigen::VectorXd moved = RotationRetraction(mesh).retract(rest, step);
  EXPECT_LT((moved - turned).norm(), 1e-6 * turned.norm());
  EXPECT_LT(energy(mesh, moved), 1e-10 * energy(mesh, step));
}

}  // namespace
}  // namespace supple::microscale
