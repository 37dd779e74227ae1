#pragma once

#include <cmath>
#include <string>

#include "supple/base/random.h"
#include "supple/neural/network.h"

namespace supple::neural {

/// Standard deviations of random weights, times the square root of a layer's inputs; as large as those of trained ones,
/// so that the function bends.
struct RandomWeights {
  double first = 6;  ///< of the layer that reads strains
  double hidden = 1.6;
  double last = 1;
  double bias = 0.3;  ///< of the biases themselves
};

/// A network whose weights are drawn from a named stream.
inline Network random_network(NetworkShape shape, std::uint64_t seed, const RandomWeights& weights = {}) {
  RandomStream stream("random network", seed);
  const auto layer = [&](long outputs, long inputs, double gain) {
    Layer made{Eigen::MatrixXd(outputs, inputs), Eigen::VectorXd(outputs)};
    for (long j = 0; j < inputs; ++j)
      for (long i = 0; i < outputs; ++i)
        made.weights(i, j) = gain / std::sqrt(static_cast<double>(inputs)) * stream.normal();
    for (long i = 0; i < outputs; ++i) made.bias[i] = weights.bias * stream.normal();
    return made;
  };
  Network network;
  network.shape = shape;
  network.lower.resize(shape.parameters);
  network.upper.resize(shape.parameters);
  for (int k = 0; k < shape.parameters; ++k) {
    network.lower[k] = 0.1 * k;
    network.upper[k] = 0.5 + 0.3 * k;
  }
  const long width = shape.width;
  for (int i = 0; i < shape.strain_layers; ++i)
    network.strain.push_back(
        layer(width, i == 0 ? shape.strain_inputs() : width, i == 0 ? weights.first : weights.hidden));
  for (int i = 0; i < shape.parameter_layers; ++i)
    network.parameter.push_back(layer(width, i == 0 ? shape.parameters : width, weights.hidden));
  for (int i = 0; i < shape.trunk_layers; ++i)
    network.trunk.push_back(layer(width, i == 0 ? 2 * width : width, weights.hidden));
  network.trunk.push_back(layer(shape.outputs(), width, weights.last));
  if (shape.form == EnergyForm::sum_of_squares) {
    network.stiffness.push_back(layer(shape.stiffness_width, shape.parameters, 1));
    network.stiffness.push_back(layer(shape.stiffness_width, shape.stiffness_width, 1));
    network.stiffness.push_back(layer(6, shape.stiffness_width, 0.5));
  }
  return network;
}

/// "sum_of_squares_swish_40_4", as part of a test's name.
inline std::string name_of(const NetworkShape& shape) {
  return std::string(to_string(shape.form)) + "_" + std::string(to_string(shape.activation)) + "_" +
         std::to_string(shape.width) + "_" + std::to_string(shape.parameters);
}

}  // namespace supple::neural
