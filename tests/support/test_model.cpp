#include "support/test_model.h"

#include <cmath>

#include "supple/base/random.h"

namespace supple::test {
namespace {

neural::Layer random_layer(RandomStream& stream, long outputs, long inputs, double gain) {
  neural::Layer layer{Eigen::MatrixXd(outputs, inputs), Eigen::VectorXd(outputs)};
  const double scale = gain / std::sqrt(static_cast<double>(inputs));
  for (long j = 0; j < inputs; ++j) {
    for (long i = 0; i < outputs; ++i) layer.weights(i, j) = scale * stream.normal();
  }
  for (long i = 0; i < outputs; ++i) layer.bias[i] = 0.1 * stream.normal();
  return layer;
}

neural::Network random_network(std::uint64_t seed, double gain) {
  RandomStream stream("test model", seed);
  neural::Network network;
  auto& shape = network.shape;
  shape.parameters = 2;
  shape.width = 16;
  shape.strain_layers = 2;
  shape.parameter_layers = 2;
  shape.trunk_layers = 2;
  shape.residuals = 4;
  shape.stiffness_width = 8;
  network.lower = Eigen::Vector2d(0.105, 0.505);
  network.upper = Eigen::Vector2d(0.195, 0.795);
  const long width = shape.width;
  for (int i = 0; i < shape.strain_layers; ++i)
    network.strain.push_back(random_layer(stream, width, i == 0 ? shape.strain_inputs() : width, i == 0 ? 2 : 1));
  for (int i = 0; i < shape.parameter_layers; ++i)
    network.parameter.push_back(random_layer(stream, width, i == 0 ? shape.parameters : width, 1));
  for (int i = 0; i < shape.trunk_layers; ++i)
    network.trunk.push_back(random_layer(stream, width, i == 0 ? 2 * width : width, 1));
  network.trunk.push_back(random_layer(stream, shape.outputs(), width, gain));
  network.stiffness.push_back(random_layer(stream, shape.stiffness_width, shape.parameters, 1));
  network.stiffness.push_back(random_layer(stream, shape.stiffness_width, shape.stiffness_width, 1));
  network.stiffness.push_back(random_layer(stream, 6, shape.stiffness_width, 0.5));
  return network;
}

}  // namespace

neural::Model test_model(const std::string& id, std::uint64_t seed, double gain) {
  neural::Model model;
  model.id = id;
  model.family = "IH21";
  model.network = random_network(seed, gain);
  model.strain_range = {-0.2, 0.3, 0.05};
  model.provenance.data_set = "none: the weights are random";
  model.provenance.data_engine = "none";
  model.provenance.engine = "test";
  model.provenance.seed = static_cast<std::int64_t>(seed);
  model.provenance.options = {{"kind", "random"}};
  model.design_split = neural::SplitErrors{{0.02, 0.03, 0.01, 0.1}, {0.01, 0.02, 0.005, 0.05}, 3, 300};
  return model;
}

}  // namespace supple::test
