#pragma once

#include <torch/types.h>

namespace supple::training {

/// Whether a tensor's numbers can be read by our kernels: single precision, in this machine's memory.
bool for_our_kernels(const torch::Tensor& tensor);

/// a b with either transposed first. On the processor by our kernels, which, unlike some builds of BLAS, may run in
/// several threads at once; elsewhere by LibTorch. Matrices with two dimensions.
torch::Tensor product(const torch::Tensor& a, bool transpose_a, const torch::Tensor& b, bool transpose_b);

}  // namespace supple::training
