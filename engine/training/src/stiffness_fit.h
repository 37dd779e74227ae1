#pragma once

#include <torch/types.h>

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/training/trainer.h"
#include "torch_network.h"

namespace supple::training {

/// What a stiffness branch learns: designs as the network reads them, and the Cholesky factors L* of their stiffness at
/// rest.
struct StiffnessTargets {
  Eigen::MatrixXd inputs;                ///< (parameters + features) x designs
  std::vector<Eigen::Matrix3d> factors;  ///< lower triangular, sqrt(MPa)

  long designs() const { return inputs.cols(); }
};

/// Designs with the stiffness that they and their images under the options' symmetries have at rest, as far as images
/// lie where data do (see `usable_image`). Those that lie on a design of `held_out` (indices into the samples') are
/// left out: nothing of what judges is learned.
StiffnessTargets stiffness_targets(const Samples& samples, const std::vector<RestStiffness>& rest,
                                   const std::vector<int>& held_out, const TrainingOptions& options);

/// Fits a stiffness branch in place, steps of `options.stiffness_batch` designs, by SOAP; `draw_mean` puts the targets'
/// mean into the last bias first. A design adds log(1 + |L*^-1 L - 1|), the relative error of the energy along all
/// directions, and a tenth of that of the six outputs, which leads from afar. Of 200 designs and more a twentieth is
/// kept apart to measure on. Returns nothing if it was cancelled. Steps of 512 designs take 15 ms for three layers of
/// 128.
std::optional<StiffnessReport> fit_stiffness(Parameters& branch, const StiffnessTargets& targets,
                                             const TrainingOptions& options, bool draw_mean,
                                             const CancellationToken& cancellation,
                                             const std::function<void(const StiffnessReport&)>& report);

}  // namespace supple::training
