#pragma once

#include <cmath>
#include <string>

#include "supple/base/random.h"
#include "supple/neural/network.h"

namespace supple::neural {

/// Standard deviations of random weights times the square root of a layer's number of inputs. They are as large as
/// those of trained networks, so that the function is nonlinear.
struct RandomWeights {
  double first = 6;  ///< for the layer whose inputs are strains
  double hidden = 1.6;
  double last = 1;
  double bias = 0.3;  ///< standard deviation of the biases, without that factor
};

/// A pentagon whose corners the parameters move so far that it crosses itself for some of them. It has features of all
/// kinds in turn.
inline TileGeometry random_geometry(int parameters, int features, RandomStream& stream) {
  constexpr int corners = 5;
  const auto point = [&](double x, double y, double moved) {
    Eigen::Matrix2Xd affine(2, 1 + parameters);
    affine.col(0) << x, y;
    for (int k = 1; k <= parameters; ++k) affine.col(k) << moved * stream.normal(), moved * stream.normal();
    return affine;
  };
  TileGeometry geometry;
  for (int i = 0; i < corners; ++i)
    geometry.vertices.push_back(point(std::cos(2 * M_PI * i / corners), std::sin(2 * M_PI * i / corners), 0.7));
  geometry.translations = {point(1.5, 0.2, 0.1), point(-0.1, 1.7, 0.1)};
  geometry.tiles = 2;
  geometry.beam_width = 0.12;
  for (int i = 0; i < features; ++i) {
    const auto kind = static_cast<FeatureKind>(i % 10);
    const int edge = i % corners;
    geometry.features.push_back({kind, edge, (edge + 2 + i / 10) % corners, 0.3 * stream.normal(), 0.8});
  }
  return geometry;
}

/// A network with random weights from a named stream.
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
    network.parameter.push_back(layer(width, i == 0 ? shape.design_inputs() : width, weights.hidden));
  for (int i = 0; i < shape.trunk_layers; ++i)
    network.trunk.push_back(layer(width, i == 0 ? 2 * width : width, weights.hidden));
  network.trunk.push_back(layer(shape.outputs(), width, weights.last));
  if (shape.form == EnergyForm::sum_of_squares) {
    for (int i = 0; i < shape.stiffness_layers; ++i)
      network.stiffness.push_back(
          layer(shape.stiffness_width, i == 0 ? shape.design_inputs() : shape.stiffness_width, 1));
    network.stiffness.push_back(layer(6, shape.stiffness_width, 0.5));
  }
  if (shape.features > 0) network.geometry = random_geometry(shape.parameters, shape.features, stream);
  return network;
}

/// The shape as part of a test's name, such as "sum_of_squares_swish_40_4".
inline std::string name_of(const NetworkShape& shape) {
  return std::string(to_string(shape.form)) + "_" + std::string(to_string(shape.activation)) + "_" +
         std::to_string(shape.width) + "_" + std::to_string(shape.parameters) +
         (shape.rest == RestForm::exact ? "_exact" : "") +
         (shape.features > 0 ? "_" + std::to_string(shape.features) + "_features" : "");
}

}  // namespace supple::neural
