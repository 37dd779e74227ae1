#include "jet_layer.h"

#include <torch/autograd.h>
#include <torch/types.h>

#include <vector>

#include "jet_kernel.h"
#include "matrix_product.h"

namespace supple::training {
namespace {

using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::Function;
using torch::autograd::tensor_list;

/// Merges the dimensions of channels and rows.
Tensor flat(const Tensor& x) { return x.reshape({-1, x.size(2)}); }

JetSizes sizes_of(const Tensor& z) {
  return {static_cast<int>(z.size(0)), static_cast<int>(z.size(1)), static_cast<int>(z.size(2))};
}

/// The gradients with respect to x (undefined unless it is needed) and to the weights, from that of z = x weights^T.
tensor_list product_gradients(const Tensor& grad_z, const Tensor& x, const Tensor& weights, bool needs_grad_x) {
  const auto flat_grad_z = flat(grad_z);
  Tensor grad_x;
  if (needs_grad_x) grad_x = product(flat_grad_z, false, weights, false).reshape(x.sizes());
  return {grad_x, product(flat_grad_z, true, flat(x), false)};
}

struct JetLayer : Function<JetLayer> {
  static Tensor forward(AutogradContext* context, const Tensor& x, const Tensor& weights, const Tensor& bias,
                        const Tensor& directions, std::int64_t activation) {
    const auto z = product(flat(x), false, weights, true).reshape({x.size(0), x.size(1), weights.size(0)});
    auto y = torch::empty_like(z);
    jet_forward(static_cast<neural::Activation>(activation), sizes_of(z), directions.data_ptr<float>(),
                bias.data_ptr<float>(), z.data_ptr<float>(), y.data_ptr<float>());
    context->save_for_backward({x, weights, bias, directions, z});
    context->saved_data["activation"] = activation;
    context->saved_data["by_x"] = x.requires_grad();
    return y;
  }

  static tensor_list backward(AutogradContext* context, tensor_list grad_outputs) {
    const auto saved = context->get_saved_variables();
    const auto& [x, weights, bias, directions, z] = std::tie(saved[0], saved[1], saved[2], saved[3], saved[4]);
    const auto grad_y = grad_outputs[0].contiguous();
    auto grad_z = torch::empty_like(z);
    auto grad_bias = torch::empty_like(bias);
    jet_backward(static_cast<neural::Activation>(context->saved_data["activation"].toInt()), sizes_of(z),
                 directions.data_ptr<float>(), bias.data_ptr<float>(), z.data_ptr<float>(), grad_y.data_ptr<float>(),
                 grad_z.data_ptr<float>(), grad_bias.data_ptr<float>());
    const auto grad = product_gradients(grad_z, x, weights, context->saved_data["by_x"].toBool());
    return {grad[0], grad[1], grad_bias, Tensor(), Tensor()};
  }
};

struct JetActivation : Function<JetActivation> {
  static Tensor forward(AutogradContext* context, const Tensor& jets, const Tensor& directions,
                        std::int64_t activation) {
    const auto z = jets.contiguous();
    auto y = torch::empty_like(z);
    const auto no_bias = torch::zeros({z.size(2)}, z.options());
    jet_forward(static_cast<neural::Activation>(activation), sizes_of(z), directions.data_ptr<float>(),
                no_bias.data_ptr<float>(), z.data_ptr<float>(), y.data_ptr<float>());
    context->save_for_backward({directions, z});
    context->saved_data["activation"] = activation;
    return y;
  }

  static tensor_list backward(AutogradContext* context, tensor_list grad_outputs) {
    const auto saved = context->get_saved_variables();
    const auto& directions = saved[0];
    const auto& z = saved[1];
    const auto grad_y = grad_outputs[0].contiguous();
    auto grad_z = torch::empty_like(z);
    const auto no_bias = torch::zeros({z.size(2)}, z.options());
    auto unused_grad_bias = torch::empty_like(no_bias);
    jet_backward(static_cast<neural::Activation>(context->saved_data["activation"].toInt()), sizes_of(z),
                 directions.data_ptr<float>(), no_bias.data_ptr<float>(), z.data_ptr<float>(), grad_y.data_ptr<float>(),
                 grad_z.data_ptr<float>(), unused_grad_bias.data_ptr<float>());
    return {grad_z, Tensor(), Tensor()};
  }
};

struct LinearLayer : Function<LinearLayer> {
  static Tensor forward(AutogradContext* context, const Tensor& x, const Tensor& weights) {
    context->save_for_backward({x, weights});
    context->saved_data["by_x"] = x.requires_grad();
    return product(flat(x), false, weights, true).reshape({x.size(0), x.size(1), weights.size(0)});
  }

  static tensor_list backward(AutogradContext* context, tensor_list grad_outputs) {
    const auto saved = context->get_saved_variables();
    return product_gradients(grad_outputs[0], saved[0], saved[1], context->saved_data["by_x"].toBool());
  }
};

/// The jets of f(z), computed by LibTorch's operations.
Tensor plain_activation(neural::Activation activation, const Tensor& z, const Tensor& directions) {
  const auto value = z.slice(0, 0, 1);
  std::vector<Tensor> channels{activated(activation, value)};
  if (z.size(0) > 1) {
    const auto slope = activation_slope(activation, value);
    const auto first = z.slice(0, 1, 4);
    channels.push_back(slope * first);
    if (z.size(0) > 4) {
      const auto along = (first * directions.t().unsqueeze(2)).sum(0, true);
      channels.push_back(slope * z.slice(0, 4, 5) + activation_curvature(activation, value) * along * along);
    }
  }
  return torch::cat(channels, 0);
}

}  // namespace

Tensor activated(neural::Activation activation, const Tensor& z) {
  switch (activation) {
    case neural::Activation::swish:
      return z * torch::sigmoid(z);
    case neural::Activation::tanh:
      return torch::tanh(z);
    default:
      return torch::sin(z);
  }
}

Tensor activation_slope(neural::Activation activation, const Tensor& z) {
  switch (activation) {
    case neural::Activation::swish: {
      const auto s = torch::sigmoid(z);
      return s + z * s * (1 - s);
    }
    case neural::Activation::tanh:
      return 1 - torch::tanh(z).square();
    default:
      return torch::cos(z);
  }
}

Tensor activation_curvature(neural::Activation activation, const Tensor& z) {
  switch (activation) {
    case neural::Activation::swish: {
      const auto s = torch::sigmoid(z);
      return s * (1 - s) * (2 + z * (1 - 2 * s));
    }
    case neural::Activation::tanh: {
      const auto t = torch::tanh(z);
      return -2 * t * (1 - t.square());
    }
    default:
      return -torch::sin(z);
  }
}

Tensor jet_layer(neural::Activation activation, const Tensor& x, const Tensor& weights, const Tensor& bias,
                 const Tensor& directions) {
  if (!supported_by_kernels(x)) {
    const auto z = linear_layer(x, weights);
    return plain_activation(activation, torch::cat({z.slice(0, 0, 1) + bias, z.slice(0, 1)}, 0), directions);
  }
  return JetLayer::apply(x, weights, bias, directions, static_cast<std::int64_t>(activation));
}

Tensor jet_activation(neural::Activation activation, const Tensor& z, const Tensor& directions) {
  if (!supported_by_kernels(z)) return plain_activation(activation, z, directions);
  return JetActivation::apply(z, directions, static_cast<std::int64_t>(activation));
}

Tensor linear_layer(const Tensor& x, const Tensor& weights) {
  return supported_by_kernels(x) ? LinearLayer::apply(x, weights) : torch::matmul(x, weights.t());
}

}  // namespace supple::training
