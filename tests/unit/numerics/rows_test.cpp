#include "supple/numerics/rows.h"

#include <gtest/gtest.h>

namespace supple::numerics {
namespace {

TEST(Rows, AreTheVectorsAndBack) {
  const std::vector<Eigen::Vector3d> vectors{{1, 2, 3}, {4, 5, 6}};
  const Eigen::MatrixXd matrix = rows_of(vectors);
  EXPECT_EQ(matrix, (Eigen::MatrixXd(2, 3) << 1, 2, 3, 4, 5, 6).finished());
  EXPECT_EQ(vectors_of<3>(matrix, "points"), vectors);
  EXPECT_EQ(rows_of(std::vector<Eigen::Vector2d>{}).cols(), 2);

  const std::vector<std::array<int, 2>> pairs{{0, 1}, {1, 2}, {2, 0}};
  EXPECT_EQ(rows_of(pairs), (Eigen::MatrixXi(3, 2) << 0, 1, 1, 2, 2, 0).finished());
  EXPECT_EQ(groups_of<2>(rows_of(pairs), "pairs"), pairs);
}

TEST(Rows, MayBeStoredInAnyOrderAndHaveAFixedNumberOfColumns) {
  const Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> by_rows = Eigen::MatrixXd::Random(4, 3);
  EXPECT_EQ(rows_of(vectors_of<3>(by_rows, "points")), by_rows);
}

TEST(Rows, OfAnotherLengthAreRefusedByTheirName) {
  try {
    vectors_of<3>(Eigen::MatrixXd::Zero(5, 2), "vertices");
    FAIL() << "two columns are no positions in space";
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "The matrix of vertices has 2 columns, not 3.");
  }
  EXPECT_THROW(groups_of<3>(Eigen::MatrixXi::Zero(5, 4), "faces"), std::invalid_argument);
}

}  // namespace
}  // namespace supple::numerics
