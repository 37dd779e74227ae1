#pragma once

#include <torch/types.h>

namespace supple::training {

/// Whether our kernels can read a tensor: it is in single precision, in the memory of the CPU.
bool supported_by_kernels(const torch::Tensor& tensor);

/// The product of two matrices, each of which may be transposed first. Where they are supported, it uses our kernels,
/// which, unlike some builds of BLAS, may run in several threads at once. Otherwise it uses LibTorch.
torch::Tensor product(const torch::Tensor& a, bool transpose_a, const torch::Tensor& b, bool transpose_b);

}  // namespace supple::training
