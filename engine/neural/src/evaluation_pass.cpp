#include "evaluation_pass.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supple::neural {
namespace {

/// Number of columns (strains times channels) that go through the layers together.
constexpr int columns_at_once = 48;

/// A channel of the product of two jets, whose channels are a(0), a(1), ... and b(0), b(1), ...
template <class A, class B>
double product_channel(const A& a, const B& b, int channel) {
  if (channel == 0) return a(0) * b(0);
  if (channel < 4) return a(0) * b(channel) + a(channel) * b(0);
  for (int i = 0; i < 3; ++i)
    for (int j = i; j < 3; ++j)
      if (second_channel[i][j] == channel)
        return a(0) * b(channel) + a(1 + i) * b(1 + j) + a(1 + j) * b(1 + i) + a(channel) * b(0);
  return 0;
}

/// The place of a third derivative ijk, i <= j <= k, in the jets of a gradient: channel jk of component i.
struct Third {
  int component;
  int channel;
};
constexpr Third thirds[10] = {{0, 4}, {0, 5}, {0, 6}, {0, 7}, {0, 8}, {0, 9}, {1, 7}, {1, 8}, {1, 9}, {2, 9}};

}  // namespace

template <class Real>
EvaluationPass<Real>::EvaluationPass(const PackedNetwork<Real>& network, const PackedDesign<Real>& design,
                                     Order requested, long n, PassSpace<Real>& space, Evaluation& answer)
    : network_(network),
      design_(design),
      shape_(network.network.shape),
      space_(space),
      answer_(answer),
      requested_(requested),
      order_(requested == Order::energy ? 0 : static_cast<int>(requested) - 1),
      width_(padded_rows(shape_.width)),
      parameters_(design.with_derivatives ? shape_.parameters : 0) {
  const auto from = [&](Order order) { return requested >= order ? n : 0; };
  answer.energy_density.resize(n);
  answer.stress.resize(3, from(Order::stress));
  answer.tangent.resize(6, from(Order::tangent));
  answer.third.resize(10, from(Order::third));
  answer.energy_by_parameters.resize(parameters_, from(Order::stress));
  answer.stress_by_parameters.resize(3 * parameters_, from(Order::tangent));
  answer.tangent_by_parameters.resize(6 * parameters_, from(Order::third));
  space.slopes.resize(network.hidden.size() + 1);
}

template <class Real>
int EvaluationPass<Real>::strains_at_once() const {
  return std::max(1, columns_at_once / channels());
}

template <class Real>
JetBlock<Real> EvaluationPass<Real>::block(std::vector<Real>& numbers, int rows) const {
  const auto size = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns());
  if (numbers.size() < size) numbers.resize(size);
  return {numbers.data(), jets_, rows, rows};
}

template <class Real>
void EvaluationPass<Real>::run(const Eigen::Ref<const Eigen::Matrix3Xd>& strains, long begin) {
  begin_ = begin;
  jets_ = static_cast<int>(strains.cols());
  // The jet of a strain: the value, and the identity as its derivative.
  strains_ = block(space_.strains, row_multiple);
  std::fill_n(strains_.data, static_cast<std::size_t>(columns()) * static_cast<std::size_t>(strains_.stride), Real(0));
  for (int j = 0; j < jets_; ++j) {
    for (int i = 0; i < 3; ++i) {
      strains_.channel(0, j)[i] = static_cast<Real>(strains(i, j));
      if (order_ > 0) strains_.channel(1 + i, j)[i] = Real(1);
    }
  }
  forward();
  space_.energy.setZero(channels(), jets_);
  if (shape_.form == EnergyForm::softplus)
    apply_softplus();
  else
    apply_sum_of_squares();
  for (int j = 0; j < jets_; ++j) answer_.energy_density[begin_ + j] = space_.energy(0, j);
  if (requested_ != Order::energy) backward();
}

template <class Real>
void EvaluationPass<Real>::forward() {
  activations_ = block(space_.activations, width_);
  // After the pass, `slopes` has the jets of f' of each layer.
  auto z = block(space_.slopes[0], width_);
  multiply(design_.input, strains_.factor(), columns(), z.data, z.stride);
  activate_forward(shape_.activation, order_, network_.first_bias.data(), z, activations_);
  for (std::size_t l = 0; l < network_.hidden.size(); ++l) {
    const auto& layer = network_.hidden[l];
    z = block(space_.slopes[l + 1], width_);
    multiply(layer.forward, activations_.factor(), columns(), z.data, z.stride);
    const Real* bias = l == network_.first_trunk_layer() ? design_.trunk_bias.data() : layer.bias.data();
    activate_forward(shape_.activation, order_, bias, z, activations_);
  }
  const int outputs = padded_rows(shape_.outputs());
  outputs_ = block(space_.outputs, outputs);
  multiply(network_.last.forward, activations_.factor(), columns(), outputs_.data, outputs_.stride);
  for (int j = 0; j < jets_; ++j)
    for (int k = 0; k < outputs; ++k) outputs_.channel(0, j)[k] += network_.last.bias[static_cast<std::size_t>(k)];
}

template <class Real>
void EvaluationPass<Real>::apply_sum_of_squares() {
  const auto& exact = design_.exact;
  for (int j = 0; j < jets_; ++j) {
    for (int k = 0; k < shape_.outputs(); ++k) {
      Eigen::Array<double, max_channels, 1> r = Eigen::Array<double, max_channels, 1>::Zero();
      for (int c = 0; c < channels(); ++c) r[c] = outputs_.channel(c, j)[k];
      r[0] -= exact.rest[k];
      if (k < exact.linear.rows()) {
        for (int i = 0; i < 3; ++i) {
          r[0] += exact.linear(k, i) * strains_.channel(0, j)[i];
          if (order_ > 0) r[1 + i] += exact.linear(k, i);
        }
      }
      for (int c = 0; c < channels(); ++c) {
        space_.energy(c, j) += 0.5 * exact.stiffness * product_channel(r, r, c);
        outputs_.channel(c, j)[k] = static_cast<Real>(exact.stiffness * r[c]);
      }
    }
  }
}

template <class Real>
void EvaluationPass<Real>::apply_softplus() {
  auto& energy = space_.energy;
  for (int j = 0; j < jets_; ++j) {
    Eigen::Array<double, max_channels, 1> z = Eigen::Array<double, max_channels, 1>::Zero();
    for (int c = 0; c < channels(); ++c) z[c] = outputs_.channel(c, j)[0];
    // log(1 + exp z), without overflow.
    energy(0, j) = std::max(z[0], 0.0) + std::log1p(std::exp(-std::abs(z[0])));
    const double s = z[0] >= 0 ? 1 / (1 + std::exp(-z[0])) : 1 - 1 / (1 + std::exp(z[0]));
    const double s1 = s * (1 - s);
    const double s2 = s1 * (1 - 2 * s);
    outputs_.channel(0, j)[0] = static_cast<Real>(s);
    for (int i = 0; order_ > 0 && i < 3; ++i) {
      energy(1 + i, j) = s * z[1 + i];
      outputs_.channel(1 + i, j)[0] = static_cast<Real>(s1 * z[1 + i]);
    }
    for (int i = 0; order_ > 1 && i < 3; ++i) {
      for (int l = i; l < 3; ++l) {
        const int c = second_channel[i][l];
        energy(c, j) = s * z[c] + s1 * z[1 + i] * z[1 + l];
        outputs_.channel(c, j)[0] = static_cast<Real>(s1 * z[c] + s2 * z[1 + i] * z[1 + l]);
      }
    }
  }
}

template <class Real>
void EvaluationPass<Real>::backward() {
  if (parameters_ > 0) init_parameter_derivatives();
  // In each iteration, `activations_` has the derivatives with respect to the current layer's output.
  multiply(network_.last.backward, outputs_.factor(), columns(), activations_.data, activations_.stride);
  auto other = block(space_.products, width_);
  for (std::size_t l = network_.hidden.size(); l-- > 0;) {
    activate_backward(order_, block(space_.slopes[l + 1], width_), activations_);
    if (l == network_.first_trunk_layer() && parameters_ > 0) {
      const auto design_products = block(space_.design_products, padded_rows(parameters_));
      multiply(design_.trunk_bias_back, activations_.factor(), columns(), design_products.data, design_products.stride);
      add_parameter_derivatives(
          [&](int j, int k, int c) { return static_cast<double>(design_products.channel(c, j)[k]); });
    }
    multiply(network_.hidden[l].backward, activations_.factor(), columns(), other.data, other.stride);
    std::swap(activations_, other);
  }
  activate_backward(order_, block(space_.slopes[0], width_), activations_);
  const auto input_products = block(space_.design_products, padded_rows(3 * (1 + parameters_)));
  multiply(design_.input_back, activations_.factor(), columns(), input_products.data, input_products.stride);
  write_strain_derivatives(input_products);
  add_input_derivatives(input_products);
}

template <class Real>
template <class Add>
void EvaluationPass<Real>::add_parameter_derivatives(Add&& add) {
  for (int j = 0; j < jets_; ++j) {
    for (int k = 0; k < parameters_; ++k) {
      for (int c = 0; c < channels(); ++c) {
        const double value = add(j, k, c);
        const long column = begin_ + j;
        if (c == 0)
          answer_.energy_by_parameters(k, column) += value;
        else if (c < 4)
          answer_.stress_by_parameters((c - 1) * parameters_ + k, column) += value;
        else
          answer_.tangent_by_parameters((c - 4) * parameters_ + k, column) += value;
      }
    }
  }
}

template <class Real>
void EvaluationPass<Real>::init_parameter_derivatives() {
  const auto& exact = design_.exact;
  for (auto* matrix : {&answer_.energy_by_parameters, &answer_.stress_by_parameters, &answer_.tangent_by_parameters})
    if (matrix->cols() > 0) matrix->middleCols(begin_, jets_).setZero();
  add_parameter_derivatives([&](int j, int k, int c) {
    double sum = space_.energy(c, j) * exact.stiffness_by[k] / exact.stiffness;
    if (shape_.form == EnergyForm::softplus) return sum;
    for (int output = 0; output < shape_.outputs(); ++output)
      sum -= outputs_.channel(c, j)[output] * exact.rest_by(output, k);
    return sum;
  });
}

template <class Real>
double EvaluationPass<Real>::map_derivative(const JetBlock<Real>& input_products, int map, int i, int c, int j) const {
  double sum = input_products.channel(c, j)[3 * map + i];
  if (shape_.form == EnergyForm::softplus) return sum;
  const auto& linear = map == 0 ? design_.exact.linear : design_.exact.linear_by[static_cast<std::size_t>(map - 1)];
  for (int k = 0; k < linear.rows(); ++k) sum += outputs_.channel(c, j)[k] * linear(k, i);
  return sum;
}

template <class Real>
void EvaluationPass<Real>::write_strain_derivatives(const JetBlock<Real>& input_products) {
  for (int j = 0; j < jets_; ++j) {
    const long column = begin_ + j;
    for (int i = 0; i < 3; ++i) answer_.stress(i, column) = map_derivative(input_products, 0, i, 0, j);
    if (requested_ >= Order::tangent)
      for (int i = 0; i < 3; ++i)
        for (int k = i; k < 3; ++k)
          answer_.tangent(second_channel[i][k] - 4, column) = map_derivative(input_products, 0, i, 1 + k, j);
    if (requested_ >= Order::third)
      for (int q = 0; q < 10; ++q)
        answer_.third(q, column) = map_derivative(input_products, 0, thirds[q].component, thirds[q].channel, j);
  }
}

template <class Real>
void EvaluationPass<Real>::add_input_derivatives(const JetBlock<Real>& input_products) {
  // The derivative of the map times the strain is a product of jets.
  add_parameter_derivatives([&](int j, int k, int c) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const auto t = [&](int channel) { return map_derivative(input_products, 1 + k, i, channel, j); };
      const auto strain = [&](int channel) { return static_cast<double>(strains_.channel(channel, j)[i]); };
      sum += product_channel(t, strain, c);
    }
    return sum;
  });
}

template class EvaluationPass<double>;
template class EvaluationPass<float>;

}  // namespace supple::neural
