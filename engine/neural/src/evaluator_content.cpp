#include "evaluator_content.h"

namespace supple::neural {
namespace {

template <class Real>
std::vector<Real> padded(const Eigen::VectorXd& values) {
  std::vector<Real> result(static_cast<std::size_t>(padded_rows(static_cast<int>(values.size()))), Real(0));
  for (long i = 0; i < values.size(); ++i) result[static_cast<std::size_t>(i)] = static_cast<Real>(values[i]);
  return result;
}

template <class Real>
std::vector<PackedLayer<Real>> hidden_layers(const Network& network) {
  std::vector<PackedLayer<Real>> layers;
  for (std::size_t i = 1; i < network.strain.size(); ++i)
    layers.emplace_back(network.strain[i].weights, network.strain[i].bias);
  // The bias of the first trunk layer is part of the design's trunk_bias.
  layers.emplace_back(network.trunk[0].weights.leftCols(network.shape.width),
                      Eigen::VectorXd::Zero(network.shape.width));
  for (std::size_t i = 1; i + 1 < network.trunk.size(); ++i)
    layers.emplace_back(network.trunk[i].weights, network.trunk[i].bias);
  return layers;
}

}  // namespace

template <class Real>
PackedLayer<Real>::PackedLayer(const Eigen::Ref<const Eigen::MatrixXd>& weights, const Eigen::VectorXd& bias_values)
    : forward(weights), backward(weights.transpose()), bias(padded<Real>(bias_values)) {}

template <class Real>
PackedNetwork<Real>::PackedNetwork(const Network& of)
    : network(of),
      design_layers(of),
      first_bias(padded<Real>(of.strain[0].bias)),
      hidden(hidden_layers<Real>(of)),
      last(of.trunk.back().weights, of.trunk.back().bias) {}

template <class Real>
PackedDesign<Real>::PackedDesign(const PackedNetwork<Real>& of, std::span<const double> parameters,
                                 bool with_parameter_derivatives)
    : exact(of.design_layers.evaluate(of.network, parameters, with_parameter_derivatives)),
      with_derivatives(with_parameter_derivatives),
      input(exact.input),
      trunk_bias(padded<Real>(exact.trunk_bias)) {
  const int maps = with_derivatives ? 1 + of.network.shape.parameters : 1;
  Eigen::MatrixXd back(3 * maps, of.network.shape.width);
  back.topRows<3>() = exact.input.transpose();
  for (int k = 1; k < maps; ++k)
    back.middleRows<3>(3 * k) = exact.input_by[static_cast<std::size_t>(k - 1)].transpose();
  input_back.assign(back);
  if (with_derivatives) trunk_bias_back.assign(exact.trunk_bias_by.transpose());
}

template struct PackedLayer<double>;
template struct PackedLayer<float>;
template struct PackedNetwork<double>;
template struct PackedNetwork<float>;
template struct PackedDesign<double>;
template struct PackedDesign<float>;

}  // namespace supple::neural
