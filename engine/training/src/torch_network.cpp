#include "torch_network.h"

#include <torch/autograd.h>
#include <torch/types.h>

#include <array>
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
using neural::RestForm;
using torch::Tensor;

/// The gain of a layer is the standard deviation of its initial weights times sqrt(inputs). The gain of the hidden
/// layers preserves the size of activations.
constexpr double hidden_gain = 1.4;
constexpr double first_gain = 1.7;
constexpr double first_bias_deviation = 0.3;
constexpr double last_gain = 0.02;
/// Initial bias of the last layer, before the softplus. It makes the energies of an untrained network small.
constexpr double softplus_bias = -4;
/// Logarithms of factors are clamped to this size, as in the evaluator. The stiffness is therefore finite for designs
/// far from the training data.
constexpr double max_log_factor = 20;

template <class Visit>
void for_each_layer(Network& network, Visit&& visit) {
  for (auto* branch : {&network.strain, &network.parameter, &network.trunk, &network.stiffness})
    for (auto& layer : *branch) visit(layer);
}

/// The index in Parameters at which each branch begins.
struct BranchOffsets {
  explicit BranchOffsets(const NetworkShape& shape)
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

/// The six entries of L on and below its diagonal: 11, 22, 33, 21, 31, 32.
std::array<Tensor, 6> entries_of_factor(const Tensor& outputs) {
  const auto column = [&](int i) { return outputs.select(1, i); };
  const auto diagonal = torch::exp(torch::clamp(outputs.slice(1, 0, 3), -max_log_factor, max_log_factor));
  const auto a = diagonal.select(1, 0);
  const auto b = diagonal.select(1, 1);
  const auto c = diagonal.select(1, 2);
  return {a, b, c, column(3) * a, column(4) * a, column(5) * b};
}

/// The map of strains to scaled strains y = L^T e / sqrt(s) (see neural::EnergyForm).
struct StrainScaling {
  Tensor map;        ///< L^T / sqrt(s), designs x 3 x 3
  Tensor stiffness;  ///< s in MPa, one for each design
};

StrainScaling strain_scaling(const Tensor& outputs) {
  const auto [a, b, c, d, e, f] = entries_of_factor(outputs);
  const auto stiffness = (a * a + b * b + c * c + d * d + e * e + f * f) / 3;
  const auto zero = torch::zeros_like(a);
  const auto transposed =
      torch::stack({torch::stack({a, d, e}, 1), torch::stack({zero, b, f}, 1), torch::stack({zero, zero, c}, 1)}, 1);
  return {transposed * torch::rsqrt(stiffness).reshape({-1, 1, 1}), stiffness};
}

/// The product map * x for each row, from tensors of the sizes n x 3 x 3 and n x 3.
Tensor apply(const Tensor& map, const Tensor& x) { return (map * x.unsqueeze(1)).sum(2); }

Parameters stiffness_branch(const NetworkShape& shape, const Parameters& parameters) {
  return {parameters.begin() + BranchOffsets(shape).stiffness, parameters.end()};
}

/// The parameter branch. It returns what the design adds to the inputs of the first trunk layer's activation function:
/// the product of the branch's output with that layer's weights, plus its bias, designs x width.
Tensor parameter_branch(const NetworkShape& shape, const Parameters& parameters, const Tensor& p, bool use_kernels) {
  const BranchOffsets offsets(shape);
  Tensor h = p;
  for (int l = 0; l < shape.parameter_layers; ++l) {
    const auto& w = weights(parameters, offsets.parameter, l);
    const auto z = use_kernels ? linear_layer(h.unsqueeze(0), w).squeeze(0) : torch::mm(h, w.t());
    h = activated(shape.activation, z + bias(parameters, offsets.parameter, l));
  }
  const auto design_weights = weights(parameters, offsets.trunk, 0).slice(1, shape.width);
  return (use_kernels ? linear_layer(h.unsqueeze(0), design_weights).squeeze(0) : torch::mm(h, design_weights.t())) +
         bias(parameters, offsets.trunk, 0);
}

/// The jets of the outputs N of the last layer, without its bias: channels x rows x outputs. `x` are jets of the strain
/// branch's input, and `design_addend` is the result of parameter_branch for the design of each row.
Tensor outputs_by_jets(const NetworkShape& shape, const Parameters& parameters, Tensor x, const Tensor& design_addend,
                       const Tensor& directions) {
  const BranchOffsets offsets(shape);
  for (int l = 0; l < shape.strain_layers; ++l)
    x = jet_layer(shape.activation, x, weights(parameters, offsets.strain, l), bias(parameters, offsets.strain, l),
                  directions);
  // In the first trunk layer the addend differs from row to row. It is added here, and the kernel's bias is zero.
  x = linear_layer(x, weights(parameters, offsets.trunk, 0).slice(1, 0, shape.width));
  x = torch::cat({x.slice(0, 0, 1) + design_addend.unsqueeze(0), x.slice(0, 1)}, 0);
  x = jet_activation(shape.activation, x, directions);
  for (int l = 1; l < shape.trunk_layers; ++l)
    x = jet_layer(shape.activation, x, weights(parameters, offsets.trunk, l), bias(parameters, offsets.trunk, l),
                  directions);
  return linear_layer(x, weights(parameters, offsets.trunk, shape.trunk_layers));
}

Tensor outputs(const NetworkShape& shape, const Parameters& parameters, Tensor x, const Tensor& design_addend) {
  const BranchOffsets offsets(shape);
  const auto layer = [&](const Tensor& in, int branch, int l) {
    return torch::mm(in, weights(parameters, branch, l).t()) + bias(parameters, branch, l);
  };
  for (int l = 0; l < shape.strain_layers; ++l) x = activated(shape.activation, layer(x, offsets.strain, l));
  x = activated(shape.activation,
                torch::mm(x, weights(parameters, offsets.trunk, 0).slice(1, 0, shape.width).t()) + design_addend);
  for (int l = 1; l < shape.trunk_layers; ++l) x = activated(shape.activation, layer(x, offsets.trunk, l));
  return torch::mm(x, weights(parameters, offsets.trunk, shape.trunk_layers).t());
}

/// The derivative N'(p, 0) of the outputs with respect to the strain, at zero strain: designs x outputs x 3. It is
/// propagated forward with the values, by LibTorch's operations. The input of the strain branch is (map e, e).
Tensor slope_at_rest(const NetworkShape& shape, const Parameters& parameters, const Tensor& map,
                     const Tensor& design_addend) {
  const BranchOffsets offsets(shape);
  const auto designs = map.size(0);
  Tensor x = torch::zeros({designs, 6}, map.options());
  Tensor slope = torch::cat({map, torch::eye(3, map.options()).unsqueeze(0).expand({designs, 3, 3})}, 1);
  const auto step = [&](const Tensor& w, const Tensor& addend) {
    const auto z = torch::mm(x, w.t()) + addend;
    x = activated(shape.activation, z);
    slope = activation_slope(shape.activation, z).unsqueeze(2) * torch::matmul(w, slope);
  };
  for (int l = 0; l < shape.strain_layers; ++l)
    step(weights(parameters, offsets.strain, l), bias(parameters, offsets.strain, l));
  step(weights(parameters, offsets.trunk, 0).slice(1, 0, shape.width), design_addend);
  for (int l = 1; l < shape.trunk_layers; ++l)
    step(weights(parameters, offsets.trunk, l), bias(parameters, offsets.trunk, l));
  return torch::matmul(weights(parameters, offsets.trunk, shape.trunk_layers), slope);
}

/// The linear term of the residuals, whose other term is N(p, e) - N(p, 0): its matrix, designs x residuals x 3.
/// `slope` is the result of slope_at_rest if the rest form is exact, and undefined otherwise.
Tensor linear_part(const NetworkShape& shape, const Tensor& map, const Tensor& slope) {
  const auto linear = torch::constant_pad_nd(map, {0, 0, 0, shape.residuals - 3});
  return slope.defined() ? linear - slope : linear;
}

/// The jets of the linear function map * e: value, derivatives and, if `second`, the second derivative, which is zero.
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
    network.strain[0].weights.row(i) *= std::exp(stream.uniform(std::log(scales.min), std::log(scales.max)));
    network.strain[0].bias[i] = first_bias_deviation * stream.normal();
  }
  for (int l = 1; l < shape.strain_layers; ++l) network.strain.push_back(draw(width, width, hidden_gain));
  for (int l = 0; l < shape.parameter_layers; ++l)
    network.parameter.push_back(draw(width, l == 0 ? shape.design_inputs() : width, hidden_gain));
  for (int l = 0; l < shape.trunk_layers; ++l)
    network.trunk.push_back(draw(width, l == 0 ? 2 * width : width, hidden_gain));
  network.trunk.push_back(draw(shape.outputs(), width, last_gain));
  if (shape.form == EnergyForm::softplus) {
    network.trunk.back().bias.setConstant(softplus_bias);
  } else {
    for (int l = 0; l < shape.stiffness_layers; ++l)
      network.stiffness.push_back(
          draw(shape.stiffness_width, l == 0 ? shape.design_inputs() : shape.stiffness_width, hidden_gain));
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
  const auto next_tensor = [&]() { return parameters[next++].detach().to(torch::kCPU, torch::kDouble).contiguous(); };
  for_each_layer(network, [&](Layer& layer) {
    const auto w = next_tensor();
    const auto b = next_tensor();
    using RowMajor = Eigen::Matrix<double, -1, -1, Eigen::RowMajor>;
    layer.weights = Eigen::Map<const RowMajor>(w.data_ptr<double>(), w.size(0), w.size(1));
    layer.bias = Eigen::Map<const Eigen::VectorXd>(b.data_ptr<double>(), b.size(0));
  });
}

std::size_t stiffness_begin(const NetworkShape& shape) {
  return static_cast<std::size_t>(BranchOffsets(shape).stiffness);
}

Tensor stiffness_outputs(const Parameters& branch, const Tensor& p) {
  const bool use_kernels = supported_by_kernels(p);
  Tensor q = p;
  for (std::size_t l = 0; l < branch.size(); l += 2) {
    q = (use_kernels ? linear_layer(q.unsqueeze(0), branch[l]).squeeze(0) : torch::mm(q, branch[l].t())) +
        branch[l + 1];
    if (l + 2 < branch.size()) q = activated(Activation::swish, q);
  }
  return q;
}

Tensor stiffness_factor(const Tensor& outputs) {
  const auto [a, b, c, d, e, f] = entries_of_factor(outputs);
  const auto zero = torch::zeros_like(a);
  return torch::stack({torch::stack({a, zero, zero}, 1), torch::stack({d, b, zero}, 1), torch::stack({e, f, c}, 1)}, 1);
}

Tensor energy(const NetworkShape& shape, const Parameters& parameters, const Batch& batch) {
  const auto design_addend = parameter_branch(shape, parameters, batch.p, false);
  const BranchOffsets offsets(shape);
  if (shape.form == EnergyForm::softplus) {
    const auto n = outputs(shape, parameters, batch.e, design_addend.index_select(0, batch.design_of_row)) +
                   bias(parameters, offsets.trunk, shape.trunk_layers);
    return torch::softplus(n.squeeze(1), 1, 40);
  }
  const auto [map, stiffness] = strain_scaling(stiffness_outputs(stiffness_branch(shape, parameters), batch.p));
  const auto y = apply(map.index_select(0, batch.design_of_row), batch.e);
  const auto n =
      outputs(shape, parameters, torch::cat({y, batch.e}, 1), design_addend.index_select(0, batch.design_of_row));
  const auto rest = outputs(shape, parameters, torch::zeros({batch.p.size(0), 6}, batch.e.options()), design_addend);
  Tensor slope;
  if (shape.rest == RestForm::exact) slope = slope_at_rest(shape, parameters, map, design_addend);
  const auto linear = linear_part(shape, map, slope).index_select(0, batch.design_of_row);
  const auto r = n - rest.index_select(0, batch.design_of_row) + apply(linear, batch.e);
  return 0.5 * stiffness.index_select(0, batch.design_of_row) * (r * r).sum(1);
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
  const auto design_addend = parameter_branch(shape, parameters, batch.p, supported_by_kernels(batch.p));
  const BranchOffsets offsets(shape);
  const auto rows = batch.e.size(0);
  const auto identity = torch::eye(3, batch.e.options()).unsqueeze(0).expand({rows, 3, 3});
  Response result;
  if (shape.form == EnergyForm::softplus) {
    const auto n = outputs_by_jets(shape, parameters, jets_of_map(identity, batch.e, second),
                                   design_addend.index_select(0, batch.design_of_row), v)
                       .squeeze(2);
    const auto value = n[0] + bias(parameters, offsets.trunk, shape.trunk_layers);
    const auto slope = torch::sigmoid(value);
    result.energy = torch::softplus(value, 1, 40);
    result.stress = (slope * n.slice(0, 1, 4)).t();
    if (second) {
      const auto along = (n.slice(0, 1, 4).t() * v).sum(1);
      result.stiffness = slope * n[4] + slope * (1 - slope) * along * along;
    }
    return result;
  }
  const auto scaled = strain_scaling(stiffness_outputs(stiffness_branch(shape, parameters), batch.p));
  const auto map = scaled.map.index_select(0, batch.design_of_row);
  const auto stiffness = scaled.stiffness.index_select(0, batch.design_of_row);
  const auto mapped = jets_of_map(map, batch.e, second);
  const auto inputs = torch::cat({mapped, jets_of_map(identity, batch.e, second)}, 2);
  // Zero strain of each design is one more row. Its second derivatives, and in the free form its slopes, are not
  // needed, but a separate pass would cost more.
  const auto designs = batch.p.size(0);
  const bool exact = shape.rest == RestForm::exact;
  Tensor all = torch::constant_pad_nd(inputs, {0, 0, 0, designs});
  if (exact) {
    const auto zero = torch::zeros({designs, 3}, batch.e.options());
    const auto unit = torch::eye(3, batch.e.options()).unsqueeze(0).expand({designs, 3, 3});
    all = torch::cat({inputs, torch::cat({jets_of_map(scaled.map, zero, second), jets_of_map(unit, zero, second)}, 2)},
                     1);
  }
  const auto n = outputs_by_jets(shape, parameters, all,
                                 torch::cat({design_addend.index_select(0, batch.design_of_row), design_addend}),
                                 torch::constant_pad_nd(v, {0, 0, 0, designs}));
  const auto at_rest = n.narrow(1, rows, designs);
  Tensor linear = torch::constant_pad_nd(mapped, {0, shape.residuals - 3});
  if (exact) {
    const auto maps = linear_part(shape, scaled.map, at_rest.slice(0, 1, 4).permute({1, 2, 0}));
    linear = jets_of_map(maps.index_select(0, batch.design_of_row), batch.e, second);
  }
  const auto jets = n.narrow(1, 0, rows) + linear;
  const auto r = jets[0] - at_rest[0].index_select(0, batch.design_of_row);
  result.energy = 0.5 * stiffness * (r * r).sum(1);
  result.stress = stiffness.unsqueeze(1) * (r.unsqueeze(0) * jets.slice(0, 1, 4)).sum(2).t();
  if (second) {
    const auto along = (jets.slice(0, 1, 4) * v.t().unsqueeze(2)).sum(0);
    result.stiffness = stiffness * ((along * along).sum(1) + (r * jets[4]).sum(1));
  }
  return result;
}

}  // namespace supple::training
