#include "supple/design/inverse_design.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <numbers>
#include <sstream>
#include <utility>

#include "supple/base/error.h"
#include "supple/base/threads.h"
#include "target_residuals.h"

namespace supple::design {
namespace {

/// Within this share of the target's scale a sample counts as reached.
constexpr double reached_share = 0.01;
/// Further starting points are tried while the relative root mean square deviation is larger: what is reached by less
/// may be a local minimum.
constexpr double good_share = 1e-3;
/// Samples of each target by which candidates are compared.
constexpr int coarse_samples = 10;
/// What suffices of a search among those samples, and of equilibria while a search is under way.
constexpr double coarse_tolerance = 1e-4;
constexpr double search_tolerance = 1e-6;
/// Equilibria are so much more accurate than what the search distinguishes, or it would chase their errors.
constexpr double search_margin = 1e-2;
/// Starting points are at least this far apart, as a share of the bounds' widths.
constexpr double least_distance = 0.1;
/// How close to a bound a parameter is called at it, as a share of the bounds' widths.
constexpr double bound_share = 1e-6;

std::string percent(double share) {
  std::ostringstream text;
  text.precision(3);
  text << 100 * share << " %";
  return text.str();
}

/// What stays the same from one starting point to the next.
class Search {
 public:
  Search(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options)
      : space_(space), problem_(problem), options_(options), network_(space.model.network) {
    targets_.reserve(problem.targets.size());
    weights_.reserve(problem.targets.size());
    for (const auto& target : problem.targets) {
      targets_.push_back(sample_target(target));
      weights_.push_back(target.weight);
    }
    read_bounds();
  }

  Design run(const Execution& execution, const OnProgress& progress) {
    execution_ = &execution;
    progress_ = &progress;
    const StageTimer timer(execution.cost, "optimization");
    const bool all_fixed = free_.empty();
    if (problem_.initial || all_fixed) follow(all_fixed ? held_ : *problem_.initial);
    const bool enough = all_fixed || options_.multi_start == Switch::off;
    if (best_.starts == 0 || (!enough && (options_.multi_start == Switch::on || !good()))) try_candidates();
    if (!found_)
      throw Error("design.no_equilibrium",
                  "No design of the family " + space_.model.family +
                      " that was tried can be built and has an equilibrium at every sample of the targets.");
    bill_multi_start();
    add_envelope();
    best_.message = message();
    best_.evaluations = evaluations_;
    bill();
    return best_;
  }

 private:
  void read_bounds() {
    const Eigen::Index n = network_.lower.size();
    const std::string count = "The family " + space_.model.family + " has " + std::to_string(n) + " parameters";
    if (problem_.initial && problem_.initial->size() != n)
      throw Error("design.parameter_count", count + ", not " + std::to_string(problem_.initial->size()) + ".",
                  {{"initial", count}});
    if (!problem_.fixed.empty() && static_cast<Eigen::Index>(problem_.fixed.size()) != n)
      throw Error("design.parameter_count", count + ", not " + std::to_string(problem_.fixed.size()) + ".",
                  {{"fixed", count}});
    lower_ = network_.lower;
    upper_ = network_.upper;
    held_ = 0.5 * (lower_ + upper_);
    std::vector<Error::Detail> faults;
    for (Eigen::Index k = 0; k < n; ++k) {
      if (problem_.initial) check_bounds("initial/" + std::to_string(k), k, (*problem_.initial)[k], faults);
      const bool is_fixed = !problem_.fixed.empty() && problem_.fixed[static_cast<std::size_t>(k)];
      if (!is_fixed) {
        free_.push_back(k);
        continue;
      }
      held_[k] = *problem_.fixed[static_cast<std::size_t>(k)];
      check_bounds("fixed/" + std::to_string(k), k, held_[k], faults);
      lower_[k] = upper_[k] = held_[k];
    }
    if (!faults.empty())
      throw Error("design.parameter_out_of_bounds",
                  "Parameter " + faults.front().where + " " + faults.front().message + ".", faults);
  }

  void check_bounds(std::string where, Eigen::Index k, double value, std::vector<Error::Detail>& faults) const {
    const double rounding = 1e-9 * (network_.upper[k] - network_.lower[k]);
    if (value >= network_.lower[k] - rounding && value <= network_.upper[k] + rounding) return;
    faults.push_back({std::move(where), "must be within [" + std::to_string(network_.lower[k]) + ", " +
                                            std::to_string(network_.upper[k]) + "], got " + std::to_string(value)});
  }

  Eigen::VectorXd free_part(const Eigen::VectorXd& all) const {
    Eigen::VectorXd part(static_cast<Eigen::Index>(free_.size()));
    for (std::size_t k = 0; k < free_.size(); ++k) part[static_cast<Eigen::Index>(k)] = all[free_[k]];
    return part;
  }

  /// Optimizes from one starting point and keeps the result if it is the best. Where there are many samples a few of
  /// them come first: that finds the neighbourhood at a fraction of the cost.
  void follow(const Eigen::VectorXd& start) {
    ++best_.starts;
    // Where nothing is searched for, what the parameters do is told whether or not they can be built.
    TargetResiduals residuals(space_.evaluator, targets_, weights_, held_, free_, options_.equilibrium_tolerance,
                              free_.empty() ? Buildable{} : space_.buildable);
    if (initial_.empty()) remember_initial(residuals, start);
    Eigen::VectorXd x = free_part(start);
    auto stopped = DesignStop::no_free_parameters;
    if (!free_.empty()) {
      if (many_samples()) {
        look_coarsely();
        x = optimize(coarse_, x, {.tolerance = std::max(coarse_tolerance, options_.tolerance)}).x;
      }
      const auto result = optimize(targets_, x, {.tolerance = options_.tolerance});
      stopped = static_cast<DesignStop>(result.stopped);
      x = result.x;
    }
    finish(residuals, x, stopped);
    count(residuals);
  }

  numerics::LeastSquaresResult optimize(const std::vector<SampledTarget>& targets, const Eigen::VectorXd& x,
                                        numerics::LeastSquaresOptions options) {
    options.max_iterations = options_.max_iterations;
    TargetResiduals residuals(
        space_.evaluator, targets, weights_, held_, free_,
        std::max(std::min(search_tolerance, search_margin * options.tolerance), options_.equilibrium_tolerance),
        space_.buildable);
    auto result = numerics::minimize_least_squares(
        residuals, x, free_part(lower_), free_part(upper_), options, Execution{execution_->cancellation},
        [&](const Eigen::VectorXd&, double norm, int iteration) { report(residuals, targets, norm, iteration); });
    best_.iterations += result.iterations;
    count(residuals);
    return result;
  }

  void count(const TargetResiduals& residuals) {
    evaluations_ += residuals.evaluations();
    restarts_ += residuals.restarts();
  }

  bool many_samples() const {
    return std::any_of(targets_.begin(), targets_.end(),
                       [](const SampledTarget& target) { return target.y.size() > 2 * coarse_samples; });
  }

  /// Works the profiles out from rest and compares with the best design.
  void finish(TargetResiduals& residuals, const Eigen::VectorXd& x, DesignStop stopped) {
    residuals.forget();
    Eigen::VectorXd r;
    const bool defined = residuals.residuals(x, r);
    if (!defined || (found_ && r.norm() >= best_.error.relative_rms)) return;
    found_ = true;
    best_.parameters = residuals.parameters_of(x);
    best_.stopped = stopped;
    best_.residual = residuals.largest_residual();
    best_.error = {r.norm(), 0};
    best_.reached = true;
    best_.profiles.resize(targets_.size());
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      auto& profile = best_.profiles[t];
      profile.target = targets_[t];
      profile.initial = initial_[t];
      profile.achieved = residuals.values(t);
      profile.in_range = residuals.in_range(space_.model, t);
      const Eigen::VectorXd deviations = targets_[t].deviations(profile.achieved).cwiseAbs();
      if (t == 0) best_.error.max = deviations.maxCoeff();
      profile.reached.resize(static_cast<std::size_t>(deviations.size()));
      for (Eigen::Index i = 0; i < deviations.size(); ++i) {
        const bool reached = deviations[i] <= reached_share * targets_[t].scale;
        profile.reached[static_cast<std::size_t>(i)] = reached;
        best_.reached = best_.reached && reached;
      }
    }
  }

  void remember_initial(TargetResiduals& residuals, const Eigen::VectorXd& start) {
    Eigen::VectorXd r;
    residuals.residuals(free_part(start), r);
    for (std::size_t t = 0; t < targets_.size(); ++t) initial_.push_back(residuals.values(t));
  }

  void report(const TargetResiduals& residuals, const std::vector<SampledTarget>& targets, double norm, int iteration) {
    if (execution_->progress) {
      const double share = static_cast<double>(iteration) / options_.max_iterations;
      execution_->progress->report(std::min(0.99, (best_.starts - 1 + share) / options_.starts), "optimization");
    }
    if (!*progress_ || (reported_ && norm >= least_reported_)) return;
    reported_ = true;
    least_reported_ = norm;
    const Eigen::VectorXd values = residuals.values(0);
    const double largest = targets[0].deviations(values).cwiseAbs().maxCoeff();
    (*progress_)(
        {0, residuals.last_parameters(), targets[0].samples, values, {norm, largest}, best_.iterations + iteration});
  }

  void look_coarsely() {
    if (!coarse_.empty()) return;
    for (const auto& target : targets_) coarse_.push_back(coarsened(target, coarse_samples));
  }

  void look_at_candidates() {
    if (table_) return;
    look_coarsely();
    std::vector<ProfileSamples> profiles;
    profiles.reserve(coarse_.size());
    for (const auto& target : coarse_) profiles.push_back(target.samples);
    const int count =
        options_.candidates > 0 ? options_.candidates : default_candidates(static_cast<int>(free_.size()));
    table_ = space_.candidates.table(lower_, upper_, count, profiles, space_.buildable, *execution_);
  }

  /// The relative root mean square deviation of a candidate; infinite where it has no equilibrium.
  double candidate_error(Eigen::Index candidate) const {
    double sum = 0;
    double weights = 0;
    Eigen::Index at = 0;
    for (std::size_t t = 0; t < coarse_.size(); ++t) {
      const auto n = coarse_[t].y.size();
      const Eigen::VectorXd deviations = coarse_[t].deviations(table_->y.col(candidate).segment(at, n));
      sum += weights_[t] * coarse_[t].weights.dot(deviations.cwiseAbs2()) / (coarse_[t].scale * coarse_[t].scale);
      weights += weights_[t];
      at += n;
    }
    return std::isfinite(sum) ? std::sqrt(sum / weights) : std::numeric_limits<double>::infinity();
  }

  /// Follows the best candidates, far enough from each other, until one reaches the target.
  void try_candidates() {
    look_at_candidates();
    std::vector<std::pair<double, Eigen::Index>> order;
    for (Eigen::Index c = 0; c < table_->parameters.cols(); ++c) order.emplace_back(candidate_error(c), c);
    std::sort(order.begin(), order.end());
    std::vector<Eigen::VectorXd> taken;
    if (problem_.initial) taken.push_back(*problem_.initial);
    const Eigen::VectorXd width = network_.upper - network_.lower;
    const bool only_one = options_.multi_start == Switch::off;
    for (const auto& [error, c] : order) {
      if (best_.starts >= options_.starts || (only_one && found_)) break;
      if (good() && options_.multi_start != Switch::on) break;
      if (!std::isfinite(error) && found_) break;
      const Eigen::VectorXd start = table_->parameters.col(c);
      const bool near = std::any_of(taken.begin(), taken.end(), [&](const Eigen::VectorXd& other) {
        return (start - other).cwiseQuotient(width).cwiseAbs().maxCoeff() < least_distance;
      });
      if (near) continue;
      taken.push_back(start);
      follow(start);
    }
  }

  bool good() const { return best_.reached && best_.error.relative_rms <= good_share; }

  void add_envelope() {
    const bool wanted = options_.envelope == Switch::on || (options_.envelope == Switch::automatic && table_);
    if (execution_->cost)
      execution_->cost->add_effect("envelope", wanted,
                                   options_.envelope == Switch::on    ? "the request asks for it"
                                   : options_.envelope == Switch::off ? "the request leaves it out"
                                   : table_                           ? "candidates were evaluated"
                                                                      : "no candidates were evaluated",
                                   wanted ? 1 : 0);
    if (!wanted) return;
    look_at_candidates();
    Eigen::Index at = 0;
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      const auto n = coarse_[t].y.size();
      add_envelope(best_.profiles[t], coarse_[t], table_->y.middleRows(at, n));
      at += n;
    }
  }

  /// The extremes at the coarse samples, interpolated to all, and the design found.
  static void add_envelope(DesignProfile& profile, const SampledTarget& coarse, const Eigen::MatrixXd& y) {
    std::vector<double> x;
    std::vector<double> low;
    std::vector<double> high;
    for (Eigen::Index i = 0; i < y.rows(); ++i) {
      double least = std::numeric_limits<double>::infinity();
      double most = -least;
      for (Eigen::Index c = 0; c < y.cols(); ++c) {
        if (!std::isfinite(y(i, c))) continue;
        least = std::min(least, y(i, c));
        most = std::max(most, y(i, c));
      }
      if (least > most) continue;
      x.push_back(coarse.samples.x[static_cast<std::size_t>(i)]);
      low.push_back(least);
      high.push_back(most);
    }
    if (x.empty()) return;
    const std::optional<double> period =
        coarse.samples.task == Task::stress_strain ? std::nullopt : std::optional(std::numbers::pi);
    const numerics::Interpolant lowest(x, low, numerics::Interpolation::monotone, period);
    const numerics::Interpolant highest(x, high, numerics::Interpolation::monotone, period);
    const auto& at = profile.target.samples.x;
    profile.lowest.resize(profile.achieved.size());
    profile.highest.resize(profile.achieved.size());
    for (Eigen::Index i = 0; i < profile.achieved.size(); ++i) {
      profile.lowest[i] = std::min(lowest(at[static_cast<std::size_t>(i)]), profile.achieved[i]);
      profile.highest[i] = std::max(highest(at[static_cast<std::size_t>(i)]), profile.achieved[i]);
    }
  }

  std::string message() const {
    std::ostringstream text;
    if (!best_.reached) {
      const auto& main = best_.profiles.front();
      Eigen::Index worst = 0;
      main.target.deviations(main.achieved).cwiseAbs().maxCoeff(&worst);
      text << "No design of " << space_.model.family << " that was found reaches the target; the closest deviates by "
           << percent(best_.error.relative_rms)
           << " (root mean square), most at x = " << main.target.samples.x[static_cast<std::size_t>(worst)] << ".";
      for (const Eigen::Index k : free_) {
        const double rounding = bound_share * (network_.upper[k] - network_.lower[k]);
        const bool low = best_.parameters[k] <= network_.lower[k] + rounding;
        if (low || best_.parameters[k] >= network_.upper[k] - rounding)
          text << " Parameter " << k + 1 << " is at its " << (low ? "lower" : "upper") << " bound.";
      }
    }
    long outside = 0;
    long samples = 0;
    for (const auto& profile : best_.profiles) {
      outside += std::count(profile.in_range.begin(), profile.in_range.end(), 0);
      samples += static_cast<long>(profile.in_range.size());
    }
    if (outside > 0)
      text << (best_.reached ? "" : " ") << outside << " of " << samples
           << " samples lie outside of what the model was trained on.";
    return text.str();
  }

  void bill_multi_start() {
    if (!execution_->cost) return;
    const bool ran = table_ != nullptr;
    const char* why = "the request turns it off";
    if (free_.empty())
      why = "no parameter is free";
    else if (options_.multi_start == Switch::on)
      why = "the request asks for it";
    else if (!problem_.initial)
      why = "the request has no initial parameters";
    else if (options_.multi_start == Switch::automatic)
      why = ran ? "the design found from the initial parameters does not reach the target well"
                : "the design found from the initial parameters reaches the target";
    execution_->cost->add_effect("multi_start", ran, why, best_.starts);
  }

  void bill() const {
    if (!execution_->cost) return;
    execution_->cost->add_quantity("evaluations", static_cast<double>(evaluations_));
    execution_->cost->add_quantity("iterations", best_.iterations);
    execution_->cost->add_quantity("restarts", static_cast<double>(restarts_));
  }

  const DesignSpace& space_;
  const DesignProblem& problem_;
  const DesignOptions& options_;
  const neural::Network& network_;
  const Execution* execution_ = nullptr;
  const OnProgress* progress_ = nullptr;
  std::vector<SampledTarget> targets_;
  std::vector<double> weights_;
  Eigen::VectorXd lower_;  ///< of all parameters; equal to `upper_` where they are held
  Eigen::VectorXd upper_;
  Eigen::VectorXd held_;
  std::vector<Eigen::Index> free_;
  std::vector<Eigen::VectorXd> initial_;  ///< values at the first starting point, of each target
  std::vector<SampledTarget> coarse_;
  std::shared_ptr<const Candidates::Table> table_;
  Design best_;
  bool found_ = false;
  bool reported_ = false;
  double least_reported_ = 0;
  std::int64_t evaluations_ = 0;
  std::int64_t restarts_ = 0;
};

}  // namespace

std::string_view to_string(DesignStop stop) {
  if (stop == DesignStop::no_free_parameters) return "no_free_parameters";
  return numerics::to_string(static_cast<numerics::LeastSquaresStop>(stop));
}

Design find_design(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options,
                   const Execution& execution, const OnProgress& progress) {
  return Search(space, problem, options).run(execution, progress);
}

std::vector<Design> find_designs(std::span<const DesignSpace> spaces, const DesignProblem& problem,
                                 const DesignOptions& options, const Execution& execution, const OnProgress& progress) {
  std::vector<std::optional<Design>> found(spaces.size());
  std::vector<CostLedger> bills(spaces.size());
  std::mutex mutex;
  std::optional<double> best;
  std::size_t done = 0;
  const bool several = spaces.size() > 1;
  parallel_for(static_cast<int>(spaces.size()), [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    OnProgress of_space;
    if (progress)
      of_space = [&, i](const DesignProgress& news) {
        const std::lock_guard lock(mutex);
        if (best && news.error.relative_rms >= *best) return;
        best = news.error.relative_rms;
        progress({i, news.parameters, news.samples, news.achieved, news.error, news.iteration});
      };
    const Execution inner{execution.cancellation, several ? nullptr : execution.progress,
                          execution.cost ? &bills[i] : nullptr};
    try {
      found[i] = find_design(spaces[i], problem, options, inner, of_space);
      found[i]->space = i;
    } catch (const Error& error) {
      if (!several || error.code() != "design.no_equilibrium") throw;
    }
    if (!several || !execution.progress) return;
    const std::lock_guard lock(mutex);
    execution.progress->report(static_cast<double>(++done) / static_cast<double>(spaces.size()), "optimization");
  });
  std::vector<Design> ranking;
  for (std::size_t i = 0; i < spaces.size(); ++i) {
    if (execution.cost) execution.cost->merge(bills[i]);
    if (found[i]) ranking.push_back(std::move(*found[i]));
  }
  if (ranking.empty())
    throw Error("design.no_equilibrium", "No design that was tried has an equilibrium at every sample of the targets.");
  std::stable_sort(ranking.begin(), ranking.end(),
                   [](const Design& a, const Design& b) { return a.error.relative_rms < b.error.relative_rms; });
  return ranking;
}

}  // namespace supple::design
