#pragma once

#include <Eigen/Core>

namespace supple::training {

/// The outputs of a stiffness branch (see neural::Network).
using StiffnessOutputs = Eigen::Matrix<double, 6, 1>;

/// The outputs that represent the Cholesky factor L of a stiffness L L^T.
StiffnessOutputs outputs_of(const Eigen::Matrix3d& factor);
/// The Cholesky factor L that the outputs represent.
Eigen::Matrix3d factor_of(const StiffnessOutputs& outputs);

}  // namespace supple::training
