#pragma once

#include <torch/types.h>

#include "supple/neural/network.h"

namespace supple::training {

/// The activation function f, its derivative f' and its second derivative f'' of each number. They use LibTorch's
/// operations, are differentiable any number of times, and run on any device.
torch::Tensor activated(neural::Activation activation, const torch::Tensor& z);
torch::Tensor activation_slope(neural::Activation activation, const torch::Tensor& z);
torch::Tensor activation_curvature(neural::Activation activation, const torch::Tensor& z);

/// A hidden layer f(x weights^T + bias) of jets x (see JetSizes): channels x rows x inputs -> channels x rows x
/// outputs, where outputs is a multiple of 16. In single precision on the CPU it uses our kernels, and is
/// differentiable once, with respect to x, weights and bias. Otherwise it uses LibTorch's operations. `directions`
/// (rows x 3, contiguous) are those of the second derivative, the fifth channel. May be called in several threads at
/// once.
torch::Tensor jet_layer(neural::Activation activation, const torch::Tensor& x, const torch::Tensor& weights,
                        const torch::Tensor& bias, const torch::Tensor& directions);

/// f(z) of jets z, channels x rows x outputs as in jet_layer.
torch::Tensor jet_activation(neural::Activation activation, const torch::Tensor& z, const torch::Tensor& directions);

/// The product x weights^T of jets x, without bias and activation function, for any number of outputs.
torch::Tensor linear_layer(const torch::Tensor& x, const torch::Tensor& weights);

}  // namespace supple::training
