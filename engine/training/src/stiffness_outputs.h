#pragma once

#include <Eigen/Core>

namespace supple::training {

/// The outputs of a stiffness branch, see neural::NetworkShape.
using StiffnessOutputs = Eigen::Matrix<double, 6, 1>;

/// The outputs that stand for the Cholesky factor L of a stiffness L L^T.
StiffnessOutputs outputs_of(const Eigen::Matrix3d& factor);
/// The reverse.
Eigen::Matrix3d factor_of(const StiffnessOutputs& outputs);

}  // namespace supple::training
