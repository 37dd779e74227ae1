#include "design_content.h"

#include <cmath>
#include <utility>

namespace supple::neural {
namespace {

/// A vector in its first column, its derivatives by the parameters in the others.
using Dual = Eigen::MatrixXd;

Dual activated(Activation activation, Dual z) {
  for (long i = 0; i < z.rows(); ++i) {
    const auto [value, slope] = value_and_slope(activation, z(i, 0));
    z(i, 0) = value;
    z.row(i).tail(z.cols() - 1) *= slope;
  }
  return z;
}

/// Far outside the bounds of the parameters a stiffness stays a finite number, of no meaning.
constexpr double largest_log_factor = 20;

/// L / sqrt(s) and s, with their derivatives, of the stiffness branch's six outputs.
void scale(const Dual& outputs, DesignContent& content) {
  const auto lower_factor = [](const Eigen::VectorXd& q) {
    const Eigen::Vector3d d = q.head<3>().array().exp();
    Eigen::Matrix3d l;
    l << d[0], 0, 0, q[3] * d[0], d[1], 0, q[4] * d[0], q[5] * d[1], d[2];
    return l;
  };
  Eigen::VectorXd q = outputs.col(0);
  const auto clamped = (q.head<3>().array().abs() > largest_log_factor).eval();
  q.head<3>() = q.head<3>().cwiseMin(largest_log_factor).cwiseMax(-largest_log_factor);
  const Eigen::Matrix3d l = lower_factor(q);
  const double s = l.squaredNorm() / 3;
  content.stiffness = s;
  content.skip = l.transpose() / std::sqrt(s);
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
    content.skip_by.push_back(dl.transpose() / std::sqrt(s) - content.skip * (0.5 * ds / s));
  }
}

}  // namespace

std::pair<double, double> value_and_slope(Activation activation, double z) {
  switch (activation) {
    case Activation::swish: {
      const double s = 1 / (1 + std::exp(-z));
      return {z * s, s + z * s * (1 - s)};
    }
    case Activation::tanh: {
      const double t = std::tanh(z);
      return {t, 1 - t * t};
    }
    default:
      return {std::sin(z), std::cos(z)};
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
  Dual x = activated(network.shape.activation, network.strain[0].bias);
  for (std::size_t i = 1; i < network.strain.size(); ++i)
    x = activated(network.shape.activation, network.strain[i].weights * x + network.strain[i].bias);
  strain_at_rest_ = network.trunk[0].weights.leftCols(network.shape.width) * x.col(0);
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
  Dual p = Dual::Zero(n, with_derivatives ? 1 + n : 1);
  for (long k = 0; k < n; ++k) {
    const double slope = 2 / (network.upper[k] - network.lower[k]);
    p(k, 0) = (parameters[static_cast<std::size_t>(k)] - network.lower[k]) * slope - 1;
    if (with_derivatives) p(k, 1 + k) = slope;
  }

  DesignContent content;
  const auto& first = network.strain[0].weights;
  if (shape.form == EnergyForm::softplus) {
    content.skip.setZero();
    content.stiffness_by = Eigen::VectorXd::Zero(p.cols() - 1);
    content.skip_by.assign(static_cast<std::size_t>(p.cols() - 1), Eigen::Matrix3d::Zero());
    content.input = first;
  } else {
    Dual q = p;
    for (std::size_t i = 0; i < 2; ++i) q = activated(Activation::swish, stiffness_[i](q));
    scale(stiffness_[2](q), content);
    content.input = first.leftCols<3>() * content.skip + first.rightCols<3>();
  }
  for (const auto& skip_by : content.skip_by) content.input_by.emplace_back(first.leftCols<3>() * skip_by);

  Dual h = p;
  for (const auto& layer : parameter_) h = activated(shape.activation, layer(h));
  const Dual meeting = trunk_[0](h);
  content.meeting = meeting.col(0);
  content.meeting_by = meeting.rightCols(p.cols() - 1);

  Dual x = meeting;
  x.col(0) += strain_at_rest_;
  x = activated(shape.activation, std::move(x));
  for (std::size_t i = 1; i + 1 < trunk_.size(); ++i) x = activated(shape.activation, trunk_[i](x));
  const Dual rest = trunk_.back()(x);
  content.rest = rest.col(0);
  content.rest_by = rest.rightCols(p.cols() - 1);
  return content;
}

}  // namespace supple::neural
