// The search for the best design of one family.
#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <utility>

#include "design_report.h"
#include "free_parameters.h"
#include "modulus_choice.h"
#include "ranked_candidates.h"
#include "structure_limits.h"
#include "supple/base/error.h"
#include "supple/base/part_of_execution.h"
#include "supple/design/inverse_design.h"
#include "target_residuals.h"

namespace supple::design {
namespace {

/// Relative root mean square deviation up to which a reached target needs no further starting points. A larger
/// deviation may be a local minimum.
constexpr double good_deviation = 1e-3;
/// Relative root mean square deviation up to which a search from the first starting point uses all samples at once.
constexpr double near_deviation = 0.1;
/// Tolerance of searches with few samples, and maximum tolerance of equilibria during a search.
constexpr double coarse_tolerance = 1e-4;
constexpr double search_tolerance = 1e-6;
/// Tolerance of equilibria, as a fraction of the search's tolerance. With less accurate equilibria the search would
/// follow their errors.
constexpr double equilibrium_tolerance_ratio = 1e-2;
/// Minimum distance of starting points, as a fraction of the bounds' widths.
constexpr double min_start_distance = 0.035;
/// Maximum number of candidates that are evaluated if the model is uncertain about the best design, and maximum number
/// of designs around the best one that are then evaluated.
constexpr int max_trust_evaluations = 32;
/// Initial and final distance of the pattern search around the best design, as fractions of the bounds' widths.
constexpr double initial_distance = 0.1;
constexpr double min_distance = 0.01;
/// Threshold of outliers, as a fraction of the target's scale, for every other starting point. Where profiles jump, the
/// squares of a few samples would hide that all others agree.
constexpr double outlier_fraction = 0.1;
/// Maximum deviation, with reduced outliers, of a minimum at which only a few samples are outliers.
constexpr double max_deviation_with_outliers = 0.03;
/// Default number of starting points in a single space.
constexpr int default_starts = 24;
/// Iterations of the search with few samples from each of several starting points.
constexpr int coarse_iterations = 30;
/// The best of the minima with few samples are then refined with all samples: one for this many starting points, but at
/// most `max_refined_minima`.
constexpr int starts_per_refined_minimum = 4;
constexpr int max_refined_minima = 4;
/// Minima with few samples that are closer than this count as one; fraction of the bounds' widths.
constexpr double same_minimum_radius = 0.01;
/// Maximum number of searches from one starting point. Each begins at the end of the one before, with equilibria that
/// are computed anew from rest.
constexpr int max_searches_from_rest = 3;

/// A search from several starting points for one material.
class Search {
 public:
  /// `problem` has at most one range of moduli; `materials` are the ranges of all materials.
  Search(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options,
         const ModulusChoice& materials)
      : space_(space),
        problem_(problem),
        options_(options),
        network_(space.model.network),
        bounds_(space, problem),
        materials_(materials),
        moduli_(problem.moduli, space.model.provenance.youngs_modulus),
        limits_(space, problem.limits),
        candidates_({space, options, bounds_, targets_, weights_, moduli_, limits_}) {
    targets_.reserve(problem.targets.size());
    weights_.reserve(problem.targets.size());
    for (const auto& target : problem.targets) {
      targets_.push_back(sample_target(target));
      weights_.push_back(target.weight);
      // Adding a correction to the model's values is the same as subtracting it from the target.
      if (!problem.corrections.empty())
        targets_.back().y -=
            factor_for(target.task, moduli_.single().value()) * problem.corrections[targets_.size() - 1];
    }
  }

  Design run(const Execution& execution, const OnProgress& progress) {
    execution_ = &execution;
    progress_ = &progress;
    const StageTimer timer(execution.cost, "optimization");
    const bool all_fixed = bounds_.free.empty();
    if (problem_.initial || all_fixed) search_from(all_fixed ? bounds_.fixed_values : requested_start());
    const bool no_further_starts = all_fixed || options_.multi_start == Switch::off;
    if (best_.starts == 0 || (!no_further_starts && (options_.multi_start == Switch::on || !is_good())))
      try_candidates();
    if (found_ && is_uncertain_ && !no_further_starts) search_trusted_designs();
    if (!found_ && beyond_limits_)
      throw Error("design.beyond_limits",
                  "No design of the family " + space_.model.family +
                      " that was tried keeps within the limits. Of the one that comes closest to the target, this is "
                      "beyond them: " +
                      *beyond_limits_,
                  {{"limits", *beyond_limits_}});
    if (!found_)
      throw Error("design.no_equilibrium",
                  "No design of the family " + space_.model.family +
                      " that was tried can be built and has an equilibrium at every sample of the targets.");
    bill_multi_start();
    add_envelope();
    best_.message = message_about(best_, space_.model, bounds_.free_of_family()) + message_about_modulus();
    best_.model_error = neural::mean_stress_error(space_.model);
    best_.evaluations = evaluations_;
    bill();
    return best_;
  }

 private:
  /// All parameters of the request's starting point.
  Eigen::VectorXd requested_start() const {
    return FreeParameters::all_of(*problem_.initial,
                                  problem_.initial_orientation.value_or(orientation_in(bounds_.fixed_values)));
  }

  /// Optimizes from one starting point and keeps the result if it is the best. Targets with many samples are first
  /// optimized with a few of them, which finds the neighbourhood of a minimum at a fraction of the cost. This is not
  /// done if the starting point is near the target.
  void search_from(const Eigen::VectorXd& start) {
    const bool near = evaluate_start(start) <= near_deviation;
    const Eigen::VectorXd x = bounds_.free_part(start);
    const bool coarsely = !near && many_samples() && !bounds_.free.empty();
    refine(coarsely ? coarse_search(x, options_.max_iterations, 0).x : x);
  }

  /// Counts a starting point. The profile of the first one is part of the answer. Returns its relative root mean square
  /// deviation, and infinity for the others or if it has no equilibrium.
  double evaluate_start(const Eigen::VectorXd& start) {
    ++best_.starts;
    if (!initial_.empty()) return std::numeric_limits<double>::infinity();
    auto residuals = exact_residuals();
    Eigen::VectorXd r;
    const bool defined = residuals.residuals(bounds_.free_part(start), r);
    for (std::size_t t = 0; t < targets_.size(); ++t) initial_.push_back(residuals.values(t));
    count_evaluations(residuals);
    return defined ? r.norm() : std::numeric_limits<double>::infinity();
  }

  /// Optimizes with coarse_tolerance. `outlier_threshold` is that of TargetResiduals.
  numerics::LeastSquaresResult rough_search(const std::vector<SampledTarget>& targets, const Eigen::VectorXd& x,
                                            int iterations, double outlier_threshold) {
    return optimize(targets, x,
                    {.tolerance = std::max(coarse_tolerance, options_.tolerance),
                     .max_iterations = std::min(iterations, options_.max_iterations)},
                    outlier_threshold);
  }
  /// Optimizes with coarse_tolerance and few samples.
  numerics::LeastSquaresResult coarse_search(const Eigen::VectorXd& x, int iterations, double outlier_threshold) {
    return rough_search(candidates_.targets(), x, iterations, outlier_threshold);
  }

  /// Optimizes with all samples and keeps the result if it is the best. If a strain has several equilibria, the search
  /// may have followed others than those that are found from rest. Then it is repeated from the latter. If
  /// `outlier_threshold` is positive, a search with reduced outliers comes first.
  void refine(Eigen::VectorXd x, double outlier_threshold = 0) {
    if (bounds_.free.empty()) {
      compare_with_best(x, DesignStop::no_free_parameters);
      return;
    }
    if (outlier_threshold > 0) x = rough_search(targets_, x, coarse_iterations, outlier_threshold).x;
    for (int pass = 0; pass < max_searches_from_rest; ++pass) {
      const auto result =
          optimize(targets_, x, {.tolerance = options_.tolerance, .max_iterations = options_.max_iterations});
      x = result.x;
      if (compare_with_best(x, static_cast<DesignStop>(result.stopped)) <= result.norm + good_deviation) return;
    }
  }

  /// Residuals at the tolerance of the answer. If all parameters are fixed, a design is described even if it cannot be
  /// built.
  TargetResiduals exact_residuals() const {
    TargetResiduals residuals(space_.evaluator, targets_, weights_, bounds_.fixed_values, bounds_.free,
                              options_.equilibrium_tolerance, bounds_.free.empty() ? Buildable{} : space_.buildable);
    residuals.choose_among(moduli_);
    return residuals;
  }

  /// Residuals that searches minimize.
  TargetResiduals search_residuals(const std::vector<SampledTarget>& targets, double equilibrium_tolerance,
                                   double outlier_threshold) const {
    TargetResiduals residuals(space_.evaluator, targets, weights_, bounds_.fixed_values, bounds_.free,
                              equilibrium_tolerance, space_.buildable, outlier_threshold);
    residuals.choose_among(moduli_);
    residuals.add_limits(limits_);
    return residuals;
  }

  numerics::LeastSquaresResult optimize(const std::vector<SampledTarget>& targets, const Eigen::VectorXd& x,
                                        const numerics::LeastSquaresOptions& options, double outlier_threshold = 0) {
    TargetResiduals residuals =
        search_residuals(targets,
                         std::max(std::min(search_tolerance, equilibrium_tolerance_ratio * options.tolerance),
                                  options_.equilibrium_tolerance),
                         outlier_threshold);
    auto result = numerics::minimize_least_squares(
        residuals, x, bounds_.free_part(bounds_.lower), bounds_.free_part(bounds_.upper), options,
        Execution{execution_->cancellation},
        [&](const Eigen::VectorXd&, double, int iteration) { report(residuals, targets, iteration); });
    best_.iterations += result.iterations;
    count_evaluations(residuals);
    return result;
  }

  int max_starts() const { return options_.starts > 0 ? options_.starts : default_starts; }

  void count_evaluations(const TargetResiduals& residuals) {
    evaluations_ += residuals.evaluations();
    restarts_ += residuals.restarts();
  }

  bool many_samples() const {
    return std::any_of(targets_.begin(), targets_.end(),
                       [](const SampledTarget& target) { return target.y.size() > 2 * coarse_samples; });
  }

  /// Computes the profiles from rest, and keeps the design if its merit is the best so far. Returns the relative root
  /// mean square deviation; infinite if an equilibrium is missing.
  double compare_with_best(const Eigen::VectorXd& x, DesignStop stopped) {
    auto residuals = exact_residuals();
    Eigen::VectorXd r;
    const bool defined = residuals.residuals(x, r);
    count_evaluations(residuals);
    if (!defined) return std::numeric_limits<double>::infinity();
    // The merit is at least the deviation, so that most designs need no error bars.
    if (found_ && r.norm() >= merit_) return r.norm();
    // If all parameters are fixed, the design is described even if it violates the limits.
    if (auto beyond = bounds_.free.empty() ? std::string()
                                           : excess(space_, problem_.limits, family_part(residuals.last_parameters()));
        !beyond.empty()) {
      if (!beyond_limits_ || r.norm() < deviation_beyond_limits_) {
        deviation_beyond_limits_ = r.norm();
        beyond_limits_ = std::move(beyond);
      }
      return r.norm();
    }
    std::vector<ProfileTrust> trusts;
    const auto origin = bounds_.free.empty() ? neural::Origin::given : neural::Origin::searched;
    for (std::size_t t = 0; t < targets_.size(); ++t) trusts.push_back(residuals.trust(space_.model, t, origin));
    const Uncertainty uncertainty = weighs_trust() ? uncertainty_of(targets_, weights_, trusts) : Uncertainty{};
    min_deviation_ = std::min(min_deviation_, r.norm());
    const double merit = std::hypot(r.norm(), uncertainty.size);
    if (found_ && merit >= merit_) return r.norm();
    merit_ = merit;
    best_.uncertainty = uncertainty.size;
    is_uncertain_ = uncertainty.has_long_bars;
    found_ = true;
    best_.parameters = family_part(residuals.last_parameters());
    best_.orientation = orientation_in(residuals.last_parameters());
    best_.material = residuals.chosen().material;
    best_.youngs_modulus = residuals.chosen().modulus;
    best_.stopped = stopped;
    best_.residual = residuals.largest_residual();
    best_.error = {r.norm(), 0};
    best_.reached = true;
    best_.profiles.resize(targets_.size());
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      auto& profile = best_.profiles[t];
      profile.target = targets_[t];
      profile.target.samples.orientation = best_.orientation;
      profile.initial = initial_[t];
      profile.achieved = residuals.values(t);
      profile.in_range = std::move(trusts[t].in_range);
      profile.error_bar = std::move(trusts[t].error_bar);
      const Eigen::VectorXd deviations = targets_[t].deviations(profile.achieved).cwiseAbs();
      if (t == 0) best_.error.max = deviations.maxCoeff();
      profile.reached = targets_[t].reached(profile.achieved);
      best_.reached = best_.reached &&
                      std::all_of(profile.reached.begin(), profile.reached.end(), [](auto flag) { return flag != 0; });
    }
    return r.norm();
  }

  /// Whether error bars count in the merit. A request with a starting point asks for a design near it, so that
  /// automatic means off.
  bool weighs_trust() const {
    return options_.trust == Switch::on || (options_.trust == Switch::automatic && !problem_.initial);
  }
  void report(const TargetResiduals& residuals, const std::vector<SampledTarget>& targets, int iteration) {
    if (execution_->progress) {
      const double fraction = static_cast<double>(iteration) / options_.max_iterations;
      execution_->progress->report(std::min(0.99, (best_.starts - 1 + fraction) / max_starts()), "optimization");
    }
    if (!*progress_) return;
    // These deviations are complete, also if the search reduces outliers.
    std::vector<Eigen::VectorXd> achieved;
    for (std::size_t t = 0; t < targets.size(); ++t) achieved.push_back(residuals.values(t));
    const double norm = relative_deviation(targets, weights_, 0, achieved);
    if (reported_ && norm >= min_reported_deviation_) return;
    reported_ = true;
    min_reported_deviation_ = norm;
    const Eigen::VectorXd parameters = family_part(residuals.last_parameters());
    const double largest = targets[0].deviations(achieved[0]).cwiseAbs().maxCoeff();
    (*progress_)({0,
                  parameters,
                  orientation_in(residuals.last_parameters()),
                  targets[0].samples,
                  achieved[0],
                  {norm, largest},
                  best_.iterations + iteration});
  }

  /// The candidates in the order of one criterion.
  struct Ranking {
    double outlier_threshold = 0;                             ///< threshold of outliers, as in TargetResiduals
    std::vector<std::pair<double, Eigen::Index>> candidates;  ///< errors and candidates, ordered by increasing error
    std::size_t next = 0;
  };

  /// The end of a search with few samples.
  struct CoarseMinimum {
    double deviation = 0;          ///< deviation at these samples, with `outlier_threshold`
    double outlier_threshold = 0;  ///< for the search with all samples
    Eigen::VectorXd x;
  };

  /// The minimum at the end of a search. If outliers were reduced and the deviation is still large, many samples are
  /// off. There are no outliers then, and the search with all samples uses plain squares.
  CoarseMinimum coarse_minimum_of(const numerics::LeastSquaresResult& result, double outlier_threshold) {
    if (outlier_threshold == 0 || result.norm <= max_deviation_with_outliers)
      return {result.norm, outlier_threshold, result.x};
    TargetResiduals residuals = search_residuals(candidates_.targets(), search_tolerance, 0);
    Eigen::VectorXd r;
    const bool defined = residuals.residuals(result.x, r);
    count_evaluations(residuals);
    return {defined ? r.norm() : std::numeric_limits<double>::infinity(), 0, result.x};
  }

  Ranking ranking(double outlier_threshold) const { return {outlier_threshold, candidates_.ranked(outlier_threshold)}; }

  /// The best remaining candidate that is not near one of those taken, with its error.
  std::optional<std::pair<double, Eigen::VectorXd>> next_start(Ranking& ranking,
                                                               const std::vector<Eigen::VectorXd>& taken) const {
    while (ranking.next < ranking.candidates.size()) {
      const auto& [error, candidate] = ranking.candidates[ranking.next++];
      const Eigen::VectorXd start = candidates_.at(candidate);
      if (!is_near_any(taken, start, min_start_distance)) return std::pair{error, start};
    }
    return std::nullopt;
  }

  /// Searches from the best candidates, which are far enough from each other, until one search reaches the target.
  /// Candidates are taken in turn from the rankings with reduced outliers and with plain squares. Targets with many
  /// samples are first optimized with few samples from all starting points; the best minima are then refined with all
  /// samples.
  void try_candidates() {
    candidates_.evaluate(*execution_);
    std::array rankings{ranking(outlier_fraction), ranking(0)};
    std::vector<Eigen::VectorXd> taken;
    if (problem_.initial) taken.push_back(requested_start());
    const bool only_one = options_.multi_start == Switch::off;
    std::vector<CoarseMinimum> minima;
    for (std::size_t ranking_index = 0;; ranking_index = 1 - ranking_index) {
      if (best_.starts >= max_starts() || (only_one && found_)) break;
      if (is_good() && options_.multi_start != Switch::on) break;
      const auto start = next_start(rankings[ranking_index], taken);
      if (!start || (!std::isfinite(start->first) && (found_ || !minima.empty()))) break;
      taken.push_back(start->second);
      if (only_one || !many_samples()) {
        search_from(start->second);
        continue;
      }
      evaluate_start(start->second);
      const auto coarse_result =
          coarse_search(bounds_.free_part(start->second), coarse_iterations, rankings[ranking_index].outlier_threshold);
      if (!coarse_result.defined) continue;
      auto minimum = coarse_minimum_of(coarse_result, rankings[ranking_index].outlier_threshold);
      if (minimum.deviation <= good_deviation)
        refine(minimum.x, minimum.outlier_threshold);
      else
        minima.push_back(std::move(minimum));
    }
    refine_minima(std::move(minima));
  }

  /// Looks for designs with a smaller merit, which may have a larger deviation: among the candidates, and then around
  /// the best design. Error bars are discontinuous where a sample begins to be trusted, so that no derivatives are
  /// used.
  void search_trusted_designs() {
    const auto begin = std::chrono::steady_clock::now();
    compare_candidates();
    pattern_search();
    trust_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  void compare_candidates() {
    candidates_.evaluate(*execution_);
    std::vector<Eigen::VectorXd> tried;
    for (const auto& [error, candidate] : candidates_.ranked(0)) {
      if (!(error < merit_) || tried.size() >= max_trust_evaluations) return;
      const Eigen::VectorXd all = candidates_.at(candidate);
      if (is_near_any(tried, all, min_start_distance)) continue;
      tried.push_back(all);
      evaluate_for_trust(bounds_.free_part(all));
    }
  }

  /// Changes one parameter of the best design after the other. The distance is halved if no neighbour is better.
  void pattern_search() {
    const Eigen::VectorXd lower = bounds_.free_part(bounds_.lower);
    const Eigen::VectorXd width = bounds_.free_part(bounds_.upper) - lower;
    const int last = trust_evaluations_ + max_trust_evaluations;
    double distance = initial_distance;
    while (distance >= min_distance) {
      const double before = merit_;
      for (Eigen::Index k = 0; k < width.size(); ++k) {
        for (const double offset : {-distance, distance}) {
          if (!is_uncertain_ || trust_evaluations_ >= last) return;
          Eigen::VectorXd x = bounds_.free_part(FreeParameters::all_of(best_.parameters, best_.orientation));
          const double old_value = x[k];
          x[k] = std::clamp(old_value + offset * width[k], lower[k], lower[k] + width[k]);
          if (x[k] != old_value) evaluate_for_trust(x);
        }
      }
      if (!(merit_ < before)) distance /= 2;
    }
  }

  void evaluate_for_trust(const Eigen::VectorXd& x) {
    ++trust_evaluations_;
    compare_with_best(x, DesignStop::trusted);
  }

  void refine_minima(std::vector<CoarseMinimum> minima) {
    std::stable_sort(minima.begin(), minima.end(),
                     [](const CoarseMinimum& a, const CoarseMinimum& b) { return a.deviation < b.deviation; });
    const auto max_refined =
        static_cast<std::size_t>(std::clamp(max_starts() / starts_per_refined_minimum, 1, max_refined_minima));
    std::vector<Eigen::VectorXd> refined;
    for (const auto& minimum : minima) {
      if (is_good() && options_.multi_start != Switch::on) return;
      if (found_ && (refined.size() >= max_refined || !(minimum.deviation < 2 * merit_))) return;
      const Eigen::VectorXd all = all_parameters(bounds_.fixed_values, bounds_.free, minimum.x);
      if (is_near_any(refined, all, same_minimum_radius)) continue;
      refined.push_back(all);
      refine(minimum.x, minimum.outlier_threshold);
    }
  }

  /// Whether one of the points is closer than `distance`, a fraction of the bounds' widths in the maximum norm.
  bool is_near_any(const std::vector<Eigen::VectorXd>& points, const Eigen::VectorXd& point, double distance) const {
    const double orientation_range = orientation_in(bounds_.upper) - orientation_in(bounds_.lower);
    const Eigen::VectorXd width =
        FreeParameters::all_of(network_.upper - network_.lower, orientation_range > 0 ? orientation_range : 1);
    return std::any_of(points.begin(), points.end(), [&](const Eigen::VectorXd& other) {
      return (point - other).cwiseQuotient(width).cwiseAbs().maxCoeff() < distance;
    });
  }

  bool is_good() const { return best_.reached && best_.error.relative_rms <= good_deviation && !is_uncertain_; }

  void add_envelope() {
    const bool wanted =
        options_.envelope == Switch::on || (options_.envelope == Switch::automatic && candidates_.are_evaluated());
    if (execution_->cost)
      execution_->cost->add_effect("envelope", wanted,
                                   options_.envelope == Switch::on    ? "the request asks for it"
                                   : options_.envelope == Switch::off ? "the request leaves it out"
                                   : candidates_.are_evaluated()      ? "candidates were evaluated"
                                                                      : "no candidates were evaluated",
                                   wanted ? 1 : 0);
    if (!wanted) return;
    candidates_.evaluate(*execution_);
    Eigen::Index at = 0;
    for (std::size_t t = 0; t < targets_.size(); ++t) {
      const auto n = candidates_.targets()[t].y.size();
      const auto [min_factor, max_factor] = materials_.limits();
      const Task task = candidates_.targets()[t].samples.task;
      Eigen::MatrixXd y(n, 2 * candidates_.count());
      for (Eigen::Index c = 0; c < candidates_.count(); ++c) {
        const Eigen::VectorXd values = candidates_.values(c).segment(at, n);
        y.col(2 * c) = factor_for(task, min_factor) * values;
        y.col(2 * c + 1) = factor_for(task, max_factor) * values;
      }
      fill_envelope(best_.profiles[t], candidates_.targets()[t], y);
      at += n;
    }
  }

  void bill_multi_start() {
    if (!execution_->cost) return;
    const bool ran = candidates_.are_evaluated();
    const char* why = "the request turns it off";
    if (bounds_.free.empty())
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

  /// The material may be the reason why no design comes closer.
  std::string message_about_modulus() const {
    if (best_.reached || problem_.moduli.empty()) return {};
    const auto& [min_modulus, max_modulus] = problem_.moduli[best_.material];
    if (!(min_modulus < max_modulus) || (best_.youngs_modulus > min_modulus && best_.youngs_modulus < max_modulus))
      return {};
    return std::string(" Young's modulus is at its ") + (best_.youngs_modulus == min_modulus ? "lower" : "upper") +
           " limit.";
  }

  void bill() const {
    if (!execution_->cost) return;
    const bool has_choice = !materials_.single();
    execution_->cost->add_effect("modulus", has_choice,
                                 has_choice ? "the request leaves a choice" : "the request leaves no choice");
    execution_->cost->add_effect(
        "orientation", bounds_.orientation_is_free(),
        bounds_.orientation_is_free() ? "the request leaves a range" : "the request leaves no choice");
    if (space_.model.calibration) {
      const bool has_chosen = min_deviation_ < best_.error.relative_rms;
      execution_->cost->add_effect("trust", has_chosen,
                                   options_.trust == Switch::off ? "the request turns it off"
                                   : !weighs_trust()             ? "the request says where to begin"
                                   : has_chosen ? "the model's error bars are long at a design that seems nearer"
                                                : "the nearest design is trusted as much as any",
                                   trust_evaluations_, trust_seconds_);
    }
    execution_->cost->add_effect("limits", limits_.are_needed(),
                                 limits_.are_needed() ? "the request has limits" : "the request has none");
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
  FreeParameters bounds_;
  const ModulusChoice& materials_;
  ModulusChoice moduli_;
  LimitResiduals limits_;
  /// Violated limits of the design with the least deviation beyond the limits.
  std::optional<std::string> beyond_limits_;
  double deviation_beyond_limits_ = 0;    ///< deviation of that design
  std::vector<Eigen::VectorXd> initial_;  ///< values of each target at the first starting point
  RankedCandidates candidates_;
  Design best_;
  double merit_ = 0;  ///< sqrt(d^2 + u^2) of the best design, see DesignOptions::trust
  bool is_uncertain_ = false;
  int trust_evaluations_ = 0;  ///< designs that were evaluated because the best one was uncertain
  double trust_seconds_ = 0;   ///< time of these evaluations, s
  /// Least deviation of all designs, trusted or not.
  double min_deviation_ = std::numeric_limits<double>::infinity();
  bool found_ = false;
  bool reported_ = false;
  double min_reported_deviation_ = 0;
  std::int64_t evaluations_ = 0;
  std::int64_t restarts_ = 0;
};

/// Adds the counts of another search to those of the best design.
void add_counts(Design& best, const Design& other) {
  best.iterations += other.iterations;
  best.starts += other.starts;
  best.evaluations += other.evaluations;
}

/// The best design of several materials. Each material has a search of its own. A search that chose the material at
/// every step would end where two materials are equally good, and its starting points would be those of the materials
/// that fit best far from a minimum. The first material whose design reaches the target and is trusted ends the search.
Design best_of_materials(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options,
                         const ModulusChoice& materials, const Execution& execution, const OnProgress& progress) {
  std::optional<Design> best;
  std::optional<Error> refusal;
  double min_reported_deviation = std::numeric_limits<double>::infinity();
  OnProgress improvements;
  if (progress)
    improvements = [&](const DesignProgress& update) {
      if (update.error.relative_rms >= min_reported_deviation) return;
      min_reported_deviation = update.error.relative_rms;
      progress(update);
    };
  const std::size_t count = problem.moduli.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double fraction = 1 / static_cast<double>(count);
    const PartOfExecution part(execution, fraction * static_cast<double>(i), fraction);
    DesignProblem single_material_problem = problem;
    single_material_problem.moduli = {problem.moduli[i]};
    try {
      Design design = Search(space, single_material_problem, options, materials).run(part.execution(), improvements);
      design.material = i;
      const auto merit = [](const Design& candidate) {
        return std::hypot(candidate.error.relative_rms, candidate.uncertainty);
      };
      const bool is_better = !best || merit(design) < merit(*best);
      if (best) add_counts(is_better ? design : *best, is_better ? *best : design);
      if (is_better) best = std::move(design);
    } catch (const Error& error) {
      if (error.code() != "design.no_equilibrium" && error.code() != "design.beyond_limits") throw;
      if (!refusal) refusal = error;
    }
    const bool is_good = best && best->reached && best->error.relative_rms <= good_deviation && best->uncertainty == 0;
    if (is_good && options.multi_start != Switch::on) break;
  }
  if (!best) throw Error(*refusal);
  return *std::move(best);
}

}  // namespace

Design find_design(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options,
                   const Execution& execution, const OnProgress& progress) {
  const ModulusChoice materials(problem.moduli, space.model.provenance.youngs_modulus);
  if (problem.moduli.size() > 1) return best_of_materials(space, problem, options, materials, execution, progress);
  return Search(space, problem, options, materials).run(execution, progress);
}

}  // namespace supple::design
