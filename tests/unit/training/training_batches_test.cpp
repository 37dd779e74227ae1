#include "training_batches.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "support/law_samples.h"

namespace supple::training {
namespace {

/// A symmetry that changes the sign of the shear strain and reflects the parameter in the middle of its box.
EnergySymmetry mirror(const Samples& samples) {
  return {Eigen::Vector3d(1, 1, -1).asDiagonal(), -Eigen::MatrixXd::Identity(1, 1),
          Eigen::VectorXd::Constant(1, samples.lower[0] + samples.upper[0])};
}

/// Sets the parameter of a design, which is given mapped to [-1, 1].
void place(Samples& samples, std::size_t design, double mapped) {
  samples.designs[design].parameters[0] = samples.lower[0] + 0.5 * (mapped + 1) * (samples.upper[0] - samples.lower[0]);
}

TEST(TrainingData, SeesAChunkThroughASymmetryOfStrainAndParameters) {
  auto samples = law_samples(4, 5, 1);
  place(samples, 2, 0.4);
  const TrainingData data(samples, {mirror(samples)}, {}, {}, torch::kCPU);
  const std::vector<Chunk> chunks{{2, {samples.designs[2].first, samples.designs[2].first + 3}}};
  const std::array as_it_is{0};
  const std::array mirrored{1};
  const auto plain = data.labelled(chunks, as_it_is);
  const auto seen = data.labelled(chunks, mirrored);
  EXPECT_NEAR(plain.batch.p.item<double>(), 0.4, 1e-6);
  EXPECT_NEAR(seen.batch.p.item<double>(), -0.4, 1e-6);
  const auto signs = torch::tensor({1.0, 1.0, -1.0}).to(torch::kFloat);
  EXPECT_TRUE(torch::equal(seen.batch.e, plain.batch.e * signs));
  EXPECT_TRUE(torch::equal(seen.stress, plain.stress * signs));
  EXPECT_TRUE(torch::equal(seen.energy, plain.energy));
  EXPECT_TRUE(torch::allclose(seen.tangent, plain.tangent * signs.unsqueeze(0) * signs.unsqueeze(1)));
}

/// v^T C v of the image v of each unit vector under the whitening.
torch::Tensor costs(const LabelledBatch& seen, const torch::Tensor& unit_vectors) {
  const auto v = (seen.whitening * unit_vectors.unsqueeze(1)).sum(2);
  return (seen.tangent * v.unsqueeze(1)).sum(2).mul(v).sum(1);
}

TEST(TrainingData, WhitensDirectionsThroughAnySymmetry) {
  auto samples = law_samples(3, 6, 1);
  // The first tangent is soft along one strain and stiff along another. The second has a negative eigenvalue, as after
  // buckling.
  samples.tangent.col(0) << 100, 99, 0, 100, 0, 1e-1;
  samples.tangent.col(1) << 5, 0, 0, 2, 0, -1;
  const TrainingData data(samples, {mirror(samples)}, {}, {}, torch::kCPU);
  const std::vector<Chunk> chunks{{0, {0, 1, 2}}};
  for (const int symmetry : {0, 1}) {
    const auto seen = data.labelled(chunks, std::array{symmetry});
    for (int axis = 0; axis < 3; ++axis) {
      const auto cost = costs(seen, torch::eye(3)[axis].expand({3, 3}));
      EXPECT_NEAR(cost[0].item<double>(), 1, 1e-3) << "axis " << axis << ", symmetry " << symmetry;
      EXPECT_NEAR(cost[1].item<double>(), axis < 2 ? 1 : -1, 1e-3) << "axis " << axis << ", symmetry " << symmetry;
      EXPECT_NEAR(cost[2].item<double>(), 1, 1e-3) << "axis " << axis << ", symmetry " << symmetry;
    }
  }
}

TEST(TrainingData, BoundsWhitenedDirectionsNextToBuckling) {
  auto samples = law_samples(1, 2, 1);
  samples.tangent.col(0) << 4, 0, 0, 1, 0, 1e-9;
  const TrainingData data(samples, {}, {}, {}, torch::kCPU);
  const auto seen = data.labelled(std::vector<Chunk>{{0, {0}}}, std::array{0});
  const auto longest = seen.whitening.abs().max().item<double>();
  EXPECT_LT(longest, 100);
  EXPECT_GT(longest, 10);
}

TEST(TrainingData, UsesNoImageThatIsHeldOutOrFarOutOfTheBox) {
  auto samples = law_samples(5, 2, 1);
  const std::array mapped{0.3, -0.3, 1.05, 0.7, 0.0};
  for (std::size_t d = 0; d < mapped.size(); ++d) place(samples, d, mapped[d]);
  const TrainingData data(samples, {mirror(samples)}, {1}, {}, torch::kCPU);
  EXPECT_EQ(data.symmetries_of(0), std::vector{0}) << "its image is design 1, which is held out";
  EXPECT_EQ(data.symmetries_of(2), (std::vector{0, 1})) << "no further out than the data are";
  EXPECT_EQ(data.symmetries_of(3), (std::vector{0, 1}));
  EXPECT_EQ(data.symmetries_of(4), (std::vector{0, 1})) << "its own image";

  auto shifted = mirror(samples);
  shifted.constant[0] += 0.3 * (samples.upper[0] - samples.lower[0]);
  const TrainingData further(samples, {shifted}, {}, {}, torch::kCPU);
  EXPECT_EQ(further.symmetries_of(1), (std::vector{0, 1})) << "at 0.9";
  EXPECT_EQ(further.symmetries_of(4), (std::vector{0, 1})) << "at 0.6";
  place(samples, 4, -0.6);
  EXPECT_EQ(TrainingData(samples, {shifted}, {}, {}, torch::kCPU).symmetries_of(4), std::vector{0}) << "at 1.2";
}

}  // namespace
}  // namespace supple::training
