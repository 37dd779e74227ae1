#include "rest_misfit.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

namespace supple::design {
namespace {

/// The matrix Q with x^T Q x = a^T L L^T b for the entries x of L.
Matrix6 quadratic_form(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Matrix6 form = Matrix6::Zero();
  const Eigen::Matrix3d product = 0.5 * (a * b.transpose() + b * a.transpose());
  form.block<3, 3>(0, 0) = product;
  form.block<2, 2>(3, 3) = product.block<2, 2>(1, 1);
  form(5, 5) = product(2, 2);
  return form;
}

/// The row R with R s = a^T S b for the entries s of a symmetric S in the order 00, 01, 02, 11, 12, 22.
Eigen::Matrix<double, 1, 6> symmetric_row(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  Eigen::Matrix<double, 1, 6> row;
  row << a[0] * b[0], a[0] * b[1] + a[1] * b[0], a[0] * b[2] + a[2] * b[0], a[1] * b[1], a[1] * b[2] + a[2] * b[1],
      a[2] * b[2];
  return row;
}

double beyond_band(double deviation, double band) { return deviation - std::clamp(deviation, -band, band); }

}  // namespace

Eigen::Matrix3d factor_of(const Vector6& entries) {
  Eigen::Matrix3d factor;
  factor << entries[0], 0, 0, entries[1], entries[3], 0, entries[2], entries[4], entries[5];
  return factor;
}

Vector6 entries_of(const Eigen::Matrix3d& factor) {
  Vector6 entries;
  entries << factor(0, 0), factor(1, 0), factor(2, 0), factor(1, 1), factor(2, 1), factor(2, 2);
  return entries;
}

LoadVectors load_vectors(double direction) {
  const double c = std::cos(direction);
  const double s = std::sin(direction);
  return {{c * c, s * s, c * s}, {s * s, c * c, -c * s}};
}

RestMisfit::RestMisfit(const Eigen::Matrix3d& least, double unit) : least_(least), unit_(unit) {}

void RestMisfit::add(const SampledTarget& target, double weight) {
  const bool is_stiffness = target.samples.task == Task::stiffness;
  const double unit = is_stiffness ? unit_ : 1;
  const double factor = weight * (unit / target.scale) * (unit / target.scale);
  for (Eigen::Index i = 0; i < target.y.size(); ++i) {
    if (!(target.weights[i] > 0)) continue;
    Sample sample;
    sample.is_stiffness = is_stiffness;
    sample.y = target.y[i] / unit;
    sample.band = target.bands[i] / unit;
    sample.weight = factor * target.weights[i];
    sample.load = load_vectors(target.samples.x[static_cast<std::size_t>(i)]);
    const auto& [stress, lateral] = sample.load;
    sample.axial_offset = stress.dot(least_ * stress);
    sample.axial = quadratic_form(stress, stress);
    sample.numerator_offset = is_stiffness ? 1 : -lateral.dot(least_ * stress);
    sample.numerator = is_stiffness ? Matrix6::Zero() : Matrix6(-quadratic_form(lateral, stress));
    samples_.push_back(sample);
  }
}

double RestMisfit::value(const Vector6& entries) const {
  double sum = 0;
  for (const Sample& sample : samples_) {
    const double axial = sample.axial_offset + entries.dot(sample.axial * entries);
    const double numerator = sample.numerator_offset + entries.dot(sample.numerator * entries);
    const double deviation = beyond_band(numerator / axial - sample.y, sample.band);
    sum += sample.weight * deviation * deviation;
  }
  return std::isfinite(sum) ? 0.5 * sum : std::numeric_limits<double>::infinity();
}

void RestMisfit::derivatives(const Vector6& entries, Vector6& gradient, Matrix6& hessian) const {
  gradient.setZero();
  hessian.setZero();
  for (const Sample& sample : samples_) {
    const Vector6 axial_slope = 2 * (sample.axial * entries);
    const Vector6 numerator_slope = 2 * (sample.numerator * entries);
    const double axial = sample.axial_offset + 0.5 * entries.dot(axial_slope);
    const double value = (sample.numerator_offset + 0.5 * entries.dot(numerator_slope)) / axial;
    const double deviation = beyond_band(value - sample.y, sample.band);
    if (deviation == 0) continue;
    // The first and second derivatives of value * axial = numerator.
    const Vector6 slope = (numerator_slope - value * axial_slope) / axial;
    const Matrix6 mixed = slope * axial_slope.transpose();
    const Matrix6 curvature = (2 * sample.numerator - 2 * value * sample.axial - mixed - mixed.transpose()) / axial;
    gradient += sample.weight * deviation * slope;
    hessian += sample.weight * (slope * slope.transpose() + deviation * curvature);
  }
}

Eigen::Matrix3d RestMisfit::linear_fit() const {
  constexpr double min_stiffness = 1e-3;  // in units of the targets' scale; a target may have 0 and less
  const auto n = static_cast<Eigen::Index>(samples_.size());
  Eigen::Matrix<double, Eigen::Dynamic, 6> equations(n + 1, 6);
  Eigen::VectorXd values = Eigen::VectorXd::Zero(n + 1);
  equations.row(n).setZero();
  bool has_scale = false;
  for (Eigen::Index i = 0; i < n; ++i) {
    const Sample& sample = samples_[static_cast<std::size_t>(i)];
    const auto& [stress, lateral] = sample.load;
    const double root = std::sqrt(sample.weight);
    const auto axial = symmetric_row(stress, stress);
    if (sample.is_stiffness) {
      // A change of S11 by d changes the stiffness by y^2 d.
      const double y = std::max(sample.y, min_stiffness);
      equations.row(i) = root * y * y * axial;
      values[i] = root * y;
      has_scale = true;
    } else {
      equations.row(i) = root * (symmetric_row(lateral, stress) + sample.y * axial);
      equations.row(n) += axial / static_cast<double>(n);
    }
  }
  values[n] = has_scale ? 0 : 1;
  if (has_scale) equations.row(n).setZero();
  const Vector6 s = equations.colPivHouseholderQr().solve(values);
  Eigen::Matrix3d compliance;
  compliance << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  return compliance - least_;
}

}  // namespace supple::design
