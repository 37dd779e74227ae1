#include "contact_barrier.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <map>

#include "contact_geometry.h"
#include "supple/base/error.h"
#include "supple/numerics/system.h"
#include "support/drawn_meshes.h"

namespace supple::microscale {
namespace {

using testing::wall;

const ContactOptions options{.stiffness = 3, .range = 0.06, .rest_fraction = 0.6};

double energy(const ContactBarrier& barrier, const Eigen::VectorXd& x) {
  numerics::EnergySum sum;
  barrier.add(x, 0, sum);
  return sum.value;
}

Eigen::VectorXd gradient(const ContactBarrier& barrier, const Eigen::VectorXd& x) {
  numerics::EnergySum sum;
  sum.gradient.setZero(x.size());
  barrier.add(x, 1, sum);
  return sum.gradient;
}

Eigen::MatrixXd hessian(const ContactBarrier& barrier, const Eigen::VectorXd& x) {
  numerics::EnergySum sum;
  sum.gradient.setZero(x.size());
  barrier.add(x, 2, sum);
  return sum.hessian.matrix(x.size());
}

Eigen::VectorXd rest(const tiling::PeriodicMesh& mesh) { return Eigen::VectorXd::Zero(2 * mesh.nodes.cols() + 4); }

void hold(ContactBarrier& barrier, const Eigen::VectorXd& x) {
  barrier.prepare_step(x, Eigen::VectorXd::Zero(x.size()));
}

/// The state in which the lattice deforms by f, and the pieces in the cell at the origin keep their shape and place.
Eigen::VectorXd move_images(const tiling::PeriodicMesh& mesh, const Eigen::Matrix2d& f) {
  Eigen::VectorXd x = rest(mesh);
  x.tail<4>() << f(0, 0) - 1, f(0, 1), f(1, 0), f(1, 1) - 1;
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k)
    x.segment<2>(2 * k) = (Eigen::Matrix2d::Identity() - f) * mesh.nodes.col(k);
  return x;
}

/// The state of a wall of width 1 in which the gap to its next image is `gap`, and the image is moved up by `slide`.
Eigen::VectorXd press(const tiling::PeriodicMesh& mesh, double gap, double slide = 0) {
  const double period = mesh.lattice(0, 0);
  return move_images(mesh, (Eigen::Matrix2d() << (1 + gap) / period, 0, slide / period, 1).finished());
}

/// A state with more than eight pairs in contact, which is reached by random steps that contact shortens.
Eigen::VectorXd tangle(const tiling::PeriodicMesh& mesh, ContactBarrier& barrier, RandomStream& random) {
  Eigen::VectorXd x = rest(mesh);
  for (int attempt = 0; attempt < 100; ++attempt) {
    const Eigen::VectorXd step = testing::random_motion(mesh, 0.1, 0.04, random);
    for (int k = 0; k < 3; ++k) x += 0.8 * barrier.prepare_step(x, step) * step;
    hold(barrier, x);
    const ContactStatus status = barrier.status(x);
    if (status.pairs > 8 && status.smallest_ratio > 0.05) return x;
  }
  ADD_FAILURE() << "nothing met";
  return x;
}

TEST(ContactBarrier, OfAnotherRangeIsAsIfItHadBeenMadeWithIt) {
  RandomStream random("contact_barrier range", 1);
  const tiling::PeriodicMesh mesh = testing::comb();
  ContactOptions less = options;
  less.range /= 2;
  ContactBarrier made(mesh, less);
  ContactBarrier changed(mesh, options);
  const Eigen::VectorXd x = tangle(mesh, changed, random);
  const double wide = energy(changed, x);
  changed.set_range(less.range);
  EXPECT_FALSE(changed.active()) << "pairs of the range before";
  hold(changed, x);
  hold(made, x);
  EXPECT_GT(energy(made, x), 0);
  EXPECT_EQ(energy(changed, x), energy(made, x));
  EXPECT_NE(energy(changed, x), wide);
  changed.set_range(options.range);
  hold(changed, x);
  EXPECT_EQ(energy(changed, x), wide);
}

TEST(ContactBarrier, HasTheDerivativesOfItsEnergyAtTangledStates) {
  RandomStream random("contact_barrier", 1);
  const Eigen::Matrix2d skew = (Eigen::Matrix2d() << 1, 0.7, 0.1, 1).finished();
  int across = 0;
  for (const tiling::PeriodicMesh& mesh : {testing::comb(), testing::open_ring(), testing::comb(skew)}) {
    for (int trial = 0; trial < 3; ++trial) {
      ContactBarrier barrier(mesh, options);
      const Eigen::VectorXd x = tangle(mesh, barrier, random);
      for (const auto& [point, segment, i, j] :
           testing::brute_contacts(barrier.outline(), x, options.range, options.rest_fraction, 2, 2))
        across += i != 0 || j != 0 ? 1 : 0;
      ASSERT_GT(energy(barrier, x), 0);
      numerics::DerivativeCheckOptions check_options;
      check_options.step = 0.005 * options.range * barrier.status(x).smallest_ratio;
      check_options.levels = 4;
      const numerics::DerivativeCheck check = numerics::check_derivatives<CellState>(barrier, x, check_options);
      EXPECT_LT(check.gradient.error, 1e-7) << check.summary();
      EXPECT_LT(check.hessian.error, 1e-7) << check.summary();
    }
  }
  EXPECT_GT(across, 20) << "contacts with other cells";
}

TEST(ContactBarrier, IsExactlyZeroAtRestEvenWhereBeamsNearlyTouch) {
  for (const double gap : {1e-7, 1e-4, 0.03, 1.0}) {
    const tiling::PeriodicMesh mesh = wall(gap, 5);
    ContactBarrier barrier(mesh, options);
    const Eigen::VectorXd x = rest(mesh);
    hold(barrier, x);
    EXPECT_EQ(energy(barrier, x), 0);
    EXPECT_EQ(gradient(barrier, x).norm(), 0);
    EXPECT_EQ(hessian(barrier, x).norm(), 0);
    EXPECT_EQ(barrier.status(x).pairs, 0);
  }
}

TEST(ContactBarrier, IsZeroAtRestAroundReentrantCornersOfAFineOutline) {
  const tiling::PeriodicMesh mesh =
      testing::draw({"#..#", "#..#", "####", "...."}, {0.01, 0.01, 0.01, 0.01}, {0.01, 0.01, 0.01, 0.01});
  ContactBarrier barrier(mesh, options);
  const Eigen::VectorXd x = rest(mesh);
  hold(barrier, x);
  EXPECT_EQ(energy(barrier, x), 0);
  EXPECT_EQ(gradient(barrier, x).norm(), 0);
}

TEST(ContactBarrier, PushesNearlyTouchingBeamsApartOnceTheyComeNearer) {
  const tiling::PeriodicMesh mesh = wall(0.01, 5);
  ContactBarrier barrier(mesh, options);
  double before = 0;
  for (const double gap : {0.0059, 0.004, 0.002, 0.0001, 1e-6, 1e-12}) {
    const Eigen::VectorXd x = press(mesh, gap);
    hold(barrier, x);
    EXPECT_GT(energy(barrier, x), before);
    EXPECT_LT(gradient(barrier, x)[2 * mesh.nodes.cols()], 0) << "the cell wants to grow";
    before = energy(barrier, x);
  }
}

TEST(ContactBarrier, GrowsBeyondBoundsAsFacesMeet) {
  const tiling::PeriodicMesh mesh = wall(0.2, 3);
  ContactBarrier barrier(mesh, options);
  for (const double gap : {0.03, 1e-3, 1e-5, 1e-7, 1e-9, 1e-11, 1e-13}) {
    const Eigen::VectorXd x = press(mesh, gap);
    hold(barrier, x);
    const double d = 1.2 * (1 + x[2 * mesh.nodes.cols()]) - 1;
    EXPECT_NEAR(energy(barrier, x) / (2 * 2 * options.stiffness * LogBarrier(gap, options.range).value), 1, 1e-13 / d);
  }
}

TEST(ContactBarrier, OfFlatFacesIsThePressureTimesTheirLengthHoweverFineTheOutline) {
  // The two faces that meet have a length of 2 each. The energy of each face is stiffness * b(d) per length.
  const double gap = options.range / 2;
  const LogBarrier at_gap(gap, options.range);
  EXPECT_NEAR(-2 * at_gap.first, 1.19, 0.005) << "pressure over stiffness at half the range";
  for (const int rows : {3, 7, 20, 150, 600}) {
    const tiling::PeriodicMesh mesh = wall(0.2, rows);
    ContactBarrier barrier(mesh, options);
    for (const double slide : {0.0, 0.0123, 0.4}) {
      const Eigen::VectorXd x = press(mesh, gap, slide);
      hold(barrier, x);
      EXPECT_NEAR(energy(barrier, x), 2 * 2 * options.stiffness * at_gap.value, 1e-10) << rows << " rows";
      // The faces are 0.2 apart at rest, so that a change of F_xx alone changes their distance by 0.2 times as much.
      const double force = -gradient(barrier, x)[2 * mesh.nodes.cols()] / 0.2;
      EXPECT_NEAR(force, -2 * 2 * options.stiffness * at_gap.first, 1e-8) << rows << " rows";
    }
  }
}

TEST(ContactBarrier, OfCurvedFacesConvergesAsTheOutlineIsRefined) {
  const auto bulging = [](int rows) {
    const tiling::PeriodicMesh mesh = wall(0.2, rows);
    ContactBarrier barrier(mesh, options);
    Eigen::VectorXd x = press(mesh, 0.08);
    for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k)
      if (mesh.nodes(0, k) > 0.9) x[2 * k] += 0.06 * std::pow(std::sin(1.5707963 * mesh.nodes(1, k)), 2);
    hold(barrier, x);
    return energy(barrier, x);
  };
  const double fine = bulging(200);
  EXPECT_GT(fine, 0);
  EXPECT_NEAR(bulging(16) / fine, 1, 0.03);
  EXPECT_NEAR(bulging(32) / fine, 1, 0.01);
}

TEST(ContactBarrier, IsNeverNegative) {
  RandomStream random("contact_barrier", 2);
  const tiling::PeriodicMesh mesh = testing::comb();
  ContactBarrier barrier(mesh, {.stiffness = 1, .range = 0.3, .rest_fraction = 0.9});
  Eigen::VectorXd x = rest(mesh);
  for (int k = 0; k < 60; ++k) {
    const Eigen::VectorXd step = testing::random_motion(mesh, 0.05, 0.02, random);
    x += 0.9 * barrier.prepare_step(x, step) * step;
    EXPECT_GE(energy(barrier, x), 0);
  }
  EXPECT_GT(energy(barrier, x), 0);
}

TEST(ContactBarrier, ForcesAddUpToZero) {
  RandomStream random("contact_barrier", 3);
  const tiling::PeriodicMesh mesh = testing::comb();
  ContactBarrier barrier(mesh, options);
  const Eigen::VectorXd x = tangle(mesh, barrier, random);
  const Eigen::VectorXd forces = gradient(barrier, x);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k) sum += forces.segment<2>(2 * k);
  EXPECT_LT(sum.norm(), 1e-12 * forces.norm());
}

TEST(ContactBarrier, TurnsWithThePatch) {
  RandomStream random("contact_barrier", 4);
  const tiling::PeriodicMesh mesh = testing::comb();
  ContactBarrier barrier(mesh, options);
  const Eigen::VectorXd x = tangle(mesh, barrier, random);
  const double expected = energy(barrier, x);
  const Eigen::VectorXd forces = gradient(barrier, x);
  const Eigen::Matrix2d turn = Eigen::Rotation2Dd(2.1).toRotationMatrix();
  const Eigen::Matrix2d f = turn * CellCoordinates{mesh.nodes.cols()}.deformation_gradient(x);
  Eigen::VectorXd turned = x;
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k) turned.segment<2>(2 * k) = turn * x.segment<2>(2 * k);
  turned.tail<4>() << f(0, 0) - 1, f(0, 1), f(1, 0), f(1, 1) - 1;
  hold(barrier, turned);
  EXPECT_NEAR(energy(barrier, turned), expected, 1e-10 * expected);
  const Eigen::VectorXd turned_forces = gradient(barrier, turned);
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k)
    EXPECT_LT((turned_forces.segment<2>(2 * k) - turn * forces.segment<2>(2 * k)).norm(), 1e-9 * forces.norm());
}

TEST(ContactBarrier, IsTheSameForEveryChoiceOfTheTranslations) {
  RandomStream random("contact_barrier", 8);
  const tiling::PeriodicMesh mesh = testing::comb();
  ContactBarrier barrier(mesh, options);
  const Eigen::VectorXd x = tangle(mesh, barrier, random);
  const Eigen::VectorXd forces = gradient(barrier, x);
  for (const int times : {-3, 1, 7}) {
    ContactBarrier other(testing::redescribe(mesh, times), options);
    hold(other, x);
    EXPECT_NEAR(energy(other, x), energy(barrier, x), 1e-10 * energy(barrier, x));
    EXPECT_LT((gradient(other, x) - forces).norm(), 1e-9 * forces.norm());
    EXPECT_FALSE(other.intersects(x));
  }
}

TEST(ContactBarrier, IsTheSameForEveryChoiceOfThePointsCells) {
  // If a whole piece is moved by a translation of the deformed lattice, all its images move alike, and the deformed
  // patch is the same. The ring is one piece.
  RandomStream random("contact_barrier", 5);
  const tiling::PeriodicMesh mesh = testing::open_ring();
  ContactBarrier barrier(mesh, options);
  const Eigen::VectorXd x = tangle(mesh, barrier, random);
  const double expected = energy(barrier, x);
  const Eigen::Matrix2d lattice = CellCoordinates{mesh.nodes.cols()}.deformation_gradient(x) * mesh.lattice;
  Eigen::VectorXd moved = x;
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k) moved.segment<2>(2 * k) += lattice * Eigen::Vector2d(5, -3);
  hold(barrier, moved);
  EXPECT_NEAR(energy(barrier, moved), expected, 1e-9 * expected);
}

TEST(ContactBarrier, AddsAMatrixThatIsPositiveSemidefiniteAndNotBelowItsHessianOnDemand) {
  RandomStream random("contact_barrier", 6);
  const tiling::PeriodicMesh mesh = testing::open_ring();
  ContactBarrier barrier(mesh, options);
  const Eigen::VectorXd x = tangle(mesh, barrier, random);
  const Eigen::MatrixXd exact = hessian(barrier, x);
  barrier.set_convex(true);
  const Eigen::MatrixXd convex = hessian(barrier, x);
  const auto least = [](const Eigen::MatrixXd& matrix) {
    return Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[0];
  };
  const double scale = exact.norm();
  EXPECT_LT(least(exact), -1e-6 * scale);
  EXPECT_GT(least(convex), -1e-12 * scale);
  EXPECT_GT(least(convex - exact), -1e-12 * scale);
}

TEST(ContactBarrier, KnowsTheStiffnessOfA2x2PatchAgainstAlternatingModes) {
  const testing::Drawing drawing = {".##.", ".#..", ".##."};
  const std::vector<double> columns = {0.04, 0.5, 0.5, 0.04};
  const std::vector<double> rows = {0.5, 0.05, 0.45};
  const tiling::PeriodicMesh cell = testing::draw(drawing, columns, rows);
  testing::Drawing twice_drawing;
  for (int k = 0; k < 6; ++k)
    twice_drawing.push_back(drawing[static_cast<std::size_t>(k % 3)] + drawing[static_cast<std::size_t>(k % 3)]);
  const auto twice = [](std::vector<double> widths) {
    const std::vector<double> once = widths;
    widths.insert(widths.end(), once.begin(), once.end());
    return widths;
  };
  const tiling::PeriodicMesh patch = testing::draw(twice_drawing, twice(columns), twice(rows));

  // Cell and patch are compared in the same state, first their energies and then modes that alternate.
  RandomStream random("contact_barrier", 7);
  ContactBarrier on_cell(cell, options);
  ContactBarrier on_patch(patch, options);
  const Eigen::Index nodes = cell.nodes.cols();
  Eigen::VectorXd x = rest(cell);
  x.tail<4>() << -0.4, 0.02, 0.01, -0.45;
  for (Eigen::Index k = 0; k < 2 * nodes; ++k) x[k] = 0.006 * random.normal();
  std::vector<Eigen::Index> twin;
  std::vector<Eigen::Vector2i> place;
  for (Eigen::Index k = 0; k < patch.nodes.cols(); ++k)
    for (Eigen::Index l = 0; l < nodes; ++l) {
      const Eigen::Vector2d cells = cell.lattice.inverse() * (patch.nodes.col(k) - cell.nodes.col(l));
      if ((cells - cells.array().round().matrix()).norm() > 1e-9) continue;
      twin.push_back(l);
      place.emplace_back(cells.array().round().matrix().cast<int>());
    }
  ASSERT_EQ(static_cast<Eigen::Index>(twin.size()), patch.nodes.cols());
  const auto spread = [&](const Eigen::VectorXd& of_cell, Alternation alternation) {
    Eigen::VectorXd all = rest(patch);
    for (std::size_t k = 0; k < twin.size(); ++k)
      all.segment<2>(2 * static_cast<Eigen::Index>(k)) =
          alternation.sign(place[k][0], place[k][1]) * of_cell.segment<2>(2 * twin[k]);
    return all;
  };
  Eigen::VectorXd patch_x = spread(x, {});
  patch_x.tail<4>() = x.tail<4>();
  hold(on_cell, x);
  hold(on_patch, patch_x);
  ASSERT_GT(on_cell.status(x).pairs, 10);
  EXPECT_NEAR(energy(on_patch, patch_x), 4 * energy(on_cell, x), 1e-10 * energy(on_patch, patch_x));
  const Eigen::MatrixXd patch_hessian = hessian(on_patch, patch_x);
  AlternatingEntries entries;
  on_cell.add_alternating_hessians(x, entries);
  for (std::size_t a = 0; a < alternations.size(); ++a) {
    const Alternation alternation = alternations[a];
    const Eigen::MatrixXd cell_hessian = entries[a].matrix(2 * nodes);
    Eigen::MatrixXd modes(patch_x.size(), 2 * nodes);
    for (Eigen::Index k = 0; k < 2 * nodes; ++k) modes.col(k) = spread(Eigen::VectorXd::Unit(x.size(), k), alternation);
    const Eigen::MatrixXd expected = modes.transpose() * patch_hessian * modes / 4;
    EXPECT_LT((cell_hessian - expected).norm(), 1e-10 * expected.norm());
  }
}

TEST(ContactBarrier, SaysHowNearTheOutlineComes) {
  const tiling::PeriodicMesh mesh = wall(0.2, 4);
  ContactBarrier barrier(mesh, options);
  hold(barrier, rest(mesh));
  EXPECT_FALSE(barrier.active());
  EXPECT_EQ(barrier.status(rest(mesh)).smallest_gap, std::numeric_limits<double>::infinity());
  const Eigen::VectorXd x = press(mesh, 0.015);
  hold(barrier, x);
  EXPECT_TRUE(barrier.active());
  const ContactStatus status = barrier.status(x);
  EXPECT_NEAR(status.smallest_gap, 0.015, 1e-12);
  EXPECT_NEAR(status.smallest_ratio, 0.25, 1e-10);
  EXPECT_EQ(status.pairs, 32) << "each of the 16 points sees the two segments that meet opposite to it";
}

TEST(ContactBarrier, AsksForTwiceTheStiffnessWhereAGapIsMuchNarrowerThanTheRange) {
  const tiling::PeriodicMesh mesh = wall(0.2, 4);
  ContactBarrier barrier(mesh, options);
  Eigen::VectorXd x = press(mesh, 0.5 * options.range);
  hold(barrier, x);
  EXPECT_EQ(barrier.suggested_stiffness(x), options.stiffness);
  x = press(mesh, 0.02 * options.range);
  hold(barrier, x);
  EXPECT_EQ(barrier.suggested_stiffness(x), 2 * options.stiffness);
  const double before = energy(barrier, x);
  barrier.set_stiffness(2 * options.stiffness);
  EXPECT_NEAR(energy(barrier, x), 2 * before, 1e-12 * before);
}

TEST(ContactBarrier, NamesEveryOptionThatIsOutOfRange) {
  const tiling::PeriodicMesh mesh = wall(0.2, 4);
  try {
    ContactBarrier barrier(mesh, {.stiffness = -1, .range = 0, .rest_fraction = 1});
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), "simulation.invalid_option");
    EXPECT_EQ(error.details().size(), 3U);
  }
}

TEST(ContactBarrier, TakesItsScaleFromTheBeamsAndTheMaterial) {
  tiling::PeriodicMesh mesh = wall(0.2, 4);
  mesh.beam_width = 0.3;
  const ContactOptions chosen = contact_options(mesh, Material{});
  EXPECT_NEAR(chosen.range, 0.006, 1e-15);
  EXPECT_GT(chosen.stiffness, 0.1);
  EXPECT_LT(chosen.stiffness, Material{}.youngs_modulus);
  EXPECT_NO_THROW(ContactBarrier(mesh, chosen));
}

}  // namespace
}  // namespace supple::microscale
