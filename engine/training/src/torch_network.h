#pragma once

#include <torch/types.h>

#include <vector>

#include "supple/neural/network.h"

namespace supple::training {

/// The tensors of a network: weights and bias of each layer. The order is strain branch, parameter branch, trunk,
/// stiffness branch.
using Parameters = std::vector<torch::Tensor>;

/// Initial scales of the strains. The weights of each neuron in the first layer of the strain branch are multiplied by
/// a factor between these limits, whose logarithm is drawn uniformly. The energy has features of two scales: it bends
/// at strains of 0.01 where structures buckle, and the whole range of strains is fifty times as wide.
struct InputScales {
  double min = 1;
  double max = 20;
};

/// Draws the weights of a network of this shape. The weights of the last layer are near zero.
neural::Network draw_network(const neural::NetworkShape& shape, const Eigen::VectorXd& lower,
                             const Eigen::VectorXd& upper, const InputScales& scales, std::int64_t seed);

Parameters to_parameters(const neural::Network& network, torch::Dtype type, torch::Device device);
/// Copies the tensors into the layers of `network`, which must have their shape.
void assign(neural::Network& network, const Parameters& parameters);

/// Strains of several designs.
struct Batch {
  torch::Tensor p;              ///< parameters, mapped to [-1, 1], and features: designs x (parameters + features)
  torch::Tensor design_of_row;  ///< row of p that belongs to each strain, int64
  torch::Tensor e;              ///< strains, rows x 3
};

/// The energy density of each strain. It uses LibTorch's operations alone, is differentiable any number of times, and
/// works in any precision on any device. Tests compare all other implementations with it.
torch::Tensor energy(const neural::NetworkShape& shape, const Parameters& parameters, const Batch& batch);

/// What the network predicts at each strain, with the tangent C.
struct Response {
  torch::Tensor energy;     ///< energy density in MPa, rows
  torch::Tensor stress;     ///< MPa, rows x 3
  torch::Tensor stiffness;  ///< v^T C v in MPa, rows, for the direction v of each row; undefined without directions
};

/// Computes the response by jets. In single precision on the CPU it uses our kernels, and is differentiable once, with
/// respect to the parameters. Otherwise it uses LibTorch's operations. `directions` are rows x 3, or undefined.
Response response(const neural::NetworkShape& shape, const Parameters& parameters, const Batch& batch,
                  const torch::Tensor& directions);

/// Computes the response by automatic differentiation of `energy`, on any device and in any precision.
Response response_by_autograd(const neural::NetworkShape& shape, const Parameters& parameters, const Batch& batch,
                              const torch::Tensor& directions);

/// The index in Parameters at which the stiffness branch begins. It is the last branch.
std::size_t stiffness_begin(const neural::NetworkShape& shape);
/// The six outputs of a stiffness branch, designs x 6. `branch` has the tensors of this branch alone.
torch::Tensor stiffness_outputs(const Parameters& branch, const torch::Tensor& p);
/// The Cholesky factors L that these outputs represent, designs x 3 x 3.
torch::Tensor stiffness_factor(const torch::Tensor& outputs);

}  // namespace supple::training
