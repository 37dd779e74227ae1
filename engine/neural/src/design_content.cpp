#include "design_content.h"

#include <cmath>
#include <utility>

namespace supple::neural {
namespace {

/// A vector in its first column, its derivatives by the parameters in the others.
using Dual = Eigen::MatrixXd;

Dual linear(const Eigen::Ref<const Eigen::MatrixXd>& weights, const Eigen::VectorXd& bias, const Dual& x) {
  Dual y = weights * x;
  y.col(0) += bias;
  return y;
}

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

Eigen::VectorXd strain_branch_at_rest(const Network& network) {
  Dual x = activated(network.shape.activation, network.strain[0].bias);
  for (std::size_t i = 1; i < network.strain.size(); ++i)
    x = activated(network.shape.activation, linear(network.strain[i].weights, network.strain[i].bias, x));
  return network.trunk[0].weights.leftCols(network.shape.width) * x.col(0);
}

DesignContent evaluate_design(const Network& network, const Eigen::VectorXd& strain_at_rest,
                              std::span<const double> parameters, bool with_derivatives) {
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
    for (std::size_t i = 0; i < 2; ++i)
      q = activated(Activation::swish, linear(network.stiffness[i].weights, network.stiffness[i].bias, q));
    scale(linear(network.stiffness[2].weights, network.stiffness[2].bias, q), content);
    content.input = first.leftCols<3>() * content.skip + first.rightCols<3>();
  }
  for (const auto& skip_by : content.skip_by) content.input_by.emplace_back(first.leftCols<3>() * skip_by);

  Dual h = p;
  for (const auto& layer : network.parameter) h = activated(shape.activation, linear(layer.weights, layer.bias, h));
  const Dual meeting = linear(network.trunk[0].weights.rightCols(shape.width), network.trunk[0].bias, h);
  content.meeting = meeting.col(0);
  content.meeting_by = meeting.rightCols(p.cols() - 1);

  Dual x = meeting;
  x.col(0) += strain_at_rest;
  x = activated(shape.activation, std::move(x));
  for (std::size_t i = 1; i + 1 < network.trunk.size(); ++i)
    x = activated(shape.activation, linear(network.trunk[i].weights, network.trunk[i].bias, x));
  const Dual rest = linear(network.trunk.back().weights, network.trunk.back().bias, x);
  content.rest = rest.col(0);
  content.rest_by = rest.rightCols(p.cols() - 1);
  return content;
}

}  // namespace supple::neural
