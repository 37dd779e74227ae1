#include "survey.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "supple/base/sobol.h"
#include "supple/base/threads.h"

namespace supple::design {
namespace {

/// Of distances, as a share of the widths: what designs nearer than this differ by is taken for noise.
constexpr double smoothing = 3e-3;

constexpr int places_per_parameter = 64;
constexpr int max_places = 256;
/// The most promising of them are moved to where the network deviates least nearby.
constexpr std::size_t max_settled = 128;
/// An error bar holds in nine of ten cases: the network may be off by so many of them.
constexpr double allowed_bars = 2;
/// At half this distance from what was simulated (as a share of the widths) half an error bar is left, from it on all.
constexpr double unknown_distance = 0.2;

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

Survey::Survey(const CorrectedModel& model, const std::vector<Known>& known, const std::vector<Eigen::VectorXd>& tried,
               const CancellationToken& cancellation)
    : model_(model) {
  const auto dimension = static_cast<int>(model.width().size());
  const int wanted = std::min(max_places, places_per_parameter * dimension);
  const SobolSequence sequence("polish", 1);
  places_.resize(static_cast<std::size_t>(wanted));
  parallel_for(wanted, [&](int i) {
    cancellation.throw_if_requested();
    const auto shares = sequence.point(static_cast<std::uint32_t>(i));
    Place& place = places_[static_cast<std::size_t>(i)];
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(shares.data(), dimension);
    if (auto values = model.find(x)) place = {x, std::move(*values)};
  });
  std::erase_if(places_, [](const Place& place) { return place.x.size() == 0; });
  const double spacing = std::pow(wanted, -1.0 / dimension);
  settle(field_of(known), tried, spacing / 2, cancellation);
}

/// Designs that meet a target lie in valleys that are narrower than the distance of places.
void Survey::settle(const CorrectionField& field, const std::vector<Eigen::VectorXd>& tried, double radius,
                    const CancellationToken& cancellation) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < places_.size(); ++i) order.emplace_back(least_to_expect(places_[i], field, tried), i);
  std::sort(order.begin(), order.end());
  if (order.size() > max_settled) order.resize(max_settled);
  std::vector<Place> settled(order.size());
  parallel_for(static_cast<int>(order.size()), [&](int k) {
    cancellation.throw_if_requested();
    Place& place = places_[order[static_cast<std::size_t>(k)].second];
    const Eigen::VectorXd x =
        model_.step_within({field.at(place.x), field.slope(place.x), place.x}, radius, cancellation).x;
    if (auto values = model_.find(x)) place = {x, std::move(*values)};
    settled[static_cast<std::size_t>(k)] = std::move(place);
  });
  places_ = std::move(settled);
}

std::optional<Eigen::VectorXd> Survey::next(const std::vector<Known>& known, const std::vector<Eigen::VectorXd>& tried,
                                            double below) {
  const CorrectionField field = field_of(known);
  auto chosen = places_.end();
  for (auto place = places_.begin(); place != places_.end(); ++place) {
    const double bound = least_to_expect(*place, field, tried);
    if (bound >= below) continue;
    below = bound;
    chosen = place;
  }
  if (chosen == places_.end()) return std::nullopt;
  Eigen::VectorXd x = std::move(chosen->x);
  places_.erase(chosen);
  return x;
}

/// Corrections of more than the targets' scales say that a place is out of the question, and how much more they are
/// would tell nothing of others.
CorrectionField Survey::field_of(const std::vector<Known>& known) const {
  const Eigen::VectorXd most = model_.scales();
  std::vector<Eigen::VectorXd> points, corrections;
  for (const Known& one : known) {
    points.push_back(one.x);
    corrections.emplace_back(one.correction.cwiseMax(-most).cwiseMin(most));
  }
  return {std::move(points), corrections};
}

double Survey::least_to_expect(const Place& place, const CorrectionField& field,
                               const std::vector<Eigen::VectorXd>& tried) const {
  const double share = std::min(1.0, distance_to_nearest(place.x, tried) / unknown_distance);
  return model_.deviation(place.model.values + field.at(place.x)) - share * allowed_bars * place.model.bar;
}

}  // namespace supple::design
