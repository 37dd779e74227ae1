#pragma once

#include <torch/types.h>

#include "supple/training/trainer.h"
#include "torch_network.h"
#include "training_batches.h"

namespace supple::training {

/// The loss of each row (see TrainingOptions), from the network's answer and the simulated values. It is the weighted
/// sum of the terms of the energy, the stress and, if there are `directions` v (rows x 3), the stiffness v^T C v. The
/// error of the latter is not divided by its value. Therefore directions must be such that it is about 1 MPa. The loss
/// is differentiable with respect to the answer.
torch::Tensor row_losses(const TrainingOptions& options, const Response& answer, const LabelledBatch& rows,
                         const torch::Tensor& directions);

}  // namespace supple::training
