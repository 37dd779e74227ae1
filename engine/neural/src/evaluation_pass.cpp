#include "evaluation_pass.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supple::neural {
namespace {

/// Columns that go through the layers together.
constexpr int columns_at_once = 48;

/// Products of jets: (a b)_channel of channel values at a, b.
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

/// The third derivative ijk, i <= j <= k, of gradients' jets: channel jk of component i.
struct Third {
  int component;
  int channel;
};
constexpr Third thirds[10] = {{0, 4}, {0, 5}, {0, 6}, {0, 7}, {0, 8}, {0, 9}, {1, 7}, {1, 8}, {1, 9}, {2, 9}};

}  // namespace

template <class Real>
EvaluationPass<Real>::EvaluationPass(const PackedNetwork<Real>& network, const PackedDesign<Real>& design, Order asked,
                                     long n, PassSpace<Real>& space, Evaluation& answer)
    : network_(network),
      design_(design),
      shape_(network.network.shape),
      space_(space),
      answer_(answer),
      asked_(asked),
      order_(asked == Order::energy ? 0 : static_cast<int>(asked) - 1),
      width_(padded_rows(shape_.width)),
      parameters_(design.with_derivatives ? shape_.parameters : 0) {
  const auto from = [&](Order order) { return asked >= order ? n : 0; };
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
  // The strains as jets: a value and the unit vectors.
  e_ = block(space_.strains, row_multiple);
  std::fill_n(e_.data, static_cast<std::size_t>(columns()) * static_cast<std::size_t>(e_.stride), Real(0));
  for (int j = 0; j < jets_; ++j) {
    for (int i = 0; i < 3; ++i) {
      e_.channel(0, j)[i] = static_cast<Real>(strains(i, j));
      if (order_ > 0) e_.channel(1 + i, j)[i] = Real(1);
    }
  }
  forward();
  space_.energy.setZero(channels(), jets_);
  if (shape_.form == EnergyForm::softplus)
    close_softplus();
  else
    close_sum_of_squares();
  for (int j = 0; j < jets_; ++j) answer_.energy_density[begin_ + j] = space_.energy(0, j);
  if (asked_ != Order::energy) backward();
}

template <class Real>
void EvaluationPass<Real>::forward() {
  a_ = block(space_.activations, width_);
  // `slopes` keep the jets of f' of each layer.
  auto z = block(space_.slopes[0], width_);
  multiply(design_.input, e_.factor(), columns(), z.data, z.stride);
  activate_forward(shape_.activation, order_, network_.first_bias.data(), z, a_);
  for (std::size_t l = 0; l < network_.hidden.size(); ++l) {
    const auto& layer = network_.hidden[l];
    z = block(space_.slopes[l + 1], width_);
    multiply(layer.forward, a_.factor(), columns(), z.data, z.stride);
    const Real* bias = l == network_.meeting() ? design_.meeting.data() : layer.bias.data();
    activate_forward(shape_.activation, order_, bias, z, a_);
  }
  const int outputs = padded_rows(shape_.outputs());
  last_ = block(space_.outputs, outputs);
  multiply(network_.last.forward, a_.factor(), columns(), last_.data, last_.stride);
  for (int j = 0; j < jets_; ++j)
    for (int k = 0; k < outputs; ++k) last_.channel(0, j)[k] += network_.last.bias[static_cast<std::size_t>(k)];
}

template <class Real>
void EvaluationPass<Real>::close_sum_of_squares() {
  const auto& exact = design_.exact;
  for (int j = 0; j < jets_; ++j) {
    for (int k = 0; k < shape_.outputs(); ++k) {
      Eigen::Array<double, most_channels, 1> r = Eigen::Array<double, most_channels, 1>::Zero();
      for (int c = 0; c < channels(); ++c) r[c] = last_.channel(c, j)[k];
      r[0] -= exact.rest[k];
      if (k < exact.linear.rows()) {
        for (int i = 0; i < 3; ++i) {
          r[0] += exact.linear(k, i) * e_.channel(0, j)[i];
          if (order_ > 0) r[1 + i] += exact.linear(k, i);
        }
      }
      for (int c = 0; c < channels(); ++c) {
        space_.energy(c, j) += 0.5 * exact.stiffness * product_channel(r, r, c);
        last_.channel(c, j)[k] = static_cast<Real>(exact.stiffness * r[c]);
      }
    }
  }
}

template <class Real>
void EvaluationPass<Real>::close_softplus() {
  auto& energy = space_.energy;
  for (int j = 0; j < jets_; ++j) {
    Eigen::Array<double, most_channels, 1> z = Eigen::Array<double, most_channels, 1>::Zero();
    for (int c = 0; c < channels(); ++c) z[c] = last_.channel(c, j)[0];
    // log(1 + exp z), without overflow.
    energy(0, j) = std::max(z[0], 0.0) + std::log1p(std::exp(-std::abs(z[0])));
    const double s = z[0] >= 0 ? 1 / (1 + std::exp(-z[0])) : 1 - 1 / (1 + std::exp(z[0]));
    const double s1 = s * (1 - s);
    const double s2 = s1 * (1 - 2 * s);
    last_.channel(0, j)[0] = static_cast<Real>(s);
    for (int i = 0; order_ > 0 && i < 3; ++i) {
      energy(1 + i, j) = s * z[1 + i];
      last_.channel(1 + i, j)[0] = static_cast<Real>(s1 * z[1 + i]);
    }
    for (int i = 0; order_ > 1 && i < 3; ++i) {
      for (int l = i; l < 3; ++l) {
        const int c = second_channel[i][l];
        energy(c, j) = s * z[c] + s1 * z[1 + i] * z[1 + l];
        last_.channel(c, j)[0] = static_cast<Real>(s1 * z[c] + s2 * z[1 + i] * z[1 + l]);
      }
    }
  }
}

template <class Real>
void EvaluationPass<Real>::backward() {
  if (parameters_ > 0) begin_parameters();
  // `a_` holds derivatives by the current layer's output.
  multiply(network_.last.backward, last_.factor(), columns(), a_.data, a_.stride);
  auto other = block(space_.products, width_);
  for (std::size_t l = network_.hidden.size(); l-- > 0;) {
    activate_backward(order_, block(space_.slopes[l + 1], width_), a_);
    if (l == network_.meeting() && parameters_ > 0) {
      const auto small = block(space_.small, padded_rows(parameters_));
      multiply(design_.meeting_back, a_.factor(), columns(), small.data, small.stride);
      by_parameters([&](int j, int k, int c) { return static_cast<double>(small.channel(c, j)[k]); });
    }
    multiply(network_.hidden[l].backward, a_.factor(), columns(), other.data, other.stride);
    std::swap(a_, other);
  }
  activate_backward(order_, block(space_.slopes[0], width_), a_);
  const auto maps_back = block(space_.small, padded_rows(3 * (1 + parameters_)));
  multiply(design_.input_back, a_.factor(), columns(), maps_back.data, maps_back.stride);
  finish_strains(maps_back);
  finish_parameters(maps_back);
}

template <class Real>
template <class Add>
void EvaluationPass<Real>::by_parameters(Add&& add) {
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
void EvaluationPass<Real>::begin_parameters() {
  const auto& exact = design_.exact;
  for (auto* matrix : {&answer_.energy_by_parameters, &answer_.stress_by_parameters, &answer_.tangent_by_parameters})
    if (matrix->cols() > 0) matrix->middleCols(begin_, jets_).setZero();
  by_parameters([&](int j, int k, int c) {
    double sum = space_.energy(c, j) * exact.stiffness_by[k] / exact.stiffness;
    if (shape_.form == EnergyForm::softplus) return sum;
    for (int output = 0; output < shape_.outputs(); ++output)
      sum -= last_.channel(c, j)[output] * exact.rest_by(output, k);
    return sum;
  });
}

template <class Real>
double EvaluationPass<Real>::mapped(const JetBlock<Real>& maps_back, int map, int i, int c, int j) const {
  double sum = maps_back.channel(c, j)[3 * map + i];
  if (shape_.form == EnergyForm::softplus) return sum;
  const auto& linear = map == 0 ? design_.exact.linear : design_.exact.linear_by[static_cast<std::size_t>(map - 1)];
  for (int k = 0; k < linear.rows(); ++k) sum += last_.channel(c, j)[k] * linear(k, i);
  return sum;
}

template <class Real>
void EvaluationPass<Real>::finish_strains(const JetBlock<Real>& maps_back) {
  for (int j = 0; j < jets_; ++j) {
    const long column = begin_ + j;
    for (int i = 0; i < 3; ++i) answer_.stress(i, column) = mapped(maps_back, 0, i, 0, j);
    if (asked_ >= Order::tangent)
      for (int i = 0; i < 3; ++i)
        for (int k = i; k < 3; ++k)
          answer_.tangent(second_channel[i][k] - 4, column) = mapped(maps_back, 0, i, 1 + k, j);
    if (asked_ >= Order::third)
      for (int q = 0; q < 10; ++q)
        answer_.third(q, column) = mapped(maps_back, 0, thirds[q].component, thirds[q].channel, j);
  }
}

template <class Real>
void EvaluationPass<Real>::finish_parameters(const JetBlock<Real>& maps_back) {
  // The derivative of the map times e: a product of jets.
  by_parameters([&](int j, int k, int c) {
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const auto t = [&](int channel) { return mapped(maps_back, 1 + k, i, channel, j); };
      const auto strain = [&](int channel) { return static_cast<double>(e_.channel(channel, j)[i]); };
      sum += product_channel(t, strain, c);
    }
    return sum;
  });
}

template class EvaluationPass<double>;
template class EvaluationPass<float>;

}  // namespace supple::neural
