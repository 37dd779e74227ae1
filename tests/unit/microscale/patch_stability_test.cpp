#include "patch_stability.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <limits>

#include "cell_model.h"
#include "support/drawn_meshes.h"

namespace supple::microscale {
namespace {

/// Slender crossing beams.
tiling::PeriodicMesh crossing_beams() {
  const std::vector<double> widths = {0.06, 0.06, 0.11, 0.11, 0.11, 0.11, 0.11, 0.11, 0.11, 0.11};
  testing::Drawing drawing(8, "##........");
  drawing.insert(drawing.end(), 2, "##########");
  return testing::draw(drawing, widths, widths);
}

/// The least eigenvalue of the stiffness for each alternation.
std::array<double, alternations.size()> least_eigenvalues(const CellModel& cell, const Eigen::VectorXd& x) {
  AlternatingEntries entries;
  cell.add_alternating_hessians(x, entries);
  std::array<double, alternations.size()> least;
  for (std::size_t a = 0; a < alternations.size(); ++a) {
    const Eigen::MatrixXd matrix = entries[a].matrix(cell.coordinates().strain());
    least[a] = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(matrix, Eigen::EigenvaluesOnly).eigenvalues()[0];
  }
  return least;
}

TEST(PatchStability, FindsTheLeastStableOfTheThreeAlternations) {
  const CellModel cell(crossing_beams(), {}, false);
  const Eigen::Index strain = cell.coordinates().strain();
  std::vector<std::size_t> worst;
  for (const auto& [xx, yy] : {std::pair(-0.03, 0.0), std::pair(0.0, -0.03), std::pair(-0.03, -0.02)}) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(cell.coordinates().size());
    x[strain] = xx;
    x[strain + 3] = yy;
    const auto eigenvalues = least_eigenvalues(cell, x);
    const auto least = std::min_element(eigenvalues.begin(), eigenvalues.end());
    ASSERT_LT(*least, 0);
    const auto found = PatchStability(strain).find(cell, x, {});
    ASSERT_TRUE(found);
    worst.push_back(static_cast<std::size_t>(least - eigenvalues.begin()));
    EXPECT_NEAR(found->curvature, *least, 0.1 * std::abs(*least));
    EXPECT_EQ(found->alternation.first, alternations[worst.back()].first);
    EXPECT_EQ(found->alternation.second, alternations[worst.back()].second);
  }
  EXPECT_NE(worst[0], worst[1]) << "the load decides which mode is the worst";
}

TEST(PatchStability, FindsNothingInACellAtRest) {
  const CellModel cell(crossing_beams(), {}, false);
  const auto found =
      PatchStability(cell.coordinates().strain()).find(cell, Eigen::VectorXd::Zero(cell.coordinates().size()), {});
  EXPECT_FALSE(found);
}

}  // namespace
}  // namespace supple::microscale
