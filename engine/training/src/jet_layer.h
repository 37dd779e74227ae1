#pragma once

#include <torch/types.h>

#include "supple/neural/network.h"

namespace supple::training {

/// f, f' and f'' of each number, through LibTorch's operations: differentiable as often as wanted, on any device.
torch::Tensor activated(neural::Activation activation, const torch::Tensor& z);
torch::Tensor activation_slope(neural::Activation activation, const torch::Tensor& z);
torch::Tensor activation_curvature(neural::Activation activation, const torch::Tensor& z);

/// f(x weights^T + bias) of jets x: channels x rows x inputs -> channels x rows x outputs, outputs a multiple of 16. In
/// single precision on the processor one pass each of our kernels forward and two products backward, differentiable
/// once, by x, weights and bias; elsewhere LibTorch's operations. `directions` (rows x 3, contiguous) are those of the
/// second derivative of five channels. Safe in several threads.
torch::Tensor jet_layer(neural::Activation activation, const torch::Tensor& x, const torch::Tensor& weights,
                        const torch::Tensor& bias, const torch::Tensor& directions);

/// f(z) of jets whose number of rows and outputs are as in jet_layer.
torch::Tensor jet_activation(neural::Activation activation, const torch::Tensor& z, const torch::Tensor& directions);

/// x weights^T for jets, without bias or activation; any number of outputs.
torch::Tensor linear_layer(const torch::Tensor& x, const torch::Tensor& weights);

}  // namespace supple::training
