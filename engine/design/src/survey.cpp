#include "survey.h"

#include <Eigen/LU>
#include <utility>

namespace supple::design {
namespace {

/// Of distances, as a share of the widths: what designs nearer than this differ by is taken for noise.
constexpr double smoothing = 3e-3;

}  // namespace

CorrectionField::CorrectionField(std::vector<Eigen::VectorXd> points, const std::vector<Eigen::VectorXd>& corrections)
    : points_(std::move(points)) {
  const auto n = static_cast<Eigen::Index>(points_.size());
  // Distances are negative definite where weights sum to zero, so that smoothing is subtracted.
  Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + 1, n + 1);
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(n + 1, corrections.front().size());
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto& point = points_[static_cast<std::size_t>(i)];
    for (Eigen::Index j = 0; j < i; ++j)
      system(i, j) = system(j, i) = (point - points_[static_cast<std::size_t>(j)]).norm();
    system(i, i) = -smoothing;
    system(i, n) = system(n, i) = 1;
    values.row(i) = corrections[static_cast<std::size_t>(i)].transpose();
  }
  weights_ = system.partialPivLu().solve(values);
}

Eigen::VectorXd CorrectionField::at(const Eigen::VectorXd& x) const {
  Eigen::VectorXd value = weights_.bottomRows(1).transpose();
  for (std::size_t i = 0; i < points_.size(); ++i)
    value += (x - points_[i]).norm() * weights_.row(static_cast<Eigen::Index>(i)).transpose();
  return value;
}

Eigen::MatrixXd CorrectionField::slope(const Eigen::VectorXd& x) const {
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(weights_.cols(), x.size());
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const Eigen::VectorXd way = x - points_[i];
    const double length = way.norm();
    if (length > 0) result += weights_.row(static_cast<Eigen::Index>(i)).transpose() * way.transpose() / length;
  }
  return result;
}

}  // namespace supple::design
