#include "row_losses.h"

#include <gtest/gtest.h>
#include <torch/torch.h>

#include <cmath>
#include <vector>

namespace supple::training {
namespace {

using torch::Tensor;

Tensor numbers(const std::vector<double>& values, at::IntArrayRef shape) {
  return torch::tensor(values, torch::kDouble).reshape(shape);
}

/// Two rows. The relative errors of energy and stress are 1/4 and 3/5 for the first, 2 and 1 for the second. The errors
/// of the stiffness along a direction are 1/2 and 0.
struct TwoRows {
  LabelledBatch truth{{},
                      numbers({4, 1}, {2}),
                      numbers({3, 0, 4, 0, 2, 0}, {2, 3}),
                      numbers({1, 0, 0, 0, 2, 0, 0, 0, 3, 1, 0, 0, 0, 1, 0, 0, 0, 1}, {2, 3, 3}),
                      {}};
  Response answer{numbers({5, 3}, {2}), numbers({3, 3, 4, 0, 0, 0}, {2, 3}), numbers({1.5, 1}, {2})};
  Tensor directions = numbers({1, 0, 0, 0, 0, 1}, {2, 3});
};

TrainingOptions options_of(LossKind loss) {
  TrainingOptions options;
  options.loss = loss;
  options.energy_weight = 2;
  options.stress_weight = 3;
  options.tangent_weight = 0.5;
  options.error_floor = 0.75;
  return options;
}

double at(const Tensor& losses, long row) { return losses[row].item<double>(); }

TEST(RowLosses, TheSquaredOneIsTheThesisesSumOfSquares) {
  const TwoRows rows;
  auto options = options_of(LossKind::squared);
  auto losses = row_losses(options, rows.answer, rows.truth, {});
  EXPECT_NEAR(at(losses, 0), 2 * 0.0625 + 3 * 0.36, 1e-14);
  EXPECT_NEAR(at(losses, 1), 2 * 4.0 + 3 * 1.0, 1e-14);
  losses = row_losses(options, rows.answer, rows.truth, rows.directions);
  EXPECT_NEAR(at(losses, 0), 2 * 0.0625 + 3 * 0.36 + 0.5 * 0.25, 1e-14);
  EXPECT_NEAR(at(losses, 1), 11, 1e-14);
  // Only the robust loss depends on the floor.
  options.error_floor = 7;
  EXPECT_TRUE(torch::equal(row_losses(options, rows.answer, rows.truth, rows.directions), losses));
}

TEST(RowLosses, TheRobustOneIsALogarithmAboveTheFloor) {
  const TwoRows rows;
  const auto losses = row_losses(options_of(LossKind::robust), rows.answer, rows.truth, rows.directions);
  const auto term = [](double error) { return std::log(1 + std::sqrt(error * error + 0.75 * 0.75)); };
  EXPECT_NEAR(at(losses, 0), 2 * term(0.25) + 3 * term(0.6) + 0.5 * term(0.5), 1e-14);
  // sqrt(1 + 0.5625) = 1.25 for the stress, and log(1 + 0.75) for the stiffness without error.
  EXPECT_NEAR(at(losses, 1), 2 * term(2) + 3 * std::log(2.25) + 0.5 * std::log(1.75), 1e-14);
}

TEST(RowLosses, TheirDerivativesAreThoseOfDifferences) {
  for (const auto loss : {LossKind::robust, LossKind::squared}) {
    const TwoRows rows;
    const auto options = options_of(loss);
    const std::vector<Tensor> leaves{rows.answer.energy.clone().set_requires_grad(true),
                                     rows.answer.stress.clone().set_requires_grad(true),
                                     rows.answer.stiffness.clone().set_requires_grad(true)};
    const auto value = [&](const std::vector<Tensor>& of) {
      return row_losses(options, {of[0], of[1], of[2]}, rows.truth, rows.directions).sum();
    };
    const auto slopes = torch::autograd::grad({value(leaves)}, leaves);
    constexpr double step = 1e-6;
    for (std::size_t k = 0; k < leaves.size(); ++k) {
      for (long i = 0; i < leaves[k].numel(); ++i) {
        const auto moved = [&](double by) {
          std::vector<Tensor> of;
          for (const auto& leaf : leaves) of.push_back(leaf.detach().clone());
          of[k].data_ptr<double>()[i] += by;
          return value(of).item<double>();
        };
        EXPECT_NEAR(slopes[k].reshape(-1)[i].item<double>(), (moved(step) - moved(-step)) / (2 * step), 1e-8)
            << to_string(loss) << ", output " << k << ", number " << i;
      }
    }
  }
}

}  // namespace
}  // namespace supple::training
