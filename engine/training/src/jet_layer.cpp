#include "jet_layer.h"

#include <torch/autograd.h>
#include <torch/types.h>

#include "jet_kernel.h"
#include "matrix_product.h"

namespace supple::training {
namespace {

using torch::Tensor;
using torch::autograd::AutogradContext;
using torch::autograd::Function;
using torch::autograd::tensor_list;

/// Channels and rows together.
Tensor flat(const Tensor& x) { return x.reshape({-1, x.size(2)}); }

JetSizes sizes_of(const Tensor& z) {
  return {static_cast<int>(z.size(0)), static_cast<int>(z.size(1)), static_cast<int>(z.size(2))};
}

/// The derivatives by x and by the weights, of those by z = x weights^T.
tensor_list product_backward(const Tensor& by_z, const Tensor& x, const Tensor& weights, bool by_x_wanted) {
  const auto flat_by_z = flat(by_z);
  Tensor by_x;
  if (by_x_wanted) by_x = product(flat_by_z, false, weights, false).reshape(x.sizes());
  return {by_x, product(flat_by_z, true, flat(x), false)};
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

  static tensor_list backward(AutogradContext* context, tensor_list by_y) {
    const auto saved = context->get_saved_variables();
    const auto& [x, weights, bias, directions, z] = std::tie(saved[0], saved[1], saved[2], saved[3], saved[4]);
    const auto g = by_y[0].contiguous();
    auto by_z = torch::empty_like(z);
    auto by_bias = torch::empty_like(bias);
    jet_backward(static_cast<neural::Activation>(context->saved_data["activation"].toInt()), sizes_of(z),
                 directions.data_ptr<float>(), bias.data_ptr<float>(), z.data_ptr<float>(), g.data_ptr<float>(),
                 by_z.data_ptr<float>(), by_bias.data_ptr<float>());
    const auto by = product_backward(by_z, x, weights, context->saved_data["by_x"].toBool());
    return {by[0], by[1], by_bias, Tensor(), Tensor()};
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

  static tensor_list backward(AutogradContext* context, tensor_list by_y) {
    const auto saved = context->get_saved_variables();
    const auto& directions = saved[0];
    const auto& z = saved[1];
    const auto g = by_y[0].contiguous();
    auto by_z = torch::empty_like(z);
    const auto no_bias = torch::zeros({z.size(2)}, z.options());
    auto ignored = torch::empty_like(no_bias);
    jet_backward(static_cast<neural::Activation>(context->saved_data["activation"].toInt()), sizes_of(z),
                 directions.data_ptr<float>(), no_bias.data_ptr<float>(), z.data_ptr<float>(), g.data_ptr<float>(),
                 by_z.data_ptr<float>(), ignored.data_ptr<float>());
    return {by_z, Tensor(), Tensor()};
  }
};

struct LinearLayer : Function<LinearLayer> {
  static Tensor forward(AutogradContext* context, const Tensor& x, const Tensor& weights) {
    context->save_for_backward({x, weights});
    context->saved_data["by_x"] = x.requires_grad();
    return product(flat(x), false, weights, true).reshape({x.size(0), x.size(1), weights.size(0)});
  }

  static tensor_list backward(AutogradContext* context, tensor_list by_y) {
    const auto saved = context->get_saved_variables();
    return product_backward(by_y[0], saved[0], saved[1], context->saved_data["by_x"].toBool());
  }
};

}  // namespace

Tensor jet_layer(neural::Activation activation, const Tensor& x, const Tensor& weights, const Tensor& bias,
                 const Tensor& directions) {
  return JetLayer::apply(x, weights, bias, directions, static_cast<std::int64_t>(activation));
}

Tensor jet_activation(neural::Activation activation, const Tensor& z, const Tensor& directions) {
  return JetActivation::apply(z, directions, static_cast<std::int64_t>(activation));
}

Tensor linear_layer(const Tensor& x, const Tensor& weights) { return LinearLayer::apply(x, weights); }

}  // namespace supple::training
