#pragma once

#include <torch/types.h>

#include <vector>

#include "supple/neural/network.h"

namespace supple::training {

/// The tensors of a network in a fixed order: weights and bias of each layer, of the strain branch, the parameter
/// branch, the trunk and the stiffness branch.
using Parameters = std::vector<torch::Tensor>;

/// How inputs are scaled when weights are drawn: the strain branch's first layer sees strains times a factor between
/// these, drawn with a uniform logarithm for each neuron. Buckling bends the energy at strains of a hundredth, the
/// whole range is fifty times as wide.
struct InputScales {
  double smallest = 1;
  double largest = 20;
};

/// Draws the weights of a network of this shape. The last layer begins near zero.
neural::Network draw_network(const neural::NetworkShape& shape, const Eigen::VectorXd& lower,
                             const Eigen::VectorXd& upper, const InputScales& scales, std::int64_t seed);

Parameters to_parameters(const neural::Network& network, torch::Dtype type, torch::Device device);
/// Puts the tensors' numbers in the layers of `network`, which has their shape.
void assign(neural::Network& network, const Parameters& parameters);

/// Strains of several designs: strain i (e, i-th row) belongs to design of[i], whose parameters, mapped to [-1, 1], and
/// features are a row of p.
struct Batch {
  torch::Tensor p;   ///< designs x (parameters + features)
  torch::Tensor of;  ///< rows, int64
  torch::Tensor e;   ///< rows x 3
};

/// The energy density of each strain, with LibTorch's operations alone: differentiable as often as wanted, in any
/// precision, on any device. What everything else is compared with.
torch::Tensor energy(const neural::NetworkShape& shape, const Parameters& parameters, const Batch& batch);

/// Energy (rows), stress (rows x 3) and, where a direction v of each is given, v^T C v (rows) of the tangent C.
struct Response {
  torch::Tensor energy;
  torch::Tensor stress;
  torch::Tensor stiffness;
};

/// The same with jets: in single precision on the processor through our kernels, which are differentiable once by the
/// parameters, elsewhere through LibTorch's operations. `directions` are rows x 3, or undefined.
Response response(const neural::NetworkShape& shape, const Parameters& parameters, const Batch& batch,
                  const torch::Tensor& directions);

/// The same through autograd of `energy`, on any device and in any precision.
Response response_by_autograd(const neural::NetworkShape& shape, const Parameters& parameters, const Batch& batch,
                              const torch::Tensor& directions);

/// Where the stiffness branch begins among the parameters; it goes on to their end.
std::size_t stiffness_begin(const neural::NetworkShape& shape);
/// The six outputs of a stiffness branch, whose parameters alone are given: designs x 6.
torch::Tensor stiffness_outputs(const Parameters& branch, const torch::Tensor& p);
/// L of these outputs: designs x 3 x 3.
torch::Tensor stiffness_factor(const torch::Tensor& outputs);

}  // namespace supple::training
