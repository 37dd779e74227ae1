#include "supple/design/measured_curve.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "measured_loading.h"
#include "supple/design/design_fault.h"
#include "supple/design/target.h"

namespace supple::design {
namespace {

using Points = MeasuredPoints;

constexpr double half_turn = std::numbers::pi;
/// Numbers of averages that are fitted if there are more points: this many for each control point, and at least
/// min_averages.
constexpr std::size_t averages_per_control_point = 16;
constexpr std::size_t min_averages = 400;
constexpr int min_control_points = 2;
constexpr int max_control_points = 64;
/// Minimum distance of knots, as a fraction of the range of x.
constexpr double min_knot_distance = 0.004;
/// Minimum decrease of the sum of squares by a knot, as a multiple of the points' variance. A knot whose value and
/// position fit noise alone decreases the sum by about twice the variance.
constexpr double min_variance_multiple = 8;

[[noreturn]] void refuse_curve(const std::string& where, const std::string& message) {
  throw MeasurementFault("design.invalid_measurement", where + ": " + message + ".", {{where, message}});
}

/// Control points must satisfy the limits of targets.
void refuse_beyond_targets(const Points& points) {
  for (const auto& p : points) {
    if (p.cwiseAbs().maxCoeff() <= largest_coordinate) continue;
    refuse_curve("points", fmt::format("must have coordinates from -1e6 to 1e6 in the units of a target, one has "
                                       "({:.6g}, {:.6g}), whose unit may be wrong",
                                       p.x(), p.y()));
  }
}

double root_mean_square(const Points& points) {
  double sum = 0;
  for (const auto& p : points) sum += p.y() * p.y();
  return std::sqrt(sum / static_cast<double>(points.size()));
}

/// The points in increasing order of x. Points of equal x become one point, whose y is their average.
Points sorted(Points points) {
  std::stable_sort(points.begin(), points.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
  Points out;
  for (std::size_t i = 0; i < points.size();) {
    std::size_t j = i;
    double sum = 0;
    for (; j < points.size() && points[j].x() == points[i].x(); ++j) sum += points[j].y();
    out.emplace_back(points[i].x(), sum / static_cast<double>(j - i));
    i = j;
  }
  return out;
}

/// Averages of neighbouring points, and the number of points in each average.
struct Averages {
  Points points;
  Eigen::VectorXd weights;
};

Averages averages_of(const Points& points, int control_points) {
  const std::size_t n = points.size();
  const std::size_t groups =
      std::min(n, std::max(min_averages, averages_per_control_point * static_cast<std::size_t>(control_points)));
  Averages averages;
  averages.points.reserve(groups);
  averages.weights.resize(static_cast<Eigen::Index>(groups));
  for (std::size_t g = 0; g < groups; ++g) {
    const std::size_t begin = g * n / groups, end = (g + 1) * n / groups;
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    for (std::size_t i = begin; i < end; ++i) sum += points[i];
    const auto count = static_cast<double>(end - begin);
    averages.points.emplace_back(sum / count);
    averages.weights[static_cast<Eigen::Index>(g)] = count;
  }
  return averages;
}

/// Estimated standard deviation of the points' noise, almost zero for a smooth curve. Each point is compared with the
/// cubic polynomial through its two neighbours on either side. The squared difference is divided by its expected value
/// for independent noise of variance 1.
double noise_of(const Points& points) {
  constexpr std::array<std::size_t, 4> neighbours{0, 1, 3, 4};
  if (points.size() < 6) return 0;
  double sum = 0;
  for (std::size_t i = 0; i + 4 < points.size(); ++i) {
    const double x = points[i + 2].x();
    double difference = points[i + 2].y(), variance = 1;
    for (const std::size_t j : neighbours) {
      double weight = 1;
      for (const std::size_t k : neighbours) {
        if (k != j) weight *= (x - points[i + k].x()) / (points[i + j].x() - points[i + k].x());
      }
      difference -= weight * points[i + j].y();
      variance += weight * weight;
    }
    sum += difference * difference / variance;
  }
  return std::sqrt(sum / static_cast<double>(points.size() - 4));
}

/// A curve through knots, whose values are fitted by weighted least squares. The value of one knot may be fixed at
/// zero.
class KnotFit {
 public:
  KnotFit(const Averages& data, numerics::Interpolation interpolation, std::optional<double> x_period)
      : data_(data), interpolation_(interpolation), x_period_(x_period) {}

  struct Result {
    std::vector<double> y;
    double mean_square = INFINITY;
    Eigen::VectorXd residuals;  ///< residuals of the averages
  };

  /// `fixed` is the index of the knot whose value is fixed at zero, or -1.
  Result operator()(const std::vector<double>& x, int fixed) const {
    const auto n = static_cast<Eigen::Index>(data_.points.size());
    const auto k = static_cast<Eigen::Index>(x.size());
    Result result{start_values(x, fixed), INFINITY, {}};
    // Cubic and linear curves depend linearly on the values of their knots, so that one Gauss-Newton step suffices. The
    // monotone curve depends on them nonlinearly, with kinks where slopes change sign, and takes a few steps.
    const int steps = interpolation_ == numerics::Interpolation::monotone ? 6 : 1;
    evaluate(x, result);
    for (int step = 0; step < steps; ++step) {
      Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(n, k);
      const double h = interpolation_ == numerics::Interpolation::monotone ? 1e-6 * scale() : scale();
      for (Eigen::Index j = 0; j < k; ++j) {
        if (j == fixed) continue;
        Result moved = result;
        moved.y[static_cast<std::size_t>(j)] += h;
        evaluate(x, moved);
        jacobian.col(j) = (moved.residuals - result.residuals) / h;
      }
      const Eigen::MatrixXd weighted = data_.weights.asDiagonal() * jacobian;
      Eigen::MatrixXd normal = jacobian.transpose() * weighted;
      // Regularization: a knot keeps its value if no point determines it.
      normal.diagonal().array() += 1e-9 * normal.diagonal().maxCoeff() + 1e-300;
      const Eigen::VectorXd change = -normal.ldlt().solve(weighted.transpose() * result.residuals);
      if (!line_search(x, change, result)) break;
    }
    return result;
  }

  double scale() const { return scale_; }

 private:
  std::vector<double> start_values(const std::vector<double>& x, int fixed) const {
    std::vector<double> y;
    for (const double at : x) {
      const auto next = std::lower_bound(data_.points.begin(), data_.points.end(), at,
                                         [](const auto& p, double value) { return p.x() < value; });
      y.push_back(next == data_.points.end() ? data_.points.back().y() : next->y());
    }
    if (fixed >= 0) y[static_cast<std::size_t>(fixed)] = 0;
    return y;
  }

  /// Adds the largest of some fractions of the change that decreases the mean square. False if none does.
  bool line_search(const std::vector<double>& x, const Eigen::VectorXd& change, Result& result) const {
    for (const double fraction : {1.0, 0.5, 0.25, 0.125, 0.0625}) {
      Result next = result;
      for (Eigen::Index j = 0; j < change.size(); ++j) next.y[static_cast<std::size_t>(j)] += fraction * change[j];
      evaluate(x, next);
      if (!(next.mean_square < result.mean_square)) continue;
      result = std::move(next);
      return true;
    }
    return false;
  }

  void evaluate(const std::vector<double>& x, Result& result) const {
    const numerics::Interpolant curve(x, result.y, interpolation_, x_period_);
    result.residuals.resize(static_cast<Eigen::Index>(data_.points.size()));
    double sum = 0;
    for (Eigen::Index i = 0; i < result.residuals.size(); ++i) {
      const auto& p = data_.points[static_cast<std::size_t>(i)];
      result.residuals[i] = curve(p.x()) - p.y();
      sum += data_.weights[i] * result.residuals[i] * result.residuals[i];
    }
    result.mean_square = sum / data_.weights.sum();
  }

  const Averages& data_;
  numerics::Interpolation interpolation_;
  std::optional<double> x_period_;
  double scale_ = std::max(1e-300, root_mean_square(data_.points));
};

/// Knots, and the curve that is fitted through them.
class KnotSearch {
 public:
  KnotSearch(const KnotFit& fit, const Averages& data, std::vector<double> knots, std::optional<double> fixed,
             const CancellationToken& cancellation)
      : fit_(fit), data_(data), knots_(std::move(knots)), fixed_(fixed), cancellation_(cancellation) {
    min_distance_ = min_knot_distance * (data.points.back().x() - data.points.front().x());
    result_ = fitted(knots_);
  }

  const std::vector<double>& knots() const { return knots_; }
  const KnotFit::Result& result() const { return result_; }
  int count() const { return static_cast<int>(knots_.size()); }

  /// Adds a knot in an interval between two knots, at the centre of mass of the squared deviations there. Intervals are
  /// tried in the order of decreasing sums of squared deviations, until a knot is an improvement. False if none is.
  bool add_knot() {
    std::vector<double> mass(knots_.size() + 1, 0), moment(knots_.size() + 1, 0);
    std::size_t interval = 0;
    for (std::size_t i = 0; i < data_.points.size(); ++i) {
      const double x = data_.points[i].x();
      while (interval < knots_.size() && knots_[interval] < x) ++interval;
      const double residual = result_.residuals[static_cast<Eigen::Index>(i)];
      const double weight = data_.weights[static_cast<Eigen::Index>(i)] * residual * residual;
      mass[interval] += weight;
      moment[interval] += weight * x;
    }
    std::vector<std::size_t> order(mass.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return mass[a] > mass[b]; });
    for (const std::size_t k : order) {
      if (!(mass[k] > 0)) return false;
      const double lower = k == 0 ? data_.points.front().x() - min_distance_ : knots_[k - 1];
      const double upper = k == knots_.size() ? data_.points.back().x() + min_distance_ : knots_[k];
      if (upper - lower < 2 * min_distance_) continue;
      std::vector<double> knots = knots_;
      knots.insert(knots.begin() + static_cast<std::ptrdiff_t>(k),
                   std::clamp(moment[k] / mass[k], lower + min_distance_, upper - min_distance_));
      if (!accept(std::move(knots))) continue;
      move_knots(k == 0 ? 0 : k - 1, k + 2);
      return true;
    }
    return false;
  }

  /// Moves inner knots as long as that decreases the mean square, in at most `sweeps` sweeps.
  void move_knots(int sweeps) {
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      if (!move_knots(0, knots_.size())) return;
    }
  }

  /// Removes knots, those with the least effect first, as long as the mean square is at most `allowed`.
  void remove_knots(double allowed) {
    while (knots_.size() > 2) {
      std::vector<double> best;
      double min_mean_square = allowed;
      for (std::size_t k = 1; k + 1 < knots_.size(); ++k) {
        if (fixed_ && knots_[k] == *fixed_) continue;
        std::vector<double> knots = knots_;
        knots.erase(knots.begin() + static_cast<std::ptrdiff_t>(k));
        const double mean_square = fitted(knots).mean_square;
        if (!(mean_square <= min_mean_square)) continue;
        min_mean_square = mean_square;
        best = std::move(knots);
      }
      if (best.empty()) return;
      result_ = fitted(best);
      knots_ = std::move(best);
    }
  }

 private:
  /// Moves each inner knot of a range by fractions of the distance to its neighbours if that decreases the mean square.
  /// Returns whether any knot has moved.
  bool move_knots(std::size_t begin, std::size_t end) {
    bool moved = false;
    for (std::size_t k = std::max<std::size_t>(begin, 1); k < end && k + 1 < knots_.size(); ++k) {
      if (fixed_ && knots_[k] == *fixed_) continue;
      for (const double fraction : {-0.5, -0.2, 0.2, 0.5}) {
        const double distance = fraction < 0 ? knots_[k] - knots_[k - 1] : knots_[k + 1] - knots_[k];
        std::vector<double> knots = knots_;
        knots[k] += fraction * distance;
        if (knots[k] - knots[k - 1] < min_distance_ || knots[k + 1] - knots[k] < min_distance_) continue;
        moved |= accept(std::move(knots));
      }
    }
    return moved;
  }

  KnotFit::Result fitted(const std::vector<double>& knots) const {
    cancellation_.throw_if_requested();
    int fixed = -1;
    for (std::size_t k = 0; fixed_ && k < knots.size(); ++k) {
      if (knots[k] == *fixed_) fixed = static_cast<int>(k);
    }
    return fit_(knots, fixed);
  }

  bool accept(std::vector<double> knots) {
    KnotFit::Result candidate = fitted(knots);
    if (!(candidate.mean_square < result_.mean_square)) return false;
    knots_ = std::move(knots);
    result_ = std::move(candidate);
    return true;
  }

  const KnotFit& fit_;
  const Averages& data_;
  std::vector<double> knots_;
  std::optional<double> fixed_;
  const CancellationToken& cancellation_;
  double min_distance_ = 0;
  KnotFit::Result result_;
};

void check(const ReductionOptions& options) {
  if (options.max_control_points < min_control_points || options.max_control_points > max_control_points) {
    refuse_curve("max_control_points", "must be from " + std::to_string(min_control_points) + " to " +
                                           std::to_string(max_control_points) + ", got " +
                                           std::to_string(options.max_control_points));
  }
}

/// The points that count, in the order of the measurement. Directions are taken modulo pi.
Points counted(const MeasuredCurve& curve, const ReductionOptions& options, SetAside& set_aside) {
  Points points;
  points.reserve(curve.points.size());
  for (const Eigen::Vector2d& p : curve.points) {
    if (!p.allFinite()) {
      ++set_aside.no_number;
      continue;
    }
    if (p.x() < options.lower.value_or(-INFINITY) || p.x() > options.upper.value_or(INFINITY)) {
      ++set_aside.out_of_range;
      continue;
    }
    points.push_back(p);
    if (curve.task != Task::stress_strain) {
      double x = std::fmod(p.x(), half_turn);
      if (x < 0) x += half_turn;
      points.back().x() = x < half_turn ? x : 0;
    }
  }
  return points;
}

void select_first_loading(Points& points, Switch wanted, ReducedCurve& reduced, const Execution& execution) {
  reduced.first_loading =
      wanted == Switch::on || (wanted == Switch::automatic && reversal(points) > noticeable_fraction);
  std::string why = "the request asks for it";
  if (wanted == Switch::off) why = "the request leaves it out";
  if (wanted == Switch::automatic) {
    why = reduced.first_loading ? "the strain turns back by more than 5 % of its range"
                                : "the strain does not turn back by more than 5 % of its range";
  }
  if (execution.cost) execution.cost->add_effect("loading", reduced.first_loading, why);
  if (!reduced.first_loading) return;
  const std::size_t before = points.size();
  points = first_loadings(points);
  reduced.set_aside.not_first_loading = before - points.size();
}

void cut_after_rupture(Points& points, Switch wanted, ReducedCurve& reduced, const Execution& execution) {
  const std::size_t after = wanted == Switch::off ? 0 : points_after_rupture(points);
  std::string why = "the request leaves it out";
  if (wanted != Switch::off)
    why = after > 0 ? "the stress falls suddenly and does not come back" : "the stress does not fall suddenly";
  if (execution.cost) execution.cost->add_effect("rupture", after > 0, why);
  points.resize(points.size() - after);
  if (after > 0) reduced.rupture_at = points.back().x();
  reduced.set_aside.after_rupture = after;
}

bool passes_origin(const Points& points, Task task, Switch wanted, const Execution& execution) {
  const double lower = points.front().x(), upper = points.back().x();
  const bool near = lower <= noticeable_fraction * (upper - lower) && upper >= -noticeable_fraction * (upper - lower);
  const bool is_strain = task == Task::stress_strain;
  const bool passes = is_strain && (wanted == Switch::on || (wanted == Switch::automatic && near));
  std::string why = "the request asks for it";
  if (wanted == Switch::off) why = "the request leaves it out";
  if (wanted == Switch::automatic) {
    why = passes ? "the strains begin within 5 % of their range of zero, or pass it"
                 : "the strains begin farther than 5 % of their range from zero";
  }
  if (!is_strain) why = "only stress over strain vanishes at rest";
  if (execution.cost) execution.cost->add_effect("origin", passes, why);
  return passes;
}

/// The measured y at x = 0: interpolated between the neighbours, or the value of the nearest end.
double value_at_zero(const Points& points) {
  const auto next =
      std::lower_bound(points.begin(), points.end(), 0.0, [](const auto& p, double x) { return p.x() < x; });
  if (next == points.begin()) return next->y();
  if (next == points.end()) return points.back().y();
  const auto before = next - 1;
  const double t = -before->x() / (next->x() - before->x());
  return (1 - t) * before->y() + t * next->y();
}

std::vector<double> initial_knots(const Points& points, bool periodic, bool origin) {
  const double lower = points.front().x(), upper = points.back().x(), range = upper - lower;
  if (periodic) {
    // At least four directions, even if all points lie within a part of half a turn.
    const double step = std::min(range, 0.75 * half_turn) / 3;
    return {lower, lower + step, lower + 2 * step, lower + 3 * step};
  }
  if (!origin) return {lower, upper};
  if (lower < -noticeable_fraction * range && upper > noticeable_fraction * range) return {lower, 0, upper};
  if (lower < -noticeable_fraction * range) return {lower, 0};
  return {0, upper};
}

/// Computes the deviation of the final curve from all points that count.
void measure_error(const numerics::Interpolant& curve, ReducedCurve& reduced) {
  double sum = 0;
  for (const auto& p : reduced.points) {
    const double deviation = std::abs(curve(p.x()) - p.y());
    sum += deviation * deviation;
    if (deviation > reduced.max_deviation) {
      reduced.max_deviation = deviation;
      reduced.max_at = p.x();
    }
  }
  const double scale = root_mean_square(reduced.points);
  if (scale > 0) reduced.relative_rms = std::sqrt(sum / static_cast<double>(reduced.points.size())) / scale;
}

}  // namespace

ReducedCurve reduce(const MeasuredCurve& curve, const ReductionOptions& options, const Execution& execution) {
  check(options);
  const StageTimer timer(execution.cost, "reduction");
  const bool periodic = curve.task != Task::stress_strain;
  ReducedCurve reduced;
  reduced.interpolation = options.interpolation;
  Points points = counted(curve, options, reduced.set_aside);
  if (points.size() < 2)
    refuse_curve("points", "must have at least two points that are finite and within the range asked for");
  if (!periodic) {
    select_first_loading(points, options.loading, reduced, execution);
    cut_after_rupture(points, options.rupture, reduced, execution);
  } else if (execution.cost) {
    execution.cost->add_effect("loading", false, "directions are not loaded and unloaded");
    execution.cost->add_effect("rupture", false, "directions do not break");
  }
  reduced.points = sorted(std::move(points));
  if (reduced.points.size() < 2) refuse_curve("points", "must have at least two points of different x");
  refuse_beyond_targets(reduced.points);
  reduced.through_origin = passes_origin(reduced.points, curve.task, options.origin, execution);
  if (reduced.through_origin) reduced.offset = value_at_zero(reduced.points);

  const Averages data = averages_of(reduced.points, options.max_control_points);
  const KnotFit fit(data, options.interpolation, periodic ? std::optional(half_turn) : std::nullopt);
  const double scale = root_mean_square(reduced.points);
  const double noise_deviation = noise_of(reduced.points);
  if (scale > 0) reduced.noise = noise_deviation / scale;
  std::vector<double> knots = initial_knots(reduced.points, periodic, reduced.through_origin);
  KnotSearch search(fit, data, std::move(knots), reduced.through_origin ? std::optional(0.0) : std::nullopt,
                    execution.cancellation);
  // An average of several points has a smaller variance than a single point.
  const double variance = noise_deviation * noise_deviation * static_cast<double>(data.points.size()) /
                          static_cast<double>(reduced.points.size());
  const double min_decrease = min_variance_multiple * variance / static_cast<double>(data.points.size());
  const double allowed = options.tolerance * scale * options.tolerance * scale;
  while (search.count() < options.max_control_points && search.result().mean_square > allowed) {
    execution.checkpoint(static_cast<double>(search.count()) / options.max_control_points, "reduction");
    const double before = search.result().mean_square;
    if (!search.add_knot()) break;
    if (before - search.result().mean_square < min_decrease) break;
  }
  search.move_knots(3);
  search.remove_knots(std::max(allowed, search.result().mean_square + min_decrease));
  execution.checkpoint(1, "reduction");

  const auto& x = search.knots();
  const auto& y = search.result().y;
  for (std::size_t k = 0; k < x.size(); ++k) reduced.control_points.emplace_back(x[k], y[k]);
  refuse_beyond_targets(reduced.control_points);
  measure_error(numerics::Interpolant(x, y, options.interpolation, periodic ? std::optional(half_turn) : std::nullopt),
                reduced);
  if (execution.cost) {
    execution.cost->add_quantity("points", static_cast<double>(reduced.points.size()));
    execution.cost->add_quantity("control_points", static_cast<double>(x.size()));
  }
  return reduced;
}

}  // namespace supple::design
