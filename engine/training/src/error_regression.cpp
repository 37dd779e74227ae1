#include "error_regression.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace supple::training {
namespace {

/// Weight of a held-out state in the fit; the others have weight 1. Held-out states are few, and bars are made for
/// designs like theirs.
constexpr double held_out_weight = 3;
/// Ridge penalty of each squared coefficient but the constant, relative to the weight of all states. Features have
/// standard deviation 1. With a third or three times this value the shipped models are rated no better.
constexpr double ridge = 0.01;
/// Fraction of the states at either end of a feature's range that lie beyond its limits. Features are clamped to the
/// limits, so that the polynomial is not extrapolated.
constexpr double clamped_fraction = 0.001;
/// States whose terms are summed by one matrix product.
constexpr Eigen::Index block_size = 256;

double quantile_at(std::vector<double> values, double fraction) {
  const auto n = static_cast<double>(values.size());
  const auto position = static_cast<std::ptrdiff_t>(std::clamp(fraction * (n - 1), 0.0, n - 1));
  std::nth_element(values.begin(), values.begin() + position, values.end());
  return values[static_cast<std::size_t>(position)];
}

void set_scale(const Eigen::MatrixXd& features, neural::ErrorScale& scale) {
  const auto n = features.cols();
  for (auto* limit : {&scale.least, &scale.greatest, &scale.mean, &scale.deviation}) limit->resize(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const std::vector<double> values(features.col(k).begin(), features.col(k).end());
    scale.least[k] = quantile_at(values, clamped_fraction);
    scale.greatest[k] = quantile_at(values, 1 - clamped_fraction);
    const Eigen::ArrayXd clamped = features.col(k).array().max(scale.least[k]).min(scale.greatest[k]);
    scale.mean[k] = clamped.mean();
    const double deviation = std::sqrt((clamped - scale.mean[k]).square().mean());
    // The deviation 1 avoids a division by zero for features that do not vary.
    scale.deviation[k] = deviation > 1e-9 * (1 + std::abs(scale.mean[k])) ? deviation : 1;
  }
}

}  // namespace

ErrorRegression::ErrorRegression(const ObservedErrors& observed, int folds, double floor, neural::ErrorScale& scale) {
  set_scale(observed.features, scale);
  const auto n = observed.features.cols();
  quadratic_terms_ = 1 + n + n * (n + 1) / 2;
  all_terms_ = quadratic_terms_ + 1 + n;
  held_out_.resize(static_cast<std::size_t>(folds));
  for (int f = -1; f < folds; ++f) {
    std::vector<Eigen::Index> states;
    for (std::size_t i = 0; i < observed.fold.size(); ++i)
      if (observed.fold[i] == f) states.push_back(static_cast<Eigen::Index>(i));
    const bool is_held_out = f >= 0;
    auto& group = is_held_out ? held_out_[static_cast<std::size_t>(f)] : trained_;
    const auto count = static_cast<Eigen::Index>(states.size());
    group.gram.setZero(all_terms_, all_terms_);
    group.right_hand_side.setZero(all_terms_);
    if (is_held_out) {
      group.terms.resize(quadratic_terms_, count);
      group.target.resize(count);
    }
    for (Eigen::Index begin = 0; begin < count; begin += block_size) {
      const auto size = std::min(block_size, count - begin);
      Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(all_terms_, size);
      Eigen::VectorXd target(size);
      for (Eigen::Index j = 0; j < size; ++j) {
        const auto state = states[static_cast<std::size_t>(begin + j)];
        const Eigen::VectorXd z = neural::normalized(scale, observed.features.row(state).transpose());
        columns.col(j).head(quadratic_terms_) = neural::quadratic_terms(z);
        if (!is_held_out) columns.col(j).tail(n + 1) << 1, z;
        target[j] = std::log(std::min(observed.error[state], neural::largest_error) + floor);
      }
      if (is_held_out) {
        group.terms.middleCols(begin, size) = columns.topRows(quadratic_terms_);
        group.target.segment(begin, size) = target;
      }
      add(group, columns, target, is_held_out ? held_out_weight : 1);
    }
  }
}

void ErrorRegression::add(Group& group, const Eigen::MatrixXd& columns, const Eigen::VectorXd& target, double weight) {
  group.gram.selfadjointView<Eigen::Lower>().rankUpdate(columns, weight);
  group.right_hand_side += weight * (columns * target);
  group.weight += weight * static_cast<double>(target.size());
}

Eigen::VectorXd ErrorRegression::fit(int first_fold, int second_fold) const {
  Eigen::MatrixXd gram = trained_.gram;
  Eigen::VectorXd right_hand_side = trained_.right_hand_side;
  double weight = trained_.weight;
  for (int f = 0; f < folds(); ++f) {
    if (f == first_fold || f == second_fold) continue;
    const auto& group = held_out_[static_cast<std::size_t>(f)];
    gram += group.gram;
    right_hand_side += group.right_hand_side;
    weight += group.weight;
  }
  gram.diagonal().array() += ridge * weight;
  gram(0, 0) -= ridge * weight;
  return gram.selfadjointView<Eigen::Lower>().llt().solve(right_hand_side).head(quadratic_terms_);
}

Eigen::VectorXd ErrorRegression::rate(const Eigen::VectorXd& coefficients, int fold) const {
  return held_out_[static_cast<std::size_t>(fold)].terms.transpose() * coefficients;
}

neural::BarOffsets conformal_offsets(const Eigen::VectorXd& ratings, const Eigen::VectorXd& log_errors, double level,
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
    for (auto i = begin; i < end; ++i) differences.push_back(log_errors[order[i]] - ratings[order[i]]);
    // The least difference such that at least the fraction `level` of them does not exceed it.
    const auto count = static_cast<double>(differences.size());
    const auto rank = static_cast<std::ptrdiff_t>(std::clamp(std::ceil(level * count), 1.0, count)) - 1;
    std::nth_element(differences.begin(), differences.begin() + rank, differences.end());
    result.knots.push_back(ratings[order[(begin + end) / 2]]);
    result.offsets.push_back(differences[static_cast<std::size_t>(rank)]);
  }
  return result;
}

}  // namespace supple::training
