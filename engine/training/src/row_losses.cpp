#include "row_losses.h"

#include <torch/types.h>

namespace supple::training {

torch::Tensor row_losses(const TrainingOptions& options, const Response& answer, const LabelledBatch& rows,
                         const torch::Tensor& directions) {
  const auto loss_of_square = [&](const torch::Tensor& square) {
    if (options.loss == LossKind::squared) return square;
    return torch::log1p((square + options.error_floor * options.error_floor).sqrt());
  };
  auto losses = options.energy_weight * loss_of_square((answer.energy / rows.energy - 1).square()) +
                options.stress_weight *
                    loss_of_square((answer.stress - rows.stress).square().sum(1) / rows.stress.square().sum(1));
  if (directions.defined()) {
    const auto simulated_stiffness = (rows.tangent * directions.unsqueeze(1)).sum(2).mul(directions).sum(1);
    losses = losses + options.tangent_weight * loss_of_square((answer.stiffness - simulated_stiffness).square());
  }
  return losses;
}

}  // namespace supple::training
