#include "survey.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "supple/base/sobol.h"
#include "supple/base/threads.h"

namespace supple::design {
namespace {

/// Smoothing of the interpolant, a distance as a fraction of the bounds' widths, >= 0. Differences between the
/// corrections of designs that are closer are treated as noise. Increase it if noise of the simulations makes the field
/// steep.
constexpr double smoothing = 3e-3;

/// Number of points of the survey for each free parameter. Increase it if valleys are missed; each point costs a
/// network evaluation and, for the best of them, a search.
constexpr int points_per_parameter = 64;
/// Maximum number of points of the survey. It limits the cost for families with many parameters.
constexpr int max_points = 256;
/// Maximum number of points that are moved to a minimum of the corrected network nearby. Points with a larger lower
/// confidence bound are dropped.
constexpr std::size_t max_refined_points = 128;
/// Multiple of an error bar by which the network may be wrong, > 0. A bar covers nine of ten errors. Increase it to
/// explore designs far from all simulations; reduce it to stay near the best ones.
constexpr double error_bar_multiple = 2;
/// Distance from the nearest simulated design, as a fraction of the bounds' widths, from which on the whole error bar
/// counts. Closer by, it counts in proportion to the distance. Reduce it if the network's error changes fast.
constexpr double full_error_distance = 0.2;

}  // namespace

CorrectionField::CorrectionField(std::vector<Eigen::VectorXd> points, const std::vector<Eigen::VectorXd>& corrections)
    : points_(std::move(points)) {
  const auto n = static_cast<Eigen::Index>(points_.size());
  // The matrix of distances is negative definite on weights that sum to zero. Smoothing is therefore subtracted.
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
    const Eigen::VectorXd difference = x - points_[i];
    const double length = difference.norm();
    if (length > 0) result += weights_.row(static_cast<Eigen::Index>(i)).transpose() * difference.transpose() / length;
  }
  return result;
}

Survey::Survey(const CorrectedModel& model, const std::vector<Observation>& observations,
               const std::vector<Eigen::VectorXd>& tried, const CancellationToken& cancellation)
    : model_(model) {
  const auto dimension = static_cast<int>(model.width().size());
  const int wanted = std::min(max_points, points_per_parameter * dimension);
  const SobolSequence sequence("polish", 1);
  survey_points_.resize(static_cast<std::size_t>(wanted));
  parallel_for(wanted, [&](int i) {
    cancellation.throw_if_requested();
    const auto coordinates = sequence.point(static_cast<std::uint32_t>(i));
    SurveyPoint& point = survey_points_[static_cast<std::size_t>(i)];
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(coordinates.data(), dimension);
    if (auto values = model.feasible_values(x)) point = {x, std::move(*values)};
  });
  std::erase_if(survey_points_, [](const SurveyPoint& point) { return point.x.size() == 0; });
  const double spacing = std::pow(wanted, -1.0 / dimension);
  refine(field_of(observations), tried, spacing / 2, cancellation);
}

/// Moves the most promising points to minima of the corrected network, because designs that meet a target lie in
/// valleys that are narrower than the spacing of points.
void Survey::refine(const CorrectionField& field, const std::vector<Eigen::VectorXd>& tried, double radius,
                    const CancellationToken& cancellation) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < survey_points_.size(); ++i)
    order.emplace_back(lower_confidence_bound(survey_points_[i], field, tried), i);
  std::sort(order.begin(), order.end());
  if (order.size() > max_refined_points) order.resize(max_refined_points);
  std::vector<SurveyPoint> refined(order.size());
  parallel_for(static_cast<int>(order.size()), [&](int k) {
    cancellation.throw_if_requested();
    SurveyPoint& point = survey_points_[order[static_cast<std::size_t>(k)].second];
    const Eigen::VectorXd x =
        model_.trust_region_step({field.at(point.x), field.slope(point.x), point.x}, radius, cancellation).x;
    if (auto values = model_.feasible_values(x)) point = {x, std::move(*values)};
    refined[static_cast<std::size_t>(k)] = std::move(point);
  });
  survey_points_ = std::move(refined);
}

std::optional<Eigen::VectorXd> Survey::next(const std::vector<Observation>& observations,
                                            const std::vector<Eigen::VectorXd>& tried, double below) {
  const CorrectionField field = field_of(observations);
  auto chosen = survey_points_.end();
  for (auto point = survey_points_.begin(); point != survey_points_.end(); ++point) {
    const double bound = lower_confidence_bound(*point, field, tried);
    if (bound >= below) continue;
    below = bound;
    chosen = point;
  }
  if (chosen == survey_points_.end()) return std::nullopt;
  Eigen::VectorXd x = std::move(chosen->x);
  survey_points_.erase(chosen);
  return x;
}

/// Corrections are limited to the targets' scales. A larger correction already excludes a design, and its size would
/// only distort the field elsewhere.
CorrectionField Survey::field_of(const std::vector<Observation>& observations) const {
  const Eigen::VectorXd max_correction = model_.scales();
  std::vector<Eigen::VectorXd> points, corrections;
  for (const Observation& observation : observations) {
    points.push_back(observation.x);
    corrections.emplace_back(observation.correction.cwiseMax(-max_correction).cwiseMin(max_correction));
  }
  return {std::move(points), corrections};
}

double Survey::lower_confidence_bound(const SurveyPoint& point, const CorrectionField& field,
                                      const std::vector<Eigen::VectorXd>& tried) const {
  const double fraction = std::min(1.0, distance_to_nearest(point.x, tried) / full_error_distance);
  return model_.deviation(point.model.values + field.at(point.x)) - fraction * error_bar_multiple * point.model.bar;
}

}  // namespace supple::design
