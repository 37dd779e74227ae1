#include "contact_pairs.h"

#include <gtest/gtest.h>

#include <limits>
#include <set>

#include "contact_geometry.h"
#include "support/drawn_meshes.h"

namespace supple::microscale {
namespace {

using testing::PairKey;

constexpr double range = 0.05;
constexpr double rest_fraction = 0.6;

std::set<PairKey> contacts(const ContactPairs& pairs, const Eigen::VectorXd& x) {
  const Eigen::Matrix2d gradient = CellCoordinates{(x.size() - 4) / 2}.deformation_gradient(x);
  std::set<PairKey> found;
  for (const ContactPair& pair : pairs.pairs()) {
    const PlacedSegment placed(pair, gradient, x);
    if (std::sqrt(point_segment_distance(placed.tail, placed.head).squared_distance) >= pair.range) continue;
    const bool fresh = found.emplace(pair.point, pair.segment, pair.tail_shift[0], pair.tail_shift[1]).second;
    EXPECT_TRUE(fresh) << "a pair that is listed twice";
  }
  return found;
}

/// Makes random steps, each as long as `prepare` allows. Calls look(x, step, share) before each step, where `share` is
/// the fraction of the step that is allowed.
template <class Look>
void wander(const tiling::PeriodicMesh& mesh, ContactPairs& pairs, int steps, double amplitude, double strain,
            RandomStream& random, Look&& look) {
  Eigen::VectorXd x = Eigen::VectorXd::Zero(2 * mesh.nodes.cols() + 4);
  Eigen::VectorXd direction;
  for (int k = 0; k < steps; ++k) {
    // Three long steps in one direction bring points near each other. The list need not be rebuilt for the fourth,
    // which is short.
    if (k % 4 == 0) direction = testing::random_motion(mesh, amplitude, strain, random);
    const Eigen::VectorXd step = (k % 4 == 3 ? 0.01 : 1.0) * direction;
    const double share = pairs.prepare(x, step);
    look(x, step, share);
    x += 0.95 * share * step;
  }
}

TEST(ContactPairs, AreAllPairsThatComeNearAndNothingPassesThrough) {
  RandomStream random("contact_pairs", 1);
  std::size_t met = 0;
  int cut = 0;
  const Eigen::Matrix2d skew = (Eigen::Matrix2d() << 1, 1.5, 0.2, 1).finished();
  for (const tiling::PeriodicMesh& mesh : {testing::comb(), testing::open_ring(), testing::comb(skew)}) {
    for (int walk = 0; walk < 2; ++walk) {
      ContactPairs pairs(mesh, range, rest_fraction);
      wander(mesh, pairs, 12, 0.1, 0.04, random,
             [&](const Eigen::VectorXd& x, const Eigen::VectorXd& step, double share) {
               ASSERT_GT(share, 0);
               ASSERT_LE(share, 1);
               cut += share < 1 ? 1 : 0;
               for (const double t : {0.4, 1.0}) {
                 const Eigen::VectorXd at = x + t * share * step;
                 const auto expected = testing::brute_contacts(pairs.outline(), at, range, rest_fraction, 3, 2);
                 ASSERT_EQ(contacts(pairs, at), expected);
                 ASSERT_FALSE(testing::brute_intersects(pairs.outline(), at, 2));
                 met += expected.size();
               }
             });
    }
  }
  EXPECT_GT(met, 1000U);
  EXPECT_GT(cut, 20);
}

TEST(ContactPairs, AreFoundInImagesThatAreManyCellsAway) {
  RandomStream random("contact_pairs", 2);
  std::size_t far = 0;
  for (const int times : {-4, 2, 5}) {
    const tiling::PeriodicMesh mesh = testing::redescribe(testing::comb(), times);
    for (int trial = 0; trial < 2; ++trial) {
      ContactPairs pairs(mesh, range, rest_fraction);
      wander(mesh, pairs, 12, 0.1, 0.08, random,
             [&](const Eigen::VectorXd& x, const Eigen::VectorXd& step, double share) {
               const Eigen::VectorXd at = x + share * step;
               const auto expected = testing::brute_contacts(pairs.outline(), at, range, rest_fraction, 6, 1);
               ASSERT_EQ(contacts(pairs, at), expected);
               for (const auto& [point, segment, i, j] : expected) far += std::abs(i) > 1 ? 1 : 0;
             });
    }
  }
  EXPECT_GT(far, 20U);
}

TEST(ContactPairs, KeepAShareOfTheirDistanceOnTheWholeStep) {
  RandomStream random("contact_pairs", 3);
  const tiling::PeriodicMesh mesh = testing::open_ring();
  ContactPairs pairs(mesh, range, rest_fraction);
  wander(mesh, pairs, 24, 0.1, 0.04, random, [&](const Eigen::VectorXd& x, const Eigen::VectorXd& step, double share) {
    const Eigen::Matrix2d gradient = CellCoordinates{mesh.nodes.cols()}.deformation_gradient(x);
    const Eigen::Matrix2d change = CellCoordinates{mesh.nodes.cols()}.strain_change(step);
    for (const ContactPair& pair : pairs.pairs()) {
      const PlacedSegment at(pair, gradient, x);
      const PlacedSegment along(pair, change, step);
      const double start = testing::distance_to(at.tail, at.head);
      for (int k = 1; k <= 20; ++k) {
        const double t = share * k / 20;
        ASSERT_GE(testing::distance_to(at.tail + t * along.tail, at.head + t * along.head), 0.2 * start * (1 - 1e-9));
      }
    }
  });
}

TEST(ContactPairs, ComeFromAnOldListAsFromANewOne) {
  RandomStream random("contact_pairs", 4);
  const tiling::PeriodicMesh mesh = testing::comb();
  ContactPairs pairs(mesh, range, rest_fraction);
  std::size_t compared = 0;
  wander(mesh, pairs, 40, 0.06, 0.03, random, [&](const Eigen::VectorXd& x, const Eigen::VectorXd& step, double share) {
    ContactPairs fresh(mesh, range, rest_fraction);
    EXPECT_EQ(fresh.prepare(x, step), share);
    ASSERT_EQ(fresh.pairs().size(), pairs.pairs().size());
    EXPECT_EQ(fresh.joints().size(), pairs.joints().size());
    for (std::size_t k = 0; k < pairs.pairs().size(); ++k, ++compared) {
      EXPECT_EQ(fresh.pairs()[k].point, pairs.pairs()[k].point);
      EXPECT_EQ(fresh.pairs()[k].segment, pairs.pairs()[k].segment);
      EXPECT_EQ(fresh.pairs()[k].tail_shift, pairs.pairs()[k].tail_shift);
    }
  });
  EXPECT_GT(compared, 100U);
}

TEST(ContactPairs, LetAFreeStepGoAllTheWay) {
  const tiling::PeriodicMesh mesh = testing::open_ring();
  ContactPairs pairs(mesh, range, rest_fraction);
  const CellCoordinates coordinates{mesh.nodes.cols()};
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(coordinates.size());
  Eigen::VectorXd stretch = rest;
  stretch[coordinates.strain()] = 0.5;
  EXPECT_EQ(pairs.prepare(rest, rest), 1);
  EXPECT_EQ(pairs.prepare(rest, stretch), 1);
  EXPECT_EQ(pairs.prepare(stretch, -stretch), 1);
  Eigen::VectorXd drift = rest;
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k) drift.segment<2>(2 * k) << 500, -300;
  EXPECT_EQ(pairs.prepare(rest, drift), 1) << "a translation is no motion";
}

TEST(ContactPairs, StopAStepThatWouldPullASlabThroughItsImages) {
  const tiling::PeriodicMesh mesh = testing::wall(0.5, 6);
  ContactPairs pairs(mesh, range, rest_fraction);
  const CellCoordinates coordinates{mesh.nodes.cols()};
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(coordinates.size());
  Eigen::VectorXd squeeze = rest;
  // The cell shrinks by more than the gap, and the wall keeps its width.
  squeeze[coordinates.strain()] = -0.6;
  for (Eigen::Index k = 0; k < mesh.nodes.cols(); ++k) squeeze[2 * k] = 0.6 * mesh.nodes(0, k);
  const double share = pairs.prepare(rest, squeeze);
  const double gap = 0.5 - share * 0.6 * 1.5;
  EXPECT_GE(gap, 0.2 * 0.5 * (1 - 1e-9));
  EXPECT_LE(gap, 0.25 * 0.5);
}

TEST(ContactPairs, CutAStepOfAbsurdLengthAndRefuseOneThatIsNotFinite) {
  RandomStream random("contact_pairs", 5);
  const tiling::PeriodicMesh mesh = testing::comb();
  ContactPairs pairs(mesh, range, rest_fraction);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(2 * mesh.nodes.cols() + 4);
  Eigen::VectorXd step = 1e9 * testing::random_motion(mesh, 1, 1, random);
  const double share = pairs.prepare(rest, step);
  EXPECT_GT(share, 0);
  EXPECT_LT(share, 1e-8);
  EXPECT_FALSE(testing::brute_intersects(pairs.outline(), share * step, 2));
  step[2 * pairs.outline().nodes[3]] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(pairs.prepare(rest, step), 0);
}

TEST(ContactPairs, AreNoneInASolidPatch) {
  const tiling::PeriodicMesh mesh = testing::draw({"##", "##"}, testing::equal(2, 1), testing::equal(2, 1));
  ContactPairs pairs(mesh, range, rest_fraction);
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(2 * mesh.nodes.cols() + 4);
  EXPECT_EQ(pairs.prepare(rest, rest), 1);
  EXPECT_TRUE(pairs.pairs().empty());
}

}  // namespace
}  // namespace supple::microscale
