// The search for one family's design.
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

/// Further starting points are tried while the relative root mean square deviation is larger: what is reached by less
/// may be a local minimum.
constexpr double good_share = 1e-3;
/// What deviates less is near: the search begins with all samples.
constexpr double near_share = 0.1;
/// What suffices of a search with few samples, and of equilibria while a search is under way.
constexpr double coarse_tolerance = 1e-4;
constexpr double search_tolerance = 1e-6;
/// Equilibria are so much more accurate than what the search distinguishes, or it would chase their errors.
constexpr double search_margin = 1e-2;
/// Starting points are at least this far apart, as a share of the bounds' widths.
constexpr double min_start_distance = 0.035;
/// If the nearest design is not trusted, up to this many candidates are judged by deviation and doubt together, and
/// then up to as many designs around the best of them.
constexpr int max_judged_designs = 32;
/// Those are at this distance from it at first, and at least at the other one, as shares of the bounds' widths.
constexpr double first_distance = 0.1;
constexpr double min_distance = 0.01;
/// Every other starting point is chosen and followed by deviations that count less beyond this share of the target's
/// scale: where profiles jump, squares of a few samples hide that all others agree.
constexpr double outlier_share = 0.1;
/// If a search in which outliers count less ends with a smaller deviation than this, only a few samples are off.
constexpr double deviation_with_few_outliers = 0.03;
/// The number of starting points, if the request leaves it open.
constexpr int starts_in_one_space = 24;
/// Each of several starting points is first followed for this many iterations with a few samples only.
constexpr int lead_iterations = 30;
/// The best of the places where this ends are then refined with all samples: one for this many starting points, and no
/// more than `max_refined_leads`.
constexpr int starts_of_a_refined_lead = 4;
constexpr int max_refined_leads = 4;
/// Two of these places that are nearer to each other, as a share of the bounds' widths, count as one.
constexpr double same_lead = 0.01;
/// Searches from one starting point, each from the equilibria that are found from rest where the one before ended.
constexpr int rounds_from_rest = 3;

/// What stays the same from one starting point to the next.
class Search {
 public:
  /// `problem` has one material at most; `materials` are all that the structure may be made of.
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
      // A value that has an amount added meets the target where the value itself meets the target less that amount.
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
    if (problem_.initial || all_fixed) follow(all_fixed ? bounds_.held : start_of_request());
    const bool enough = all_fixed || options_.multi_start == Switch::off;
    if (best_.starts == 0 || (!enough && (options_.multi_start == Switch::on || !good()))) try_candidates();
    if (found_ && is_doubtful_ && !enough) look_for_trusted();
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
  /// What `initial` says of all parameters.
  Eigen::VectorXd start_of_request() const {
    return FreeParameters::all_of(*problem_.initial,
                                  problem_.initial_orientation.value_or(orientation_in(bounds_.held)));
  }

  /// Optimizes from one starting point and keeps the result if it is the best. Where there are many samples a few of
  /// them come first, unless it is near already: that finds the neighbourhood at a fraction of the cost.
  void follow(const Eigen::VectorXd& start) {
    const bool near = begin(start) <= near_share;
    const Eigen::VectorXd x = bounds_.free_part(start);
    const bool coarsely = !near && many_samples() && !bounds_.free.empty();
    refine(coarsely ? look_around(x, options_.max_iterations, 0).x : x);
  }

  /// The first starting point's profile is part of the answer. Its relative root mean square deviation, or infinity.
  double begin(const Eigen::VectorXd& start) {
    ++best_.starts;
    if (!initial_.empty()) return std::numeric_limits<double>::infinity();
    auto residuals = exact_residuals();
    Eigen::VectorXd r;
    const bool defined = residuals.residuals(bounds_.free_part(start), r);
    for (std::size_t t = 0; t < targets_.size(); ++t) initial_.push_back(residuals.values(t));
    count(residuals);
    return defined ? r.norm() : std::numeric_limits<double>::infinity();
  }

  /// Optimizes as far as it takes to know the neighbourhood, for `outlier` as in TargetResiduals.
  numerics::LeastSquaresResult approach(const std::vector<SampledTarget>& targets, const Eigen::VectorXd& x,
                                        int iterations, double outlier) {
    return optimize(targets, x,
                    {.tolerance = std::max(coarse_tolerance, options_.tolerance),
                     .max_iterations = std::min(iterations, options_.max_iterations)},
                    outlier);
  }
  /// The same with a few samples only.
  numerics::LeastSquaresResult look_around(const Eigen::VectorXd& x, int iterations, double outlier) {
    return approach(candidates_.targets(), x, iterations, outlier);
  }

  /// Optimizes by all samples and keeps the result if it is the best. Where strains have several equilibria, the search
  /// may have followed others than those that are found from rest: then it goes on from these. Where `outlier` is
  /// positive, outliers count less at first.
  void refine(Eigen::VectorXd x, double outlier = 0) {
    if (bounds_.free.empty()) {
      finish(x, DesignStop::no_free_parameters);
      return;
    }
    if (outlier > 0) x = approach(targets_, x, lead_iterations, outlier).x;
    for (int round = 0; round < rounds_from_rest; ++round) {
      const auto result =
          optimize(targets_, x, {.tolerance = options_.tolerance, .max_iterations = options_.max_iterations});
      x = result.x;
      if (finish(x, static_cast<DesignStop>(result.stopped)) <= result.norm + good_share) return;
    }
  }

  /// Where nothing is searched for, what the parameters do is told whether or not they can be built.
  TargetResiduals exact_residuals() const {
    TargetResiduals residuals(space_.evaluator, targets_, weights_, bounds_.held, bounds_.free,
                              options_.equilibrium_tolerance, bounds_.free.empty() ? Buildable{} : space_.buildable);
    residuals.choose_among(moduli_);
    return residuals;
  }

  /// Residuals as searches minimize them.
  TargetResiduals search_residuals(const std::vector<SampledTarget>& targets, double equilibrium_tolerance,
                                   double outlier) const {
    TargetResiduals residuals(space_.evaluator, targets, weights_, bounds_.held, bounds_.free, equilibrium_tolerance,
                              space_.buildable, outlier);
    residuals.choose_among(moduli_);
    residuals.keep_within(limits_);
    return residuals;
  }

  numerics::LeastSquaresResult optimize(const std::vector<SampledTarget>& targets, const Eigen::VectorXd& x,
                                        const numerics::LeastSquaresOptions& options, double outlier = 0) {
    TargetResiduals residuals = search_residuals(
        targets,
        std::max(std::min(search_tolerance, search_margin * options.tolerance), options_.equilibrium_tolerance),
        outlier);
    auto result = numerics::minimize_least_squares(
        residuals, x, bounds_.free_part(bounds_.lower), bounds_.free_part(bounds_.upper), options,
        Execution{execution_->cancellation},
        [&](const Eigen::VectorXd&, double, int iteration) { report(residuals, targets, iteration); });
    best_.iterations += result.iterations;
    count(residuals);
    return result;
  }

  int max_starts() const { return options_.starts > 0 ? options_.starts : starts_in_one_space; }

  void count(const TargetResiduals& residuals) {
    evaluations_ += residuals.evaluations();
    restarts_ += residuals.restarts();
  }

  bool many_samples() const {
    return std::any_of(targets_.begin(), targets_.end(),
                       [](const SampledTarget& target) { return target.y.size() > 2 * coarse_samples; });
  }

  /// Works the profiles out from rest and compares with the best design. Returns the relative root mean square
  /// deviation, infinite where there is no equilibrium.
  double finish(const Eigen::VectorXd& x, DesignStop stopped) {
    auto residuals = exact_residuals();
    Eigen::VectorXd r;
    const bool defined = residuals.residuals(x, r);
    count(residuals);
    if (!defined) return std::numeric_limits<double>::infinity();
    // Its merit is at least its deviation, so that most designs need no error bars.
    if (found_ && r.norm() >= merit_) return r.norm();
    // What nothing is searched for is told even beyond the limits.
    if (auto beyond = bounds_.free.empty() ? std::string()
                                           : excess(space_, problem_.limits, family_part(residuals.last_parameters()));
        !beyond.empty()) {
      if (!beyond_limits_ || r.norm() < least_beyond_) {
        least_beyond_ = r.norm();
        beyond_limits_ = std::move(beyond);
      }
      return r.norm();
    }
    std::vector<ProfileTrust> trusts;
    const auto origin = bounds_.free.empty() ? neural::Origin::given : neural::Origin::searched;
    for (std::size_t t = 0; t < targets_.size(); ++t) trusts.push_back(residuals.trust(space_.model, t, origin));
    const Doubt doubt = weighs_trust() ? doubt_about(targets_, weights_, trusts) : Doubt{};
    nearest_ = std::min(nearest_, r.norm());
    const double merit = std::hypot(r.norm(), doubt.size);
    if (found_ && merit >= merit_) return r.norm();
    merit_ = merit;
    best_.doubt = doubt.size;
    is_doubtful_ = doubt.has_long_bars;
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

  /// Whoever says where to begin looks for a design near there.
  bool weighs_trust() const {
    return options_.trust == Switch::on || (options_.trust == Switch::automatic && !problem_.initial);
  }
  void report(const TargetResiduals& residuals, const std::vector<SampledTarget>& targets, int iteration) {
    if (execution_->progress) {
      const double share = static_cast<double>(iteration) / options_.max_iterations;
      execution_->progress->report(std::min(0.99, (best_.starts - 1 + share) / max_starts()), "optimization");
    }
    if (!*progress_) return;
    // All deviations count in full here, even if the search lessens some of them.
    std::vector<Eigen::VectorXd> achieved;
    for (std::size_t t = 0; t < targets.size(); ++t) achieved.push_back(residuals.values(t));
    const double norm = relative_deviation(targets, weights_, 0, achieved);
    if (reported_ && norm >= least_reported_) return;
    reported_ = true;
    least_reported_ = norm;
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

  /// A way to judge candidates.
  struct Ranking {
    double outlier = 0;                                       ///< as in TargetResiduals
    std::vector<std::pair<double, Eigen::Index>> candidates;  ///< errors and candidates, the best first
    std::size_t next = 0;
  };

  /// Where a search by a few samples ended.
  struct Lead {
    double deviation = 0;  ///< by these samples, for `outlier`
    double outlier = 0;    ///< by which the search goes on
    Eigen::VectorXd x;
  };

  /// Where outliers led to an end at which many samples are off, none of them is an outlier: squares count there.
  Lead lead_of(const numerics::LeastSquaresResult& result, double outlier) {
    if (outlier == 0 || result.norm <= deviation_with_few_outliers) return {result.norm, outlier, result.x};
    TargetResiduals residuals = search_residuals(candidates_.targets(), search_tolerance, 0);
    Eigen::VectorXd r;
    const bool defined = residuals.residuals(result.x, r);
    count(residuals);
    return {defined ? r.norm() : std::numeric_limits<double>::infinity(), 0, result.x};
  }

  Ranking ranking(double outlier) const { return {outlier, candidates_.ranked(outlier)}; }

  /// The best candidate that is not near one of those taken, if there is one: with its error.
  std::optional<std::pair<double, Eigen::VectorXd>> next_start(Ranking& ranking,
                                                               const std::vector<Eigen::VectorXd>& taken) const {
    while (ranking.next < ranking.candidates.size()) {
      const auto& [error, candidate] = ranking.candidates[ranking.next++];
      const Eigen::VectorXd start = candidates_.at(candidate);
      if (!among(taken, start, min_start_distance)) return std::pair{error, start};
    }
    return std::nullopt;
  }

  /// Follows the best candidates, far enough from each other, until one reaches the target: by turns the best when
  /// outliers count less and when all deviations count. Where there are many samples, all by a few of them, and then
  /// those by all that promise most.
  void try_candidates() {
    candidates_.evaluate(*execution_);
    std::array rankings{ranking(outlier_share), ranking(0)};
    std::vector<Eigen::VectorXd> taken;
    if (problem_.initial) taken.push_back(start_of_request());
    const bool only_one = options_.multi_start == Switch::off;
    std::vector<Lead> leads;
    for (std::size_t turn = 0;; turn = 1 - turn) {
      if (best_.starts >= max_starts() || (only_one && found_)) break;
      if (good() && options_.multi_start != Switch::on) break;
      const auto start = next_start(rankings[turn], taken);
      if (!start || (!std::isfinite(start->first) && (found_ || !leads.empty()))) break;
      taken.push_back(start->second);
      if (only_one || !many_samples()) {
        follow(start->second);
        continue;
      }
      begin(start->second);
      const auto end = look_around(bounds_.free_part(start->second), lead_iterations, rankings[turn].outlier);
      if (!end.defined) continue;
      auto lead = lead_of(end, rankings[turn].outlier);
      if (lead.deviation <= good_share)
        refine(lead.x, lead.outlier);
      else
        leads.push_back(std::move(lead));
    }
    refine_leads(std::move(leads));
  }

  /// Looks for designs that are less near to the target but trusted more, among the candidates and then around the best
  /// one. Error bars have jumps, where a sample begins to be trusted, so that no derivatives are used.
  void look_for_trusted() {
    const auto begin = std::chrono::steady_clock::now();
    judge_candidates();
    judge_around_the_best();
    trust_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  }

  void judge_candidates() {
    candidates_.evaluate(*execution_);
    std::vector<Eigen::VectorXd> tried;
    for (const auto& [error, candidate] : candidates_.ranked(0)) {
      if (!(error < merit_) || tried.size() >= max_judged_designs) return;
      const Eigen::VectorXd all = candidates_.at(candidate);
      if (among(tried, all, min_start_distance)) continue;
      tried.push_back(all);
      judge(bounds_.free_part(all));
    }
  }

  /// A pattern search, which halves its distance where no neighbour is better.
  void judge_around_the_best() {
    const Eigen::VectorXd lower = bounds_.free_part(bounds_.lower);
    const Eigen::VectorXd width = bounds_.free_part(bounds_.upper) - lower;
    const int last = judged_ + max_judged_designs;
    double distance = first_distance;
    while (distance >= min_distance) {
      const double before = merit_;
      for (Eigen::Index k = 0; k < width.size(); ++k) {
        for (const double side : {-distance, distance}) {
          if (!is_doubtful_ || judged_ >= last) return;
          Eigen::VectorXd x = bounds_.free_part(FreeParameters::all_of(best_.parameters, best_.orientation));
          const double here = x[k];
          x[k] = std::clamp(here + side * width[k], lower[k], lower[k] + width[k]);
          if (x[k] != here) judge(x);
        }
      }
      if (!(merit_ < before)) distance /= 2;
    }
  }

  void judge(const Eigen::VectorXd& x) {
    ++judged_;
    finish(x, DesignStop::trusted);
  }

  void refine_leads(std::vector<Lead> leads) {
    std::stable_sort(leads.begin(), leads.end(),
                     [](const Lead& a, const Lead& b) { return a.deviation < b.deviation; });
    const auto most =
        static_cast<std::size_t>(std::clamp(max_starts() / starts_of_a_refined_lead, 1, max_refined_leads));
    std::vector<Eigen::VectorXd> refined;
    for (const auto& lead : leads) {
      if (good() && options_.multi_start != Switch::on) return;
      if (found_ && (refined.size() >= most || !(lead.deviation < 2 * merit_))) return;
      const Eigen::VectorXd all = all_parameters(bounds_.held, bounds_.free, lead.x);
      if (among(refined, all, same_lead)) continue;
      refined.push_back(all);
      refine(lead.x, lead.outlier);
    }
  }

  /// Whether one of the points is so near, as a share of the bounds' widths.
  bool among(const std::vector<Eigen::VectorXd>& points, const Eigen::VectorXd& point, double distance) const {
    const double turn = orientation_in(bounds_.upper) - orientation_in(bounds_.lower);
    const Eigen::VectorXd width = FreeParameters::all_of(network_.upper - network_.lower, turn > 0 ? turn : 1);
    return std::any_of(points.begin(), points.end(), [&](const Eigen::VectorXd& other) {
      return (point - other).cwiseQuotient(width).cwiseAbs().maxCoeff() < distance;
    });
  }

  bool good() const { return best_.reached && best_.error.relative_rms <= good_share && !is_doubtful_; }

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
      const auto [least, most] = materials_.limits();
      const Task task = candidates_.targets()[t].samples.task;
      Eigen::MatrixXd y(n, 2 * candidates_.count());
      for (Eigen::Index c = 0; c < candidates_.count(); ++c) {
        const Eigen::VectorXd values = candidates_.values(c).segment(at, n);
        y.col(2 * c) = factor_for(task, least) * values;
        y.col(2 * c + 1) = factor_for(task, most) * values;
      }
      bound_profile(best_.profiles[t], candidates_.targets()[t], y);
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

  /// What stops a design from coming closer may be its material.
  std::string message_about_modulus() const {
    if (best_.reached || problem_.moduli.empty()) return {};
    const auto& [least, most] = problem_.moduli[best_.material];
    if (!(least < most) || (best_.youngs_modulus > least && best_.youngs_modulus < most)) return {};
    return std::string(" Young's modulus is at its ") + (best_.youngs_modulus == least ? "lower" : "upper") + " limit.";
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
      const bool has_chosen = nearest_ < best_.error.relative_rms;
      execution_->cost->add_effect("trust", has_chosen,
                                   options_.trust == Switch::off ? "the request turns it off"
                                   : !weighs_trust()             ? "the request says where to begin"
                                   : has_chosen ? "the model's error bars are long at a design that seems nearer"
                                                : "the nearest design is trusted as much as any",
                                   judged_, trust_seconds_);
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
  LimitRows limits_;
  std::optional<std::string> beyond_limits_;  ///< what was, of the best design beyond the limits
  double least_beyond_ = 0;                   ///< its deviation
  std::vector<Eigen::VectorXd> initial_;      ///< values at the first starting point, of each target
  RankedCandidates candidates_;
  Design best_;
  double merit_ = 0;  ///< sqrt(d^2 + u^2) of the best design, see DesignOptions::trust
  bool is_doubtful_ = false;
  int judged_ = 0;            ///< designs that were looked at because the nearest one was not trusted
  double trust_seconds_ = 0;  ///< that this took
  double nearest_ = std::numeric_limits<double>::infinity();  ///< deviation of the nearest design, trusted or not
  bool found_ = false;
  bool reported_ = false;
  double least_reported_ = 0;
  std::int64_t evaluations_ = 0;
  std::int64_t restarts_ = 0;
};

/// The counts of all searches belong to the design that is best.
void add_counts(Design& best, const Design& other) {
  best.iterations += other.iterations;
  best.starts += other.starts;
  best.evaluations += other.evaluations;
}

/// The best design of several materials. Each of them is searched for by itself: a search that may change the material
/// at every step ends where two materials are equally good, and its starting points are those of the materials that
/// look best from afar. The first material that reaches the target with a design that is trusted ends the search.
Design best_of_materials(const DesignSpace& space, const DesignProblem& problem, const DesignOptions& options,
                         const ModulusChoice& materials, const Execution& execution, const OnProgress& progress) {
  std::optional<Design> best;
  std::optional<Error> refusal;
  double least_reported = std::numeric_limits<double>::infinity();
  OnProgress improvements;
  if (progress)
    improvements = [&](const DesignProgress& news) {
      if (news.error.relative_rms >= least_reported) return;
      least_reported = news.error.relative_rms;
      progress(news);
    };
  const std::size_t count = problem.moduli.size();
  for (std::size_t i = 0; i < count; ++i) {
    const double share = 1 / static_cast<double>(count);
    const PartOfExecution part(execution, share * static_cast<double>(i), share);
    DesignProblem alone = problem;
    alone.moduli = {problem.moduli[i]};
    try {
      Design design = Search(space, alone, options, materials).run(part.execution(), improvements);
      design.material = i;
      const auto merit = [](const Design& of) { return std::hypot(of.error.relative_rms, of.doubt); };
      const bool is_better = !best || merit(design) < merit(*best);
      if (best) add_counts(is_better ? design : *best, is_better ? *best : design);
      if (is_better) best = std::move(design);
    } catch (const Error& error) {
      if (error.code() != "design.no_equilibrium" && error.code() != "design.beyond_limits") throw;
      if (!refusal) refusal = error;
    }
    const bool is_good = best && best->reached && best->error.relative_rms <= good_share && best->doubt == 0;
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
