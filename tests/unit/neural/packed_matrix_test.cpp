#include "supple/neural/packed_matrix.h"

#include <gtest/gtest.h>

#include <vector>

namespace supple::neural {
namespace {

template <class Real>
Eigen::Matrix<Real, -1, -1> product(const Eigen::MatrixXd& a, const Eigen::Matrix<Real, -1, -1>& b, Instructions use) {
  const PackedMatrix<Real> packed(a);
  Eigen::Matrix<Real, -1, -1> c(padded_rows(packed.rows()), b.cols());
  multiply(packed, Factor<Real>{b.data(), b.rows()}, static_cast<int>(b.cols()), c.data(), static_cast<int>(c.rows()),
           use);
  return c;
}

template <class Real>
void compare_instructions(double tolerance) {
  for (const int rows : {3, 16, 40, 96, 128})
    for (const int depth : {1, 7, 96})
      for (int columns = 1; columns <= 14; ++columns) {
        const Eigen::MatrixXd a = Eigen::MatrixXd::Random(rows, depth);
        const Eigen::Matrix<Real, -1, -1> b = Eigen::Matrix<Real, -1, -1>::Random(depth, columns);
        const Eigen::MatrixXd exact = a.cast<Real>().template cast<double>() * b.template cast<double>();
        const auto portable = product<Real>(a, b, Instructions::portable);
        EXPECT_LT((portable.topRows(rows).template cast<double>() - exact).norm(), tolerance * (1 + exact.norm()));
        EXPECT_TRUE(portable.bottomRows(portable.rows() - rows).isZero());
        if (best_instructions() == Instructions::portable) continue;
        const auto avx2 = product<Real>(a, b, Instructions::avx2);
        EXPECT_LT((avx2 - portable).norm(), tolerance * (1 + portable.norm()));
        if (best_instructions() != Instructions::avx512) continue;
        EXPECT_EQ(product<Real>(a, b, Instructions::avx512), avx2) << rows << " x " << depth << " x " << columns;
      }
}

TEST(PackedMatrix, MultipliesAlikeWithAllInstructions) {
  compare_instructions<double>(1e-14);
  compare_instructions<float>(1e-5);
}

}  // namespace
}  // namespace supple::neural
