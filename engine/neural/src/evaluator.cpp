#include "supple/neural/evaluator.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "activation_kernel.h"
#include "design_content.h"
#include "supple/base/error.h"
#include "supple/neural/packed_matrix.h"

namespace supple::neural {
namespace {

/// Columns that go through the layers together: enough to use what is loaded of the weights, few enough that the jets
/// of all layers stay near.
constexpr int columns_at_once = 48;

/// Adds zeros below, up to a stride.
template <class Real>
std::vector<Real> padded(const Eigen::VectorXd& values) {
  std::vector<Real> result(static_cast<std::size_t>(padded_rows(static_cast<int>(values.size()))), Real(0));
  for (long i = 0; i < values.size(); ++i) result[static_cast<std::size_t>(i)] = static_cast<Real>(values[i]);
  return result;
}

/// A layer's weights in both directions. The first layers need the way back only, which depends on the design.
template <class Real>
struct PackedLayer {
  PackedMatrix<Real> forward;
  PackedMatrix<Real> backward;
  std::vector<Real> bias;

  PackedLayer(const Eigen::Ref<const Eigen::MatrixXd>& weights, const Eigen::VectorXd& bias_values)
      : forward(weights), backward(weights.transpose()), bias(padded<Real>(bias_values)) {}
};

/// Of the layers between the first of the strain branch and the last of the trunk: the hidden ones, in order.
template <class Real>
std::vector<PackedLayer<Real>> hidden_layers(const Network& network) {
  std::vector<PackedLayer<Real>> layers;
  for (std::size_t i = 1; i < network.strain.size(); ++i)
    layers.emplace_back(network.strain[i].weights, network.strain[i].bias);
  // The bias of the layer where the branches meet is a part of the design.
  layers.emplace_back(network.trunk[0].weights.leftCols(network.shape.width),
                      Eigen::VectorXd::Zero(network.shape.width));
  for (std::size_t i = 1; i + 1 < network.trunk.size(); ++i)
    layers.emplace_back(network.trunk[i].weights, network.trunk[i].bias);
  return layers;
}

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
struct BasicEvaluator<Real>::Content {
  explicit Content(const Network& of)
      : network(of),
        strain_at_rest(strain_branch_at_rest(of)),
        first_bias(padded<Real>(of.strain[0].bias)),
        hidden(hidden_layers<Real>(of)),
        last(of.trunk.back().weights, of.trunk.back().bias) {}

  Network network;
  Eigen::VectorXd strain_at_rest;
  std::vector<Real> first_bias;
  std::vector<PackedLayer<Real>> hidden;
  PackedLayer<Real> last;
  /// Index in `hidden` of the layer where the branches meet.
  std::size_t meeting() const { return network.strain.size() - 1; }
};

template <class Real>
struct BasicEvaluator<Real>::Design::Content {
  DesignContent exact;
  bool with_derivatives = false;
  PackedMatrix<Real> input;         ///< M
  PackedMatrix<Real> input_back;    ///< rows: M^T, then for each parameter the three rows of its derivative
  PackedMatrix<Real> meeting_back;  ///< rows: derivative of the meeting layer's addend by each parameter
  std::vector<Real> meeting;
};

template <class Real>
struct BasicEvaluator<Real>::Workspace::Content {
  std::vector<Real> strains;
  std::vector<std::vector<Real>> slopes;  ///< of each activation, jets of f'
  std::vector<Real> activations;
  std::vector<Real> products;
  std::vector<Real> outputs;
  std::vector<Real> small;
};

template <class Real>
BasicEvaluator<Real>::BasicEvaluator(const Network& network) {
  validate(network);
  content_ = std::make_unique<const Content>(network);
}
template <class Real>
BasicEvaluator<Real>::~BasicEvaluator() = default;
template <class Real>
BasicEvaluator<Real>::BasicEvaluator(BasicEvaluator&&) noexcept = default;
template <class Real>
BasicEvaluator<Real>& BasicEvaluator<Real>::operator=(BasicEvaluator&&) noexcept = default;
template <class Real>
BasicEvaluator<Real>::Design::Design() : content_(std::make_unique<Content>()) {}
template <class Real>
BasicEvaluator<Real>::Design::~Design() = default;
template <class Real>
BasicEvaluator<Real>::Design::Design(Design&&) noexcept = default;
template <class Real>
typename BasicEvaluator<Real>::Design& BasicEvaluator<Real>::Design::operator=(Design&&) noexcept = default;
template <class Real>
BasicEvaluator<Real>::Workspace::Workspace() : content_(std::make_unique<Content>()) {}
template <class Real>
BasicEvaluator<Real>::Workspace::~Workspace() = default;
template <class Real>
BasicEvaluator<Real>::Workspace::Workspace(Workspace&&) noexcept = default;
template <class Real>
typename BasicEvaluator<Real>::Workspace& BasicEvaluator<Real>::Workspace::operator=(Workspace&&) noexcept = default;

template <class Real>
const NetworkShape& BasicEvaluator<Real>::shape() const {
  return content_->network.shape;
}

template <class Real>
double BasicEvaluator<Real>::Design::rest_stiffness() const {
  return content_->exact.stiffness;
}

template <class Real>
typename BasicEvaluator<Real>::Design BasicEvaluator<Real>::design(std::span<const double> parameters,
                                                                   bool with_parameter_derivatives) const {
  const auto& network = content_->network;
  const int n = network.shape.parameters;
  if (static_cast<int>(parameters.size()) != n)
    throw Error("model.parameter_count",
                "The model has " + std::to_string(n) + " parameters, got " + std::to_string(parameters.size()) + ".",
                {{"parameters", std::to_string(n) + " numbers"}});
  Design design;
  auto& content = *design.content_;
  content.with_derivatives = with_parameter_derivatives;
  content.exact = evaluate_design(network, content_->strain_at_rest, parameters, with_parameter_derivatives);
  const auto& exact = content.exact;
  content.input.assign(exact.input);
  content.meeting = padded<Real>(exact.meeting);
  const int maps = with_parameter_derivatives ? 1 + n : 1;
  Eigen::MatrixXd back(3 * maps, network.shape.width);
  back.topRows<3>() = exact.input.transpose();
  for (int k = 1; k < maps; ++k)
    back.middleRows<3>(3 * k) = exact.input_by[static_cast<std::size_t>(k - 1)].transpose();
  content.input_back.assign(back);
  if (with_parameter_derivatives) content.meeting_back.assign(exact.meeting_by.transpose());
  return design;
}

namespace {

/// One block of strains on its way forward and back.
template <class Real>
struct Block {
  int order = 0;  ///< of the jets
  int jets = 0;
  int channels() const { return channels_of_order[order]; }
  int columns() const { return channels() * jets; }
  JetBlock<Real> jet_block(std::vector<Real>& numbers, int rows) const {
    const auto size = static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns());
    if (numbers.size() < size) numbers.resize(size);
    return {numbers.data(), jets, rows, rows};
  }
};

/// The strains as jets: a value and the unit vectors.
template <class Real>
void fill_strains(const Eigen::Ref<const Eigen::Matrix3Xd>& strains, const JetBlock<Real>& e, int order) {
  std::fill_n(e.data, static_cast<std::size_t>(channels_of_order[order]) * e.jets * e.stride, Real(0));
  for (int j = 0; j < e.jets; ++j) {
    for (int i = 0; i < 3; ++i) {
      e.channel(0, j)[i] = static_cast<Real>(strains(i, j));
      if (order > 0) e.channel(1 + i, j)[i] = Real(1);
    }
  }
}

/// From the outputs' jets N: the energy's jets, channels x jets, and in place of N those of its derivatives by N.
template <class Real>
void close_sum_of_squares(const DesignContent& design, const JetBlock<Real>& e, const JetBlock<Real>& n, int order,
                          int outputs, Eigen::ArrayXXd& energy) {
  const int channels = channels_of_order[order];
  energy.setZero(channels, n.jets);
  for (int j = 0; j < n.jets; ++j) {
    for (int k = 0; k < outputs; ++k) {
      Eigen::Array<double, most_channels, 1> r = Eigen::Array<double, most_channels, 1>::Zero();
      for (int c = 0; c < channels; ++c) r[c] = n.channel(c, j)[k];
      r[0] -= design.rest[k];
      if (k < 3) {
        for (int i = 0; i < 3; ++i) {
          r[0] += design.skip(k, i) * e.channel(0, j)[i];
          if (order > 0) r[1 + i] += design.skip(k, i);
        }
      }
      for (int c = 0; c < channels; ++c) {
        energy(c, j) += 0.5 * design.stiffness * product_channel(r, r, c);
        n.channel(c, j)[k] = static_cast<Real>(design.stiffness * r[c]);
      }
    }
  }
}

template <class Real>
void close_softplus(const JetBlock<Real>& n, int order, Eigen::ArrayXXd& energy) {
  const int channels = channels_of_order[order];
  energy.setZero(channels, n.jets);
  for (int j = 0; j < n.jets; ++j) {
    Eigen::Array<double, most_channels, 1> z = Eigen::Array<double, most_channels, 1>::Zero();
    for (int c = 0; c < channels; ++c) z[c] = n.channel(c, j)[0];
    // log(1 + exp z), without overflow.
    energy(0, j) = std::max(z[0], 0.0) + std::log1p(std::exp(-std::abs(z[0])));
    const double s = z[0] >= 0 ? 1 / (1 + std::exp(-z[0])) : 1 - 1 / (1 + std::exp(z[0]));
    const double s1 = s * (1 - s);
    const double s2 = s1 * (1 - 2 * s);
    n.channel(0, j)[0] = static_cast<Real>(s);
    for (int i = 0; order > 0 && i < 3; ++i) {
      energy(1 + i, j) = s * z[1 + i];
      n.channel(1 + i, j)[0] = static_cast<Real>(s1 * z[1 + i]);
    }
    for (int i = 0; order > 1 && i < 3; ++i) {
      for (int l = i; l < 3; ++l) {
        const int c = second_channel[i][l];
        energy(c, j) = s * z[c] + s1 * z[1 + i] * z[1 + l];
        n.channel(c, j)[0] = static_cast<Real>(s1 * z[c] + s2 * z[1 + i] * z[1 + l]);
      }
    }
  }
}

}  // namespace

template <class Real>
void BasicEvaluator<Real>::evaluate(const Design& design, const Eigen::Ref<const Eigen::Matrix3Xd>& strains,
                                    Order asked, Workspace& workspace, Evaluation& evaluation) const {
  const auto& content = *content_;
  const auto& of_design = *design.content_;
  const auto& exact = of_design.exact;
  const auto& shape = content.network.shape;
  auto& space = *workspace.content_;
  const auto n = strains.cols();
  const int parameters = of_design.with_derivatives ? shape.parameters : 0;
  const bool back = asked != Order::energy;
  const int order = back ? static_cast<int>(asked) - 1 : 0;
  const int width = padded_rows(shape.width);
  const int outputs = padded_rows(shape.outputs());
  const int maps = 1 + parameters;

  evaluation.energy_density.resize(n);
  evaluation.stress.resize(3, back ? n : 0);
  evaluation.tangent.resize(6, asked >= Order::tangent ? n : 0);
  evaluation.third.resize(10, asked >= Order::third ? n : 0);
  evaluation.energy_by_parameters.resize(parameters, back ? n : 0);
  evaluation.stress_by_parameters.resize(3 * parameters, asked >= Order::tangent ? n : 0);
  evaluation.tangent_by_parameters.resize(6 * parameters, asked >= Order::third ? n : 0);
  space.slopes.resize(content.hidden.size() + 1);

  Eigen::ArrayXXd energy;
  const int at_once = std::max(1, columns_at_once / channels_of_order[order]);
  for (long begin = 0; begin < n; begin += at_once) {
    Block<Real> block{order, static_cast<int>(std::min<long>(at_once, n - begin))};
    const int columns = block.columns();
    const auto e = block.jet_block(space.strains, row_multiple);
    fill_strains<Real>(strains.middleCols(begin, block.jets), e, order);

    // Forward. `slopes` keep the jets of f' of each layer.
    auto a = block.jet_block(space.activations, width);
    auto z = block.jet_block(space.slopes[0], width);
    multiply(of_design.input, e.factor(), columns, z.data, z.stride);
    activate_forward(shape.activation, order, content.first_bias.data(), z, a);
    for (std::size_t l = 0; l < content.hidden.size(); ++l) {
      z = block.jet_block(space.slopes[l + 1], width);
      multiply(content.hidden[l].forward, a.factor(), columns, z.data, z.stride);
      const Real* bias = l == content.meeting() ? of_design.meeting.data() : content.hidden[l].bias.data();
      activate_forward(shape.activation, order, bias, z, a);
    }
    const auto last = block.jet_block(space.outputs, outputs);
    multiply(content.last.forward, a.factor(), columns, last.data, last.stride);
    for (int j = 0; j < block.jets; ++j)
      for (int k = 0; k < outputs; ++k) last.channel(0, j)[k] += content.last.bias[static_cast<std::size_t>(k)];

    if (shape.form == EnergyForm::softplus)
      close_softplus(last, order, energy);
    else
      close_sum_of_squares(exact, e, last, order, shape.outputs(), energy);
    for (int j = 0; j < block.jets; ++j) evaluation.energy_density[begin + j] = energy(0, j);
    if (!back) continue;

    // Backward. `a` holds derivatives by the current layer's output.
    const auto by_parameters = [&](auto&& add) {
      for (int j = 0; j < block.jets; ++j) {
        for (int k = 0; k < parameters; ++k) {
          for (int c = 0; c < block.channels(); ++c) {
            const double value = add(j, k, c);
            const long column = begin + j;
            if (c == 0)
              evaluation.energy_by_parameters(k, column) += value;
            else if (c < 4)
              evaluation.stress_by_parameters((c - 1) * parameters + k, column) += value;
            else
              evaluation.tangent_by_parameters((c - 4) * parameters + k, column) += value;
          }
        }
      }
    };
    if (parameters > 0) {
      for (auto* matrix :
           {&evaluation.energy_by_parameters, &evaluation.stress_by_parameters, &evaluation.tangent_by_parameters})
        if (matrix->cols() > 0) matrix->middleCols(begin, block.jets).setZero();
      by_parameters([&](int j, int k, int c) {
        double sum = energy(c, j) * exact.stiffness_by[k] / exact.stiffness;
        if (shape.form == EnergyForm::softplus) return sum;
        for (int output = 0; output < shape.outputs(); ++output)
          sum -= last.channel(c, j)[output] * exact.rest_by(output, k);
        return sum;
      });
    }
    multiply(content.last.backward, last.factor(), columns, a.data, a.stride);
    auto other = block.jet_block(space.products, width);
    for (std::size_t l = content.hidden.size(); l-- > 0;) {
      activate_backward(order, block.jet_block(space.slopes[l + 1], width), a);
      if (l == content.meeting() && parameters > 0) {
        const auto small = block.jet_block(space.small, padded_rows(parameters));
        multiply(of_design.meeting_back, a.factor(), columns, small.data, small.stride);
        by_parameters([&](int j, int k, int c) { return static_cast<double>(small.channel(c, j)[k]); });
      }
      multiply(content.hidden[l].backward, a.factor(), columns, other.data, other.stride);
      std::swap(a, other);
    }
    activate_backward(order, block.jet_block(space.slopes[0], width), a);
    const auto maps_back = block.jet_block(space.small, padded_rows(3 * maps));
    multiply(of_design.input_back, a.factor(), columns, maps_back.data, maps_back.stride);

    // t_i = sum over the first layer (and the skip) of derivatives times the map's column i.
    const auto mapped = [&](int map, int i, int c, int j) {
      double sum = maps_back.channel(c, j)[3 * map + i];
      const auto& skip = map == 0 ? exact.skip : exact.skip_by[static_cast<std::size_t>(map - 1)];
      if (shape.form == EnergyForm::sum_of_squares)
        for (int k = 0; k < 3; ++k) sum += last.channel(c, j)[k] * skip(k, i);
      return sum;
    };
    for (int j = 0; j < block.jets; ++j) {
      const long column = begin + j;
      for (int i = 0; i < 3; ++i) evaluation.stress(i, column) = mapped(0, i, 0, j);
      if (asked >= Order::tangent)
        for (int i = 0; i < 3; ++i)
          for (int k = i; k < 3; ++k) evaluation.tangent(second_channel[i][k] - 4, column) = mapped(0, i, 1 + k, j);
      if (asked >= Order::third)
        for (int q = 0; q < 10; ++q) evaluation.third(q, column) = mapped(0, thirds[q].component, thirds[q].channel, j);
    }
    // The derivative of the map times e: a product of jets.
    by_parameters([&](int j, int k, int c) {
      double sum = 0;
      for (int i = 0; i < 3; ++i) {
        const auto t = [&](int channel) { return mapped(1 + k, i, channel, j); };
        const auto strain = [&](int channel) { return static_cast<double>(e.channel(channel, j)[i]); };
        sum += product_channel(t, strain, c);
      }
      return sum;
    });
  }
}

template <class Real>
Evaluation BasicEvaluator<Real>::evaluate(const Design& design, const Eigen::Ref<const Eigen::Matrix3Xd>& strains,
                                          Order order) const {
  Workspace workspace;
  Evaluation evaluation;
  evaluate(design, strains, order, workspace, evaluation);
  return evaluation;
}

template class BasicEvaluator<double>;
template class BasicEvaluator<float>;

}  // namespace supple::neural
