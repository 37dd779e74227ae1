#include "supple/tiling/symmetry.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "polygon.h"
#include "supple/tiling/family_definition.h"

namespace supple::tiling {
namespace {

Eigen::VectorXd somewhere(const Family& family) {
  Eigen::VectorXd p(static_cast<long>(family.parameters.size()));
  for (long k = 0; k < p.size(); ++k) {
    const auto& [lower, upper, preset] = family.parameters[static_cast<std::size_t>(k)];
    p[k] = lower + (0.61 - 0.13 * static_cast<double>(k)) * (upper - lower);
  }
  return p;
}

Tiling at(const Family& family, const Eigen::VectorXd& p) {
  return family.shape({p.data(), static_cast<std::size_t>(p.size())});
}

/// The numbers of symmetries that map each design to itself, and of those that map it to another design.
std::pair<int, int> counts(const std::string& id) {
  std::pair<int, int> counted;
  for (const auto& symmetry : symmetries(family(id)))
    ++((symmetry.linear - Eigen::MatrixXd::Identity(symmetry.linear.rows(), symmetry.linear.cols())).norm() < 1e-9
           ? counted.first
           : counted.second);
  return counted;
}

TEST(Symmetry, KeepsLatticeAndTileOfOtherwiseArbitraryDesigns) {
  for (const auto& family : families()) {
    const auto p = somewhere(family);
    for (const auto& symmetry : symmetries(family)) {
      const auto from = at(family, p);
      const auto to = at(family, symmetry.image(p));
      const Eigen::Matrix2d lattices = to.lattice.inverse() * symmetry.operation * from.lattice;
      EXPECT_LT((lattices - lattices.array().round().matrix()).norm(), 1e-9) << family.id;
      for (std::size_t i = 0; i < from.tiles.size(); ++i) {
        EXPECT_NEAR(area(from.tiles[i]), area(to.tiles[i]), 1e-9) << family.id;
        EXPECT_NEAR(perimeter(from.tiles[i]), perimeter(to.tiles[i]), 1e-9) << family.id;
      }
    }
  }
}

TEST(Symmetry, IsAGroupWithTheIdentityFirst) {
  for (const auto& family : families()) {
    const auto all = symmetries(family);
    ASSERT_FALSE(all.empty());
    EXPECT_TRUE(all[0].operation.isIdentity(1e-12));
    const auto p = somewhere(family);
    EXPECT_LT((all[0].image(p) - p).norm(), 1e-12);
    for (const auto& a : all)
      for (const auto& b : all) {
        const Eigen::Matrix2d operation = a.operation * b.operation;
        const Eigen::VectorXd image = a.image(b.image(p));
        EXPECT_TRUE(std::any_of(all.begin(), all.end(), [&](const auto& c) {
          return (c.operation - operation).norm() < 1e-9 && (c.image(p) - image).norm() < 1e-9;
        })) << family.id;
      }
  }
}

TEST(Symmetry, LeavesTheWidthOfBeamsAsItIs) {
  for (const FamilyDefinition& fixed : shipped_definitions()) {
    FamilyDefinition varying = fixed;
    const auto width = static_cast<long>(fixed.parameters.size());
    varying.parameters.push_back({"width", {0.02, 0.2, 0.1}});
    varying.beam_width = {};
    varying.beam_width.slopes.assign(varying.parameters.size(), 0);
    varying.beam_width.slopes.back() = 1;
    const Family family = make_family(varying);
    const auto expected = symmetries(make_family(fixed)), found = symmetries(family);
    ASSERT_EQ(found.size(), expected.size()) << fixed.id;
    const auto p = somewhere(family);
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_LT((found[k].operation - expected[k].operation).norm(), 1e-12) << fixed.id;
      const Eigen::VectorXd image = found[k].image(p);
      EXPECT_NEAR(image[width], p[width], 1e-12) << fixed.id;
      EXPECT_LT((image.head(width) - expected[k].image(p.head(width))).norm(), 1e-9) << fixed.id;
    }
  }
}

TEST(Symmetry, ExchangesMirrorImagesWhereAFamilyHasBoth) {
  // In IH01 and IH28, whose tilings have no mirror symmetry, a design and its mirror image are two designs. In IH50 and
  // IH22, they are the same tiling with other parameters. The mirror images of IH21 are no designs of the family.
  EXPECT_EQ(counts("IH01"), std::pair(2, 2));
  EXPECT_EQ(counts("IH21"), std::pair(6, 0));
  EXPECT_EQ(counts("IH22"), std::pair(2, 2));
  EXPECT_EQ(counts("IH28"), std::pair(4, 4));
  EXPECT_EQ(counts("IH29"), std::pair(8, 0));
  EXPECT_EQ(counts("IH50"), std::pair(4, 4));
  EXPECT_EQ(counts("IH67"), std::pair(4, 0));
}

TEST(Symmetry, OfParametersIsWhatTheVerticesSay) {
  for (const auto& symmetry : symmetries(family("IH01"))) {
    if (symmetry.linear.isIdentity(1e-9)) continue;
    const Eigen::Vector4d p(0.1, 0.3, 0.07, 0.5);
    EXPECT_LT((symmetry.image(p) - Eigen::Vector4d(0.1, 0.7, 0.07, 0.75)).norm(), 1e-9);
    EXPECT_LT(symmetry.operation.determinant(), 0) << "a mirror image";
  }
  for (const char* id : {"IH28", "IH50"})
    for (const auto& symmetry : symmetries(family(id)))
      if (!symmetry.linear.isIdentity(1e-9)) {
        EXPECT_LT((symmetry.image(Eigen::Vector2d(0.2, 0.3)) - Eigen::Vector2d(0.2, 0.7)).norm(), 1e-9) << id;
      }
}

}  // namespace
}  // namespace supple::tiling
