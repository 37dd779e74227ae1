#pragma once

#include "supple/base/random.h"
#include "supple/neural/network.h"

namespace supple::neural {

/// A network whose weights are drawn from a named stream: as large as those of trained ones, so that its function
/// bends.
inline Network random_network(NetworkShape shape, std::uint64_t seed) {
  RandomStream stream("random network", seed);
  const auto layer = [&](long outputs, long inputs, double gain) {
    Layer made{Eigen::MatrixXd(outputs, inputs), Eigen::VectorXd(outputs)};
    for (long j = 0; j < inputs; ++j)
      for (long i = 0; i < outputs; ++i)
        made.weights(i, j) = gain / std::sqrt(static_cast<double>(inputs)) * stream.normal();
    for (long i = 0; i < outputs; ++i) made.bias[i] = 0.3 * stream.normal();
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
    network.strain.push_back(layer(width, i == 0 ? shape.strain_inputs() : width, i == 0 ? 6 : 1.6));
  for (int i = 0; i < shape.parameter_layers; ++i)
    network.parameter.push_back(layer(width, i == 0 ? shape.parameters : width, 1.6));
  for (int i = 0; i < shape.trunk_layers; ++i) network.trunk.push_back(layer(width, i == 0 ? 2 * width : width, 1.6));
  network.trunk.push_back(layer(shape.outputs(), width, 1));
  if (shape.form == EnergyForm::sum_of_squares) {
    network.stiffness.push_back(layer(shape.stiffness_width, shape.parameters, 1));
    network.stiffness.push_back(layer(shape.stiffness_width, shape.stiffness_width, 1));
    network.stiffness.push_back(layer(6, shape.stiffness_width, 0.5));
  }
  return network;
}

}  // namespace supple::neural
