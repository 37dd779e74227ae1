#include "support/test_model.h"

#include "support/random_network.h"

namespace supple::test {
namespace {

neural::Network random_network(std::uint64_t seed, double gain) {
  neural::NetworkShape shape;
  shape.parameters = 2;
  shape.width = 16;
  shape.strain_layers = 2;
  shape.parameter_layers = 2;
  shape.trunk_layers = 2;
  shape.residuals = 4;
  shape.stiffness_width = 8;
  auto network = neural::random_network(shape, seed, {.first = 2, .hidden = 1, .last = gain, .bias = 0.1});
  network.lower = Eigen::Vector2d(0.105, 0.505);
  network.upper = Eigen::Vector2d(0.195, 0.795);
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
