#include "torch_network.h"

#include <torch/autograd.h>
#include <torch/types.h>

#include <cmath>

#include "jet_layer.h"
#include "matrix_product.h"
#include "supple/base/random.h"

namespace supple::training {
namespace {

using neural::Activation;
using neural::EnergyForm;
using neural::Layer;
using neural::Network;
using neural::NetworkShape;
using torch::Tensor;

/// Standard deviation of weights over 1 / sqrt(inputs): keeps the size of activations through the layers.
constexpr double hidden_gain = 1.4;
constexpr double first_gain = 1.7;
constexpr double first_bias = 0.3;
constexpr double last_gain = 0.02;
/// Softplus at rest, before training: a small energy.
constexpr double softplus_bias = -4;

template <class Visit>
void for_each_layer(Network& network, Visit&& visit) {
  for (auto* branch : {&network.strain, &network.parameter, &network.trunk, &network.stiffness})
    for (auto& layer : *branch) visit(layer);
}

/// Where in Parameters each branch begins.
struct Places {
  explicit Places(const NetworkShape& shape)
      : parameter(2 * shape.strain_layers),
        trunk(parameter + 2 * shape.parameter_layers),
        stiffness(trunk + 2 * (shape.trunk_layers + 1)) {}
  int strain = 0;
  int parameter;
  int trunk;
  int stiffness;
};

const Tensor& weights(const Parameters& parameters, int branch, int layer) {
  return parameters[static_cast<std::size_t>(branch + 2 * layer)];
}
const Tensor& bias(const Parameters& parameters, int branch, int layer) {
  return parameters[static_cast<std::size_t>(branch + 2 * layer + 1)];
}

Tensor activated(Activation activation, const Tensor& z) {
  switch (activation) {
    case Activation::swish:
      return z * torch::sigmoid(z);
    case Activation::tanh:
      return torch::tanh(z);
    default:
      return torch::sin(z);
  }
}

/// L^T / sqrt(s) (designs x 3 x 3) and s (designs).
struct Scaling {
  Tensor map;
  Tensor stiffness;
};

Scaling scaling(const Tensor& outputs) {
  const auto column = [&](int i) { return outputs.select(1, i); };
  const auto a = torch::exp(column(0));
  const auto b = torch::exp(column(1));
  const auto c = torch::exp(column(2));
  const auto d = column(3) * a;
  const auto e = column(4) * a;
  const auto f = column(5) * b;
  const auto stiffness = (a * a + b * b + c * c + d * d + e * e + f * f) / 3;
  const auto zero = torch::zeros_like(a);
  const auto transposed =
      torch::stack({torch::stack({a, d, e}, 1), torch::stack({zero, b, f}, 1), torch::stack({zero, zero, c}, 1)}, 1);
  return {transposed * torch::rsqrt(stiffness).reshape({-1, 1, 1}), stiffness};
}

/// map x for each row: [n, 3, 3] and [n, 3].
Tensor apply(const Tensor& map, const Tensor& x) { return (map * x.unsqueeze(1)).sum(2); }

/// A branch that reads designs, with our kernels where they can.
Tensor branch_of_designs(const NetworkShape& shape, const Parameters& parameters, const Tensor& p, bool ours) {
  const Places places(shape);
  Tensor h = p;
  for (int l = 0; l < shape.parameter_layers; ++l) {
    const auto& w = weights(parameters, places.parameter, l);
    const auto z = ours ? linear_layer(h.unsqueeze(0), w).squeeze(0) : torch::mm(h, w.t());
    h = activated(shape.activation, z + bias(parameters, places.parameter, l));
  }
  const auto meeting = weights(parameters, places.trunk, 0).slice(1, shape.width);
  return (ours ? linear_layer(h.unsqueeze(0), meeting).squeeze(0) : torch::mm(h, meeting.t())) +
         bias(parameters, places.trunk, 0);
}

/// The last layer's outputs N, without its bias: channels x rows x outputs, from the jets of the strain branch's input.
/// `meeting` is the parameter branch's addend for each row.
Tensor outputs_by_jets(const NetworkShape& shape, const Parameters& parameters, Tensor x, const Tensor& meeting,
                       const Tensor& directions) {
  const Places places(shape);
  for (int l = 0; l < shape.strain_layers; ++l)
    x = jet_layer(shape.activation, x, weights(parameters, places.strain, l), bias(parameters, places.strain, l),
                  directions);
  // Where the branches meet, the addend differs from row to row: the kernel's bias is zero there.
  x = linear_layer(x, weights(parameters, places.trunk, 0).slice(1, 0, shape.width));
  x = torch::cat({x.slice(0, 0, 1) + meeting.unsqueeze(0), x.slice(0, 1)}, 0);
  x = jet_activation(shape.activation, x, directions);
  for (int l = 1; l < shape.trunk_layers; ++l)
    x = jet_layer(shape.activation, x, weights(parameters, places.trunk, l), bias(parameters, places.trunk, l),
                  directions);
  return linear_layer(x, weights(parameters, places.trunk, shape.trunk_layers));
}

Tensor outputs(const NetworkShape& shape, const Parameters& parameters, Tensor x, const Tensor& meeting) {
  const Places places(shape);
  const auto layer = [&](const Tensor& in, int branch, int l) {
    return torch::mm(in, weights(parameters, branch, l).t()) + bias(parameters, branch, l);
  };
  for (int l = 0; l < shape.strain_layers; ++l) x = activated(shape.activation, layer(x, places.strain, l));
  x = activated(shape.activation,
                torch::mm(x, weights(parameters, places.trunk, 0).slice(1, 0, shape.width).t()) + meeting);
  for (int l = 1; l < shape.trunk_layers; ++l) x = activated(shape.activation, layer(x, places.trunk, l));
  return torch::mm(x, weights(parameters, places.trunk, shape.trunk_layers).t());
}

/// Channels of a constant map of e: its value, its columns, and no second derivative.
Tensor jets_of_map(const Tensor& map, const Tensor& e, bool second) {
  std::vector<Tensor> channels{apply(map, e).unsqueeze(0), map.permute({2, 0, 1})};
  if (second) channels.push_back(torch::zeros({1, e.size(0), map.size(1)}, e.options()));
  return torch::cat(channels, 0);
}

}  // namespace

Network draw_network(const NetworkShape& shape, const Eigen::VectorXd& lower, const Eigen::VectorXd& upper,
                     const InputScales& scales, std::int64_t seed) {
  RandomStream stream("network weights", static_cast<std::uint64_t>(seed));
  const auto draw = [&](long rows, long columns, double gain) {
    Layer layer{Eigen::MatrixXd(rows, columns), Eigen::VectorXd::Zero(rows)};
    for (long i = 0; i < rows; ++i)
      for (long j = 0; j < columns; ++j)
        layer.weights(i, j) = gain / std::sqrt(static_cast<double>(columns)) * stream.normal();
    return layer;
  };
  Network network;
  network.shape = shape;
  network.lower = lower;
  network.upper = upper;
  const long width = shape.width;
  network.strain.push_back(draw(width, shape.strain_inputs(), first_gain));
  for (long i = 0; i < width; ++i) {
    network.strain[0].weights.row(i) *= std::exp(stream.uniform(std::log(scales.smallest), std::log(scales.largest)));
    network.strain[0].bias[i] = first_bias * stream.normal();
  }
  for (int l = 1; l < shape.strain_layers; ++l) network.strain.push_back(draw(width, width, hidden_gain));
  for (int l = 0; l < shape.parameter_layers; ++l)
    network.parameter.push_back(draw(width, l == 0 ? shape.parameters : width, hidden_gain));
  for (int l = 0; l < shape.trunk_layers; ++l)
    network.trunk.push_back(draw(width, l == 0 ? 2 * width : width, hidden_gain));
  network.trunk.push_back(draw(shape.outputs(), width, last_gain));
  if (shape.form == EnergyForm::softplus) {
    network.trunk.back().bias.setConstant(softplus_bias);
  } else {
    network.stiffness.push_back(draw(shape.stiffness_width, shape.parameters, hidden_gain));
    network.stiffness.push_back(draw(shape.stiffness_width, shape.stiffness_width, hidden_gain));
    network.stiffness.push_back(draw(6, shape.stiffness_width, 0.1));
  }
  return network;
}

Parameters to_parameters(const Network& network, torch::Dtype type, torch::Device device) {
  Parameters parameters;
  const auto add = [&](const Eigen::MatrixXd& matrix, bool vector) {
    const Eigen::Matrix<double, -1, -1, Eigen::RowMajor> rows = matrix;
    auto tensor = torch::empty({rows.rows(), rows.cols()}, torch::kDouble);
    std::copy_n(rows.data(), rows.size(), tensor.data_ptr<double>());
    if (vector) tensor = tensor.squeeze(1);
    parameters.push_back(tensor.to(device, type).contiguous());
  };
  auto copy = network;
  for_each_layer(copy, [&](Layer& layer) {
    add(layer.weights, false);
    add(layer.bias, true);
  });
  return parameters;
}

void assign(Network& network, const Parameters& parameters) {
  std::size_t next = 0;
  const auto take = [&]() { return parameters[next++].detach().to(torch::kCPU, torch::kDouble).contiguous(); };
  for_each_layer(network, [&](Layer& layer) {
    const auto w = take();
    const auto b = take();
    using RowMajor = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;
    layer.weights = Eigen::Map<const RowMajor>(w.data_ptr<double>(), w.size(0), w.size(1));
    layer.bias = Eigen::Map<const Eigen::VectorXd>(b.data_ptr<double>(), b.size(0));
  });
}

Tensor stiffness_outputs(const NetworkShape& shape, const Parameters& parameters, const Tensor& p) {
  const Places places(shape);
  const bool ours = for_our_kernels(p);
  Tensor q = p;
  for (int l = 0; l < 3; ++l) {
    const auto& w = weights(parameters, places.stiffness, l);
    q = (ours ? linear_layer(q.unsqueeze(0), w).squeeze(0) : torch::mm(q, w.t())) +
        bias(parameters, places.stiffness, l);
    if (l < 2) q = activated(Activation::swish, q);
  }
  return q;
}

Tensor energy(const NetworkShape& shape, const Parameters& parameters, const Batch& batch) {
  const auto meeting = branch_of_designs(shape, parameters, batch.p, false);
  const Places places(shape);
  if (shape.form == EnergyForm::softplus) {
    const auto n = outputs(shape, parameters, batch.e, meeting.index_select(0, batch.of)) +
                   bias(parameters, places.trunk, shape.trunk_layers);
    return torch::softplus(n.squeeze(1), 1, 40);
  }
  const auto [map, stiffness] = scaling(stiffness_outputs(shape, parameters, batch.p));
  const auto y = apply(map.index_select(0, batch.of), batch.e);
  const auto n = outputs(shape, parameters, torch::cat({y, batch.e}, 1), meeting.index_select(0, batch.of));
  const auto rest = outputs(shape, parameters, torch::zeros({batch.p.size(0), 6}, batch.e.options()), meeting);
  const auto skip = torch::cat({y, torch::zeros({y.size(0), shape.residuals - 3}, y.options())}, 1);
  const auto r = n - rest.index_select(0, batch.of) + skip;
  return 0.5 * stiffness.index_select(0, batch.of) * (r * r).sum(1);
}

Response response_by_autograd(const NetworkShape& shape, const Parameters& parameters, const Batch& batch,
                              const Tensor& directions) {
  auto leaf = batch;
  leaf.e = batch.e.detach().clone().set_requires_grad(true);
  Response result;
  result.energy = energy(shape, parameters, leaf);
  result.stress = torch::autograd::grad({result.energy.sum()}, {leaf.e}, {}, true, true)[0];
  if (directions.defined()) {
    const auto along = (result.stress * directions).sum();
    result.stiffness = (torch::autograd::grad({along}, {leaf.e}, {}, true, true)[0] * directions).sum(1);
  }
  return result;
}

Response response(const NetworkShape& shape, const Parameters& parameters, const Batch& batch,
                  const Tensor& directions) {
  const bool second = directions.defined();
  const auto v = second ? directions : torch::zeros({batch.e.size(0), 3}, batch.e.options());
  const auto meeting = branch_of_designs(shape, parameters, batch.p, true);
  const Places places(shape);
  const auto rows = batch.e.size(0);
  const auto identity = torch::eye(3, batch.e.options()).unsqueeze(0).expand({rows, 3, 3});
  Response result;
  if (shape.form == EnergyForm::softplus) {
    const auto n =
        outputs_by_jets(shape, parameters, jets_of_map(identity, batch.e, second), meeting.index_select(0, batch.of), v)
            .squeeze(2);
    const auto value = n[0] + bias(parameters, places.trunk, shape.trunk_layers);
    const auto slope = torch::sigmoid(value);
    result.energy = torch::softplus(value, 1, 40);
    result.stress = (slope * n.slice(0, 1, 4)).t();
    if (second) {
      const auto along = (n.slice(0, 1, 4).t() * v).sum(1);
      result.stiffness = slope * n[4] + slope * (1 - slope) * along * along;
    }
    return result;
  }
  const auto scaled = scaling(stiffness_outputs(shape, parameters, batch.p));
  const auto map = scaled.map.index_select(0, batch.of);
  const auto stiffness = scaled.stiffness.index_select(0, batch.of);
  const auto mapped = jets_of_map(map, batch.e, second);
  const auto inputs = torch::cat({mapped, jets_of_map(identity, batch.e, second)}, 2);
  // The designs at rest are further rows: their values alone are needed, but a pass of their own costs more.
  const auto n = outputs_by_jets(shape, parameters, torch::constant_pad_nd(inputs, {0, 0, 0, batch.p.size(0)}),
                                 torch::cat({meeting.index_select(0, batch.of), meeting}),
                                 torch::constant_pad_nd(v, {0, 0, 0, batch.p.size(0)}));
  const auto jets = n.narrow(1, 0, rows) + torch::constant_pad_nd(mapped, {0, shape.residuals - 3});
  const auto r = jets[0] - n[0].narrow(0, rows, batch.p.size(0)).index_select(0, batch.of);
  result.energy = 0.5 * stiffness * (r * r).sum(1);
  result.stress = stiffness.unsqueeze(1) * (r.unsqueeze(0) * jets.slice(0, 1, 4)).sum(2).t();
  if (second) {
    const auto along = (jets.slice(0, 1, 4) * v.t().unsqueeze(2)).sum(0);
    result.stiffness = stiffness * ((along * along).sum(1) + (r * jets[4]).sum(1));
  }
  return result;
}

}  // namespace supple::training
