#pragma once

#include "supple/neural/network.h"

namespace supple::training {

/// The layout of jets, which are values with derivatives with respect to the strain (e1, e2, e3). There is the value
/// alone (1 channel), or also the three first derivatives (4 channels), or also the second derivative along a direction
/// that is given for each row (5 channels). Channel c of row r begins at index (c * rows + r) * width. The width is a
/// multiple of 16. `directions` have three numbers for each row.
struct JetSizes {
  int channels = 1;
  int rows = 0;
  int width = 0;
  int numbers() const { return channels * rows * width; }
};

/// Computes the jets y = f(z + bias), where f is the activation function. The bias is added to the values alone.
void jet_forward(neural::Activation activation, const JetSizes& sizes, const float* directions, const float* bias,
                 const float* z, float* y);

/// Backpropagation through jet_forward: from the gradient with respect to y, those with respect to z and to the bias.
void jet_backward(neural::Activation activation, const JetSizes& sizes, const float* directions, const float* bias,
                  const float* z, const float* grad_y, float* grad_z, float* grad_bias);

}  // namespace supple::training
