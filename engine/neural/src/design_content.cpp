#include "design_content.h"

#include <cmath>
#include <utility>

namespace supple::neural {
namespace {

/// A vector, in the first column, and its derivatives with respect to the parameters, in the others.
using Dual = Eigen::MatrixXd;

/// The activation of a dual.
Dual activated(Activation activation, Dual z) {
  for (long i = 0; i < z.rows(); ++i) {
    const auto f = activation_at(activation, z(i, 0));
    z(i, 0) = f.value;
    z.row(i).tail(z.cols() - 1) *= f.slope;
  }
  return z;
}

/// The activation of a dual with its derivatives with respect to the three components of strain beside it:
/// [x, x_p | x_1, x_1p | x_2, x_2p | x_3, x_3p].
Dual activated_with_strains(Activation activation, Dual z) {
  const long duals = z.cols() / 4;
  const long parameters = duals - 1;
  for (long i = 0; i < z.rows(); ++i) {
    const auto f = activation_at(activation, z(i, 0));
    for (long strain = 1; strain < 4; ++strain) {
      const double slope = z(i, strain * duals);
      z(i, strain * duals) = f.slope * slope;
      for (long k = 0; k < parameters; ++k) {
        auto& mixed = z(i, strain * duals + 1 + k);
        mixed = f.slope * mixed + f.curvature * slope * z(i, 1 + k);
      }
    }
    z(i, 0) = f.value;
    z.row(i).segment(1, parameters) *= f.slope;
  }
  return z;
}

/// The terms (1, p_i, p_i p_j for i <= j) with their derivatives.
Dual quadratic_terms_of(const Dual& p) {
  const long n = p.rows();
  Dual terms = Dual::Zero(1 + n + n * (n + 1) / 2, p.cols());
  terms(0, 0) = 1;
  terms.middleRows(1, n) = p;
  long at = 1 + n;
  for (long i = 0; i < n; ++i)
    for (long j = i; j < n; ++j, ++at) {
      terms.row(at) = p(i, 0) * p.row(j) + p(j, 0) * p.row(i);
      terms(at, 0) = p(i, 0) * p(j, 0);
    }
  return terms;
}

/// Limit of the logarithms that the stiffness branch returns. It is reached only far outside the bounds of the
/// parameters, and keeps the stiffness finite there.
constexpr double max_log_factor = 20;

/// The skip connection y = A e with A = L^T / sqrt(s), and the derivatives of A.
struct Skip {
  Eigen::Matrix3d map;
  std::vector<Eigen::Matrix3d> map_by;
};

/// The skip connection for the stiffness branch's six outputs. Writes s and its derivatives to `content`.
Skip skip_connection(const Dual& outputs, DesignContent& content) {
  const auto lower_factor = [](const Eigen::VectorXd& q) {
    const Eigen::Vector3d d = q.head<3>().array().exp();
    Eigen::Matrix3d l;
    l << d[0], 0, 0, q[3] * d[0], d[1], 0, q[4] * d[0], q[5] * d[1], d[2];
    return l;
  };
  Eigen::VectorXd q = outputs.col(0);
  const auto clamped = (q.head<3>().array().abs() > max_log_factor).eval();
  q.head<3>() = q.head<3>().cwiseMin(max_log_factor).cwiseMax(-max_log_factor);
  const Eigen::Matrix3d l = lower_factor(q);
  const double s = l.squaredNorm() / 3;
  content.stiffness = s;
  Skip skip{l.transpose() / std::sqrt(s), {}};
  const long parameters = outputs.cols() - 1;
  content.stiffness_by.resize(parameters);
  for (long k = 0; k < parameters; ++k) {
    Eigen::VectorXd dq = outputs.col(1 + k);
    for (int i = 0; i < 3; ++i)
      if (clamped[i]) dq[i] = 0;
    Eigen::Matrix3d dl = Eigen::Matrix3d::Zero();
    for (int i = 0; i < 3; ++i) dl(i, i) = l(i, i) * dq[i];
    dl(1, 0) = l(1, 0) * dq[0] + dq[3] * l(0, 0);
    dl(2, 0) = l(2, 0) * dq[0] + dq[4] * l(0, 0);
    dl(2, 1) = l(2, 1) * dq[1] + dq[5] * l(1, 1);
    const double ds = 2 * l.cwiseProduct(dl).sum() / 3;
    content.stiffness_by[k] = ds;
    skip.map_by.push_back(dl.transpose() / std::sqrt(s) - skip.map * (0.5 * ds / s));
  }
  return skip;
}

}  // namespace

ActivationAt activation_at(Activation activation, double z) {
  switch (activation) {
    case Activation::swish: {
      const double s = 1 / (1 + std::exp(-z));
      const double q = s * (1 - s);
      return {z * s, s + z * s * (1 - s), q * (2 + z * (1 - 2 * s))};
    }
    case Activation::tanh: {
      const double t = std::tanh(z);
      return {t, 1 - t * t, -2 * t * (1 - t * t)};
    }
    default:
      return {std::sin(z), std::cos(z), -std::sin(z)};
  }
}

DesignLayers::DesignLayers(const Network& network) {
  const auto packed = [](const Eigen::Ref<const Eigen::MatrixXd>& weights, const Eigen::VectorXd& bias) {
    return Layer{PackedMatrix<double>(weights), bias};
  };
  for (const auto& layer : network.stiffness) stiffness_.push_back(packed(layer.weights, layer.bias));
  for (const auto& layer : network.parameter) parameter_.push_back(packed(layer.weights, layer.bias));
  for (const auto& layer : network.trunk)
    trunk_.push_back(packed(trunk_.empty() ? layer.weights.rightCols(network.shape.width) : layer.weights, layer.bias));
  const auto& strain_columns = network.trunk[0].weights.leftCols(network.shape.width);
  Dual x = activated(network.shape.activation, network.strain[0].bias);
  for (std::size_t i = 1; i < network.strain.size(); ++i)
    x = activated(network.shape.activation, network.strain[i].weights * x + network.strain[i].bias);
  strain_at_rest_ = strain_columns * x.col(0);
  if (network.shape.rest == RestForm::free) return;
  // The branch is evaluated again with derivatives with respect to its inputs in further columns.
  x.resize(network.shape.width, 1 + network.shape.strain_inputs());
  x << network.strain[0].bias, network.strain[0].weights;
  x = activated(network.shape.activation, x);
  for (std::size_t i = 1; i < network.strain.size(); ++i) {
    x = network.strain[i].weights * x;
    x.col(0) += network.strain[i].bias;
    x = activated(network.shape.activation, x);
  }
  strain_slope_ = strain_columns * x.rightCols(x.cols() - 1);
}

Dual DesignLayers::Layer::operator()(const Dual& x) const {
  const int rows = weights.rows();
  Dual y(padded_rows(rows), x.cols());
  multiply(weights, Factor<double>{x.data(), x.rows()}, static_cast<int>(x.cols()), y.data(),
           static_cast<int>(y.rows()));
  y.col(0).head(rows) += bias;
  if (y.rows() == rows) return y;
  return y.topRows(rows);
}

DesignContent DesignLayers::evaluate(const Network& network, std::span<const double> parameters,
                                     bool with_derivatives) const {
  const auto& shape = network.shape;
  const long n = shape.parameters;
  const long duals = with_derivatives ? 1 + n : 1;
  Dual p = Dual::Zero(shape.design_inputs(), duals);
  for (long k = 0; k < n; ++k) {
    const double slope = 2 / (network.upper[k] - network.lower[k]);
    p(k, 0) = (parameters[static_cast<std::size_t>(k)] - network.lower[k]) * slope - 1;
    if (with_derivatives) p(k, 1 + k) = slope;
  }
  if (shape.features > 0)
    p.bottomRows(shape.features) = evaluate_features(network.geometry, parameters, with_derivatives);

  DesignContent content;
  const auto& first = network.strain[0].weights;
  if (shape.form == EnergyForm::softplus) {
    content.stiffness_by = Eigen::VectorXd::Zero(duals - 1);
    content.input_by.assign(static_cast<std::size_t>(duals - 1), Eigen::MatrixXd::Zero(first.rows(), 3));
    content.input = first;
  } else {
    Dual q = p;
    for (std::size_t i = 0; i + 1 < stiffness_.size(); ++i) q = activated(Activation::swish, stiffness_[i](q));
    Dual outputs = stiffness_.back()(q);
    if (network.mesh_correction.size() > 0) outputs += network.mesh_correction * quadratic_terms_of(p.topRows(n));
    const auto skip = skip_connection(outputs, content);
    content.linear = skip.map;
    content.linear_by.assign(skip.map_by.begin(), skip.map_by.end());
    content.input = first.leftCols<3>() * skip.map + first.rightCols<3>();
    for (const auto& map_by : skip.map_by) content.input_by.emplace_back(first.leftCols<3>() * map_by);
  }

  Dual h = p;
  for (const auto& layer : parameter_) h = activated(shape.activation, layer(h));
  const Dual trunk_bias = trunk_[0](h);
  content.trunk_bias = trunk_bias.col(0);
  content.trunk_bias_by = trunk_bias.rightCols(duals - 1);

  Dual x = trunk_bias;
  x.col(0) += strain_at_rest_;
  if (shape.rest == RestForm::exact) {
    subtract_rest_slope(shape, x, content);
    return content;
  }
  x = activated(shape.activation, std::move(x));
  for (std::size_t i = 1; i + 1 < trunk_.size(); ++i) x = activated(shape.activation, trunk_[i](x));
  const Dual rest = trunk_.back()(x);
  content.rest = rest.col(0);
  content.rest_by = rest.rightCols(duals - 1);
  return content;
}

void DesignLayers::subtract_rest_slope(const NetworkShape& shape, const Dual& trunk_sum, DesignContent& content) const {
  const long duals = trunk_sum.cols();
  Dual x(trunk_sum.rows(), 4 * duals);
  x.leftCols(duals) = trunk_sum;
  // The strain branch reads (A e, e), in which only A depends on parameters.
  const Eigen::MatrixXd slope = strain_slope_.leftCols<3>() * content.linear + strain_slope_.rightCols<3>();
  for (long i = 0; i < 3; ++i) x.col((1 + i) * duals) = slope.col(i);
  for (long k = 0; k + 1 < duals; ++k) {
    const Eigen::MatrixXd slope_by = strain_slope_.leftCols<3>() * content.linear_by[static_cast<std::size_t>(k)];
    for (long i = 0; i < 3; ++i) x.col((1 + i) * duals + 1 + k) = slope_by.col(i);
  }
  x = activated_with_strains(shape.activation, std::move(x));
  for (std::size_t i = 1; i + 1 < trunk_.size(); ++i) x = activated_with_strains(shape.activation, trunk_[i](x));
  const Dual rest = trunk_.back()(x);
  content.rest = rest.col(0);
  content.rest_by = rest.middleCols(1, duals - 1);
  const auto subtract_slope = [&](Eigen::MatrixXd& linear, long column) {
    Eigen::MatrixXd all = Eigen::MatrixXd::Zero(rest.rows(), 3);
    all.topRows<3>() = linear;
    for (long i = 0; i < 3; ++i) all.col(i) -= rest.col((1 + i) * duals + column);
    linear = std::move(all);
  };
  subtract_slope(content.linear, 0);
  for (long k = 0; k + 1 < duals; ++k) subtract_slope(content.linear_by[static_cast<std::size_t>(k)], 1 + k);
}

}  // namespace supple::neural
