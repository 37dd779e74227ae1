#include "error_regression.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace supple::training {
namespace {

/// Held-out states count so much more than others: there are few of them, and they are what matters.
constexpr double held_weight = 3;
/// Penalty of the squares of all coefficients but the constant, over the weight of all states; features have
/// deviation 1. A third and three times of it rate the shipped models no better.
constexpr double ridge = 0.01;
/// Share of the states at either end beyond which a feature is held constant: nothing is extrapolated.
constexpr double end_share = 0.001;
/// States that are added up at a time.
constexpr Eigen::Index block = 256;

double quantile_of(std::vector<double> values, double share) {
  const auto n = static_cast<double>(values.size());
  const auto position = static_cast<std::ptrdiff_t>(std::clamp(share * (n - 1), 0.0, n - 1));
  std::nth_element(values.begin(), values.begin() + position, values.end());
  return values[static_cast<std::size_t>(position)];
}

void set_limits(const Eigen::MatrixXd& features, neural::ErrorScale& scale) {
  const auto n = features.cols();
  for (auto* limit : {&scale.least, &scale.greatest, &scale.mean, &scale.deviation}) limit->resize(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::vector<double> values(features.col(k).begin(), features.col(k).end());
    scale.least[k] = quantile_of(values, end_share);
    scale.greatest[k] = quantile_of(values, 1 - end_share);
    const Eigen::ArrayXd held = features.col(k).array().max(scale.least[k]).min(scale.greatest[k]);
    scale.mean[k] = held.mean();
    const double deviation = std::sqrt((held - scale.mean[k]).square().mean());
    // A feature that does not vary says nothing.
    scale.deviation[k] = deviation > 1e-9 * (1 + std::abs(scale.mean[k])) ? deviation : 1;
  }
}

}  // namespace

ErrorRegression::ErrorRegression(const ObservedErrors& observed, int folds, double floor, neural::ErrorScale& scale) {
  set_limits(observed.features, scale);
  const auto n = observed.features.cols();
  quadratic_ = 1 + n + n * (n + 1) / 2;
  all_ = quadratic_ + 1 + n;
  held_.resize(static_cast<std::size_t>(folds));
  for (int f = -1; f < folds; ++f) {
    std::vector<Eigen::Index> states;
    for (std::size_t i = 0; i < observed.fold.size(); ++i)
      if (observed.fold[i] == f) states.push_back(static_cast<Eigen::Index>(i));
    const bool held = f >= 0;
    auto& group = held ? held_[static_cast<std::size_t>(f)] : trained_;
    const auto count = static_cast<Eigen::Index>(states.size());
    group.gram.setZero(all_, all_);
    group.right.setZero(all_);
    if (held) {
      group.terms.resize(quadratic_, count);
      group.target.resize(count);
    }
    for (Eigen::Index begin = 0; begin < count; begin += block) {
      const auto size = std::min(block, count - begin);
      Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(all_, size);
      Eigen::VectorXd target(size);
      for (Eigen::Index j = 0; j < size; ++j) {
        const auto state = states[static_cast<std::size_t>(begin + j)];
        const Eigen::VectorXd z = neural::normalized(scale, observed.features.row(state).transpose());
        columns.col(j).head(quadratic_) = neural::quadratic_terms(z);
        if (!held) columns.col(j).tail(n + 1) << 1, z;
        target[j] = std::log(std::min(observed.error[state], neural::largest_error) + floor);
      }
      if (held) {
        group.terms.middleCols(begin, size) = columns.topRows(quadratic_);
        group.target.segment(begin, size) = target;
      }
      add(group, columns, target, held ? held_weight : 1);
    }
  }
}

void ErrorRegression::add(Group& group, const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, double weight) {
  group.gram.selfadjointView<Eigen::Lower>().rankUpdate(columns, weight);
  group.right += weight * (columns * target);
  group.weight += weight * static_cast<double>(target.size());
}

Eigen::VectorXd ErrorRegression::fit(int a, int b) const {
  Eigen::MatrixXd gram = trained_.gram;
  Eigen::VectorXd right = trained_.right;
  double weight = trained_.weight;
  for (int f = 0; f < folds(); ++f) {
    if (f == a || f == b) continue;
    const auto& group = held_[static_cast<std::size_t>(f)];
    gram += group.gram;
    right += group.right;
    weight += group.weight;
  }
  gram.diagonal().array() += ridge * weight;
  gram(0, 0) -= ridge * weight;
  return gram.selfadjointView<Eigen::Lower>().llt().solve(right).head(quadratic_);
}

Eigen::VectorXd ErrorRegression::rate(const Eigen::VectorXd& coefficients, int fold) const {
  return held_[static_cast<std::size_t>(fold)].terms.transpose() * coefficients;
}

neural::BarOffsets conformal_offsets(const Eigen::VectorXd& ratings, const Eigen::VectorXd& logarithms, double level,
                                     int groups) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(ratings.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return ratings[a] < ratings[b]; });
  neural::BarOffsets result;
  const auto n = order.size();
  for (std::size_t g = 0; g < static_cast<std::size_t>(groups); ++g) {
    const auto begin = g * n / static_cast<std::size_t>(groups);
    const auto end = (g + 1) * n / static_cast<std::size_t>(groups);
    if (begin == end) continue;
    std::vector<double> differences;
    for (auto i = begin; i < end; ++i) differences.push_back(logarithms[order[i]] - ratings[order[i]]);
    // The least of the differences that so large a share does not exceed.
    const auto count = static_cast<double>(differences.size());
    const auto rank = static_cast<std::ptrdiff_t>(std::clamp(std::ceil(level * count), 1.0, count)) - 1;
    std::nth_element(differences.begin(), differences.begin() + rank, differences.end());
    result.knots.push_back(ratings[order[(begin + end) / 2]]);
    result.offsets.push_back(differences[static_cast<std::size_t>(rank)]);
  }
  return result;
}

}  // namespace supple::training
