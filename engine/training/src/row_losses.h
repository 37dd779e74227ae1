#pragma once

#include <torch/types.h>

#include "supple/training/trainer.h"
#include "torch_network.h"
#include "training_batches.h"

namespace supple::training {

/// What each row adds to the loss (see LossKind), from what the network answers and what the simulation says: the
/// weighted terms of energy, stress and, where there are `directions` (rows x 3), of the tangent along them. The
/// stiffness along a direction is to be 1 MPa or of that order: its error is not divided by it. Differentiable by the
/// answer.
torch::Tensor row_losses(const TrainingOptions& options, const Response& answer, const LabelledBatch& rows,
                         const torch::Tensor& directions);

}  // namespace supple::training
