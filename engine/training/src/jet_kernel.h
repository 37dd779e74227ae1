#pragma once

#include "supple/neural/network.h"

namespace supple::training {

/// Jets as training propagates them: values alone (1 channel), with derivatives by e1, e2, e3 (4 channels), or with the
/// second derivative along a direction of each row besides (5 channels). Channel c of row r begins at (c rows + r)
/// width, where width is a multiple of 16; `directions` are three numbers a row.
struct JetSizes {
  int channels = 1;
  int rows = 0;
  int width = 0;
  int numbers() const { return channels * rows * width; }
};

/// y = f(z + bias); the bias concerns values only.
void jet_forward(neural::Activation activation, const JetSizes& sizes, const float* directions, const float* bias,
                 const float* z, float* y);

/// From the derivatives g by y: those by z, and their sum over rows, by the bias.
void jet_backward(neural::Activation activation, const JetSizes& sizes, const float* directions, const float* bias,
                  const float* z, const float* g, float* by_z, float* by_bias);

}  // namespace supple::training
