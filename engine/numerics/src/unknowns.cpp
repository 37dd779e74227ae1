#include "supple/numerics/unknowns.h"

#include <utility>

namespace supple::numerics {

Unknowns::Unknowns(const std::vector<bool>& fixed, Eigen::MatrixXd directions) : directions_(std::move(directions)) {
  numbering_.reserve(fixed.size());
  for (const bool is_fixed : fixed) numbering_.push_back(is_fixed ? -1 : static_cast<std::int32_t>(core_++));
}

Eigen::VectorXd Unknowns::expand(const Eigen::VectorXd& y) const {
  Eigen::VectorXd x(degrees_of_freedom());
  for (std::size_t i = 0; i < numbering_.size(); ++i)
    x[static_cast<Eigen::Index>(i)] = numbering_[i] < 0 ? 0 : y[numbering_[i]];
  x.tail(directions_.rows()) = directions_ * y.tail(directions_.cols());
  return x;
}

Eigen::VectorXd Unknowns::restrict(const Eigen::VectorXd& x) const {
  Eigen::VectorXd y(size());
  for (std::size_t i = 0; i < numbering_.size(); ++i)
    if (numbering_[i] >= 0) y[numbering_[i]] = x[static_cast<Eigen::Index>(i)];
  y.tail(directions_.cols()) = directions_.transpose() * x.tail(directions_.rows());
  return y;
}

Eigen::MatrixXd Unknowns::expand_core(const Eigen::MatrixXd& rows) const {
  Eigen::MatrixXd all(below_border(), rows.cols());
  for (std::size_t i = 0; i < numbering_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (numbering_[i] < 0)
      all.row(row).setZero();
    else
      all.row(row) = rows.row(numbering_[i]);
  }
  return all;
}

}  // namespace supple::numerics
