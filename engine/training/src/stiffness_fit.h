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

/// Training data of a stiffness branch: designs as inputs of the network, and the Cholesky factors L* of their
/// stiffness at rest.
struct StiffnessTargets {
  Eigen::MatrixXd inputs;                ///< (parameters + features) x designs
  std::vector<Eigen::Matrix3d> factors;  ///< lower triangular, sqrt(MPa)

  long designs() const { return inputs.cols(); }
};

/// The targets of designs and of their images under the options' symmetries. Images are left out unless they lie in the
/// range of the data (see `usable_image`). `held_out` has indices of designs of the samples. Designs and images that
/// coincide with one of these are left out, so that the network is not trained on test data.
StiffnessTargets stiffness_targets(const Samples& samples, const std::vector<RestStiffness>& rest,
                                   const std::vector<int>& held_out, const TrainingOptions& options);

/// Fits a stiffness branch in place by SOAP, with steps of `options.stiffness_batch` designs. With `set_mean_bias` the
/// mean of the targets becomes the last bias first. The loss of a design is log(1 + |L*^-1 L - I|), where the
/// Frobenius norm measures the relative error of the energy over all strains, plus a tenth of the mean error of the six
/// outputs. The latter makes the fit converge from far away. If there are 200 designs or more, a twentieth is held out
/// to measure errors. Returns nothing if it was cancelled. Steps of 512 designs take 15 ms for three layers of 128
/// neurons.
std::optional<StiffnessReport> fit_stiffness(Parameters& branch, const StiffnessTargets& targets,
                                             const TrainingOptions& options, bool set_mean_bias,
                                             const CancellationToken& cancellation,
                                             const std::function<void(const StiffnessReport&)>& report);

}  // namespace supple::training
