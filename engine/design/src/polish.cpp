#include "supple/design/polish.h"

#include <Eigen/SVD>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include "corrected_model.h"
#include "supple/base/error.h"
#include "supple/base/random.h"
#include "survey.h"

namespace supple::design {
namespace {

using Clock = std::chrono::steady_clock;

/// Initial radius of the trust region, from min_radius to max_radius. Lengths are fractions of the bounds' widths
/// (normalized parameters) in the maximum norm. Reduce it if most first steps are rejected.
constexpr double initial_radius = 0.1;
/// Maximum radius of the trust region, up to 1 (the whole box). Reduce it if long steps are often rejected.
constexpr double max_radius = 0.5;
/// Radius after probes, from min_radius to max_radius. If the response changes fast, the slopes that probes measure
/// hold only close to the best design. Increase it if most steps after probes are accepted.
constexpr double radius_after_probes = 0.01;
/// Radius below which a descent takes no more steps, > 0. Reduce it if designs so close to each other still differ by
/// more than the noise of their simulations.
constexpr double min_radius = 2e-4;
/// Minimum predicted reduction of the deviation that is worth a simulation, as a fraction of the deviation, in (0, 1).
/// Reduce it if simulations are cheap.
constexpr double min_predicted_reduction = 0.02;
/// Minimum ratio of the actual to the predicted reduction of the deviation, in (0, 1), at which the trust region may
/// grow. Below it the radius becomes half of the step. Increase it if an accepted step is often followed by a rejected
/// one.
constexpr double min_reduction_ratio = 0.5;
/// Number of consecutive rejected steps after which a descent probes, >= 0. Probes cost one simulation for each free
/// parameter. Increase it for families with many parameters.
constexpr int max_rejected_steps = 2;
/// Number of consecutive rejected steps after which a descent ends if it has already probed, >= 1. Increase it if the
/// trust region is still far above min_radius when descents end.
constexpr int max_rejected_steps_after_probes = 4;
/// Change of the profile that a probe aims at, as a multiple of the profile's deviation, > 0. Increase it if noise of
/// the simulations hides the changes.
constexpr double probe_change_ratio = 2;
/// Minimum length of a probe, a fraction of the bounds' widths, > 0. Increase it if noise hides the changes.
constexpr double min_probe_length = 1e-3;
/// Maximum length of a probe, up to 1. Reduce it if the response is strongly nonlinear over this length.
constexpr double max_probe_length = 0.05;
/// Maximum fraction of the deviation, in (0, 1), that may remain after the steps that followed probes, and after the
/// rounds of an allotment. A descent that is slower ends. Increase it if other starts rarely lead further.
constexpr double max_remaining_fraction = 0.7;
/// Minimum number of rounds of an allotment: those that a descent takes before its progress is checked. An allotment is
/// half of max_rounds if that is more. Increase it if descents from far away end before they come close.
constexpr int min_allotment = 8;
/// Number of random points from which the corrected network is searched for other minima, besides a search of the whole
/// box. Increase it for families with many parameters; it costs no simulations.
constexpr int random_starts = 16;
/// Maximum number of these minima from which a descent starts. Each descent costs an allotment of simulations.
constexpr int max_other_starts = 3;
/// Maximum deviation (relative root mean square) of the corrected network at a minimum from which a descent starts.
/// Increase it if targets are met only roughly in any case.
constexpr double max_start_deviation = 0.1;
/// Designs closer than this to a simulated one are not simulated again; fraction of the bounds' widths.
constexpr double same_design_distance = 1e-3;
/// Minima closer than this to each other count as one; fraction of the bounds' widths.
constexpr double same_minimum_distance = 0.02;
/// Number of consecutive surveyed designs without improvement after which polishing ends. Increase it if simulations
/// are cheap or the network is poor.
constexpr int max_unsuccessful_surveys = 8;
/// Fraction of max_rounds, in [0, 1], after which no descent starts from another minimum; the remaining rounds are for
/// the survey. Reduce it if the network's minima rarely lead to the target.
constexpr double starts_fraction = 0.5;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// A simulated design. If its simulation failed, the values are empty and the deviation is infinite.
struct SimulatedDesign {
  Eigen::VectorXd x;          ///< free parameters, normalized to [0, 1] by their bounds
  Eigen::VectorXd simulated;  ///< values at all samples of all targets
  Eigen::VectorXd model;
  double deviation = infinite;
  Eigen::VectorXd correction() const { return simulated - model; }
};

/// Number of samples of a target that are simulated, at most `limit`. They can be samples of the target itself if a
/// divisor of its number of intervals gives at least half of `limit` samples. Otherwise they lie between those.
int samples_to_simulate(const Target& target, int limit) {
  const bool over_strain = target.task == Task::stress_strain;
  const int target_samples = static_cast<int>(sample_target(target).y.size());
  if (target_samples <= limit) return target_samples;
  // Samples over strain include both ends. Samples over directions divide a period.
  const int intervals = over_strain ? target_samples - 1 : target_samples;
  for (int count = over_strain ? limit - 1 : limit; 2 * count >= limit; --count)
    if (count > 0 && intervals % count == 0) return over_strain ? count + 1 : count;
  return limit;
}

DesignProblem with_few_samples(DesignProblem problem, int limit) {
  for (Target& target : problem.targets) target.samples = samples_to_simulate(target, limit);
  return problem;
}

class Polish {
 public:
  Polish(const DesignSpace& space, const DesignProblem& problem, const SimulateProfile& simulate,
         const PolishOptions& options, const Execution& execution, const OnPolishRound& on_round)
      : space_(space),
        problem_(with_few_samples(problem, options.samples)),
        simulate_(simulate),
        options_(options),
        execution_(execution),
        on_round_(on_round),
        model_(space, problem_, options.equilibrium_tolerance) {}

  Polished run(const Eigen::VectorXd& parameters) {
    return run_to_end([&] {
      best_.x = model_.normalized(parameters);
      return improve(simulate_round(Proposal::search, best_.x, parameters));
    });
  }

  Polished resume(const Polished& before) {
    return run_to_end([&] {
      result_.rounds = before.rounds;
      for (const PolishRound& round : before.rounds) {
        longest_round_ = std::max(longest_round_, round.seconds);
        tried_.push_back(model_.normalized(FreeParameters::all_of(round.parameters, round.orientation)));
      }
      best_.x = model_.normalized(FreeParameters::all_of(before.parameters, before.orientation));
      best_.simulated = scaled(model_.targets(), joined(before.simulated), 1 / before.stress_factor);
      best_.model = scaled(model_.targets(), joined(before.model), 1 / before.stress_factor);
      best_.deviation = before.target_error.value_or(infinite);
      if (std::isfinite(best_.deviation)) observations_.push_back({best_.x, best_.correction()});
      return improve(best_);
    });
  }

 private:
  /// A descent from one start: its best design, and the correction around it.
  struct Descent {
    SimulatedDesign best;
    Eigen::MatrixXd slope;  ///< derivative of the correction by normalized parameters (A in polish.h)
    double radius = initial_radius;
    int rejected = 0;                       ///< consecutive rejected steps
    bool probed = false;                    ///< whether probes were made around the best design
    double deviation_at_probes = infinite;  ///< deviation of the best design at the last probes
    std::size_t allotment_begin = 0;        ///< number of all rounds when the present allotment began
    double deviation_at_allotment = infinite;
  };

  template <class Work>
  Polished run_to_end(const Work& work) {
    start_ = Clock::now();
    try {
      result_.stopped = work();
    } catch (const Error& error) {
      if (error.code() != "job.deadline_exceeded") throw;
      result_.stopped = PolishStop::deadline;
    }
    if (result_.stopped != PolishStop::deadline && !std::isfinite(best_.deviation))
      result_.stopped = PolishStop::not_simulated;
    // The parameters of the round, because normalizing parameters and converting them back would round them.
    const PolishRound* best = &result_.rounds.front();
    for (const PolishRound& round : result_.rounds)
      if (round.accepted) best = &round;
    result_.parameters = best->parameters;
    result_.orientation = best->orientation;
    const auto chosen = model_.modulus_for(best_.simulated.size() > 0 ? best_.simulated : no_values());
    result_.material = chosen.material;
    result_.youngs_modulus = chosen.modulus;
    result_.stress_factor = chosen.factor;
    result_.simulated = model_.split_by_target(at_modulus(best_.simulated, chosen.factor));
    result_.model = model_.split_by_target(at_modulus(best_.model, chosen.factor));
    if (std::isfinite(best_.deviation)) result_.target_error = best_.deviation;
    result_.targets = model_.targets();
    for (SampledTarget& target : result_.targets) target.samples.orientation = result_.orientation;
    return result_;
  }

  PolishStop improve(SimulatedDesign trial) {
    while (true) {
      if (std::isfinite(trial.deviation)) {
        if (const auto termination = descend(trial)) return *termination;
      }
      bool found = false;
      while (!found) {
        if (const auto termination = check_termination()) return *termination;
        // A descent from another minimum takes many rounds. The rest of the rounds is for the survey.
        const auto rounds = static_cast<double>(result_.rounds.size());
        const bool may_start_elsewhere =
            rounds <= starts_fraction * options_.max_rounds || !std::isfinite(best_.deviation);
        if (const auto start = may_start_elsewhere ? new_start() : std::nullopt) {
          trial = simulate_round(Proposal::new_search, *start, model_.parameters_at(*start));
          found = std::isfinite(trial.deviation);
        } else if (const auto point = next_survey_point()) {
          // A design that does not improve still extends the field of corrections, with which the next point is chosen.
          const double before = best_.deviation;
          trial = simulate_round(Proposal::survey, *point, model_.parameters_at(*point));
          found = trial.deviation < before;
          unsuccessful_surveys_ = found ? 0 : unsuccessful_surveys_ + 1;
        } else {
          return PolishStop::no_improvement;
        }
      }
    }
  }

  std::optional<PolishStop> check_termination() const {
    if (best_.deviation <= options_.tolerance) return PolishStop::reached;
    if (model_.width().size() == 0) return PolishStop::no_improvement;
    if (static_cast<int>(result_.rounds.size()) > options_.max_rounds) return PolishStop::round_limit;
    if (seconds_since(start_) + longest_round_ > options_.max_seconds) return PolishStop::time_limit;
    return std::nullopt;
  }

  /// Improves the design until a limit of the polish is reached, or returns none if this descent ends.
  std::optional<PolishStop> descend(const SimulatedDesign& from) {
    Descent descent;
    descent.best = from;
    descent.slope = Eigen::MatrixXd::Zero(from.simulated.size(), model_.width().size());
    begin_allotment(descent);
    while (true) {
      if (const auto termination = check_termination()) return termination;
      if (allotment_is_spent(descent)) {
        if (descent.best.deviation > max_remaining_fraction * descent.deviation_at_allotment) return std::nullopt;
        begin_allotment(descent);
      }
      const CorrectedModel::Step step =
          model_.trust_region_step(correction_at_best(descent), descent.radius, execution_.cancellation);
      const bool promising =
          descent.radius >= min_radius && step.predicted < (1 - min_predicted_reduction) * descent.best.deviation;
      if (promising && descent.rejected < (descent.probed ? max_rejected_steps_after_probes : max_rejected_steps)) {
        try_step(descent, step);
        continue;
      }
      if (descent.probed || descent.best.deviation > max_remaining_fraction * descent.deviation_at_probes)
        return std::nullopt;
      descent.probed = true;
      if (const auto termination = probe(descent, step.x - descent.best.x)) return termination;
    }
  }

  void begin_allotment(Descent& descent) const {
    descent.allotment_begin = result_.rounds.size();
    descent.deviation_at_allotment = descent.best.deviation;
  }

  /// A descent spends at most about half of all rounds before its progress is checked, so that other starts remain
  /// possible.
  bool allotment_is_spent(const Descent& descent) const {
    const auto spent = static_cast<int>(result_.rounds.size() - descent.allotment_begin);
    return spent > std::max(min_allotment, options_.max_rounds / 2);
  }

  void try_step(Descent& descent, const CorrectedModel::Step& step) {
    const SimulatedDesign trial = simulate_round(Proposal::step, step.x, model_.parameters_at(step.x));
    const Eigen::VectorXd displacement = trial.x - descent.best.x;
    const bool improves = trial.deviation < descent.best.deviation;
    const double actual_reduction = descent.best.deviation - trial.deviation;
    if (std::isfinite(trial.deviation)) update_slope(descent, trial);
    const double length = displacement.cwiseAbs().maxCoeff();
    const bool trusted =
        improves && actual_reduction >= min_reduction_ratio * (descent.best.deviation - step.predicted);
    descent.radius = trusted ? std::min(max_radius, std::max(descent.radius, 2 * length)) : length / 2;
    descent.rejected = improves ? 0 : descent.rejected + 1;
    if (improves) {
      descent.best = trial;
      descent.probed = false;
    }
  }

  /// Broyden's update: afterwards the correction is exact at the best design and at `trial`.
  static void update_slope(Descent& descent, const SimulatedDesign& trial) {
    const Eigen::VectorXd displacement = trial.x - descent.best.x;
    const Eigen::VectorXd secant_error = trial.correction() - descent.best.correction() - descent.slope * displacement;
    descent.slope += secant_error * displacement.transpose() / displacement.squaredNorm();
  }

  /// Measures the slope of the correction by finite differences along the right singular vectors of the corrected
  /// network's Jacobian. The length of each step is chosen so that the profile changes by probe_change_ratio times its
  /// deviation. Steps in stiff directions are then short enough to stay in the same valley, and those in soft
  /// directions are long enough to exceed the simulation's noise.
  std::optional<PolishStop> probe(Descent& descent, const Eigen::VectorXd& preferred_direction) {
    descent.deviation_at_probes = descent.best.deviation;
    TargetResiduals residuals = model_.residuals(correction_at_best(descent));
    Eigen::VectorXd r;
    Eigen::MatrixXd jacobian;
    if (!residuals.residuals(model_.free_parameters(descent.best.x), r)) return std::nullopt;
    residuals.jacobian(jacobian);
    jacobian *= model_.width().asDiagonal();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeFullV);
    const SimulatedDesign from = descent.best;
    SimulatedDesign nearest = from;
    for (Eigen::Index k = 0; k < model_.width().size(); ++k) {
      if (const auto termination = check_termination()) return termination;
      const double sensitivity = k < svd.singularValues().size() ? svd.singularValues()[k] : 0;
      const double length = std::clamp(probe_change_ratio * from.deviation / std::max(sensitivity, 1e-300),
                                       min_probe_length, max_probe_length);
      Eigen::VectorXd probe_step = svd.matrixV().col(k) * length;
      if (probe_step.dot(preferred_direction) < 0) probe_step = -probe_step;
      if (!within_bounds(from.x + probe_step) && within_bounds(from.x - probe_step)) probe_step = -probe_step;
      const Eigen::VectorXd x = (from.x + probe_step).cwiseMax(0).cwiseMin(1);
      if ((x - from.x).norm() < min_probe_length / 2) continue;
      const SimulatedDesign trial = simulate_round(Proposal::probe, x, model_.parameters_at(x));
      if (!std::isfinite(trial.deviation)) continue;
      // If the bounds have shortened the step, it is not along the singular vector alone. The update is still valid.
      update_slope(descent, trial);
      if (trial.deviation < nearest.deviation) nearest = trial;
    }
    descent.best = nearest;
    descent.radius = radius_after_probes;
    descent.rejected = 0;
    return std::nullopt;
  }

  static bool within_bounds(const Eigen::VectorXd& x) { return x.minCoeff() >= 0 && x.maxCoeff() <= 1; }

  /// The next start that was not simulated yet: a minimum of the corrected network elsewhere in the box, in the order
  /// of increasing deviation. None if no start is left.
  std::optional<Eigen::VectorXd> new_start() {
    if (!other_starts_) other_starts_ = other_minima();
    while (!other_starts_->empty()) {
      const Eigen::VectorXd x = std::move(other_starts_->front());
      other_starts_->erase(other_starts_->begin());
      if (distance_to_nearest(x, tried_) >= same_design_distance) return x;
    }
    return std::nullopt;
  }

  std::vector<Eigen::VectorXd> other_minima() const {
    struct Minimum {
      Eigen::VectorXd x;
      double deviation;
    };
    std::vector<Minimum> minima;
    RandomStream random("polish", 1);
    for (int i = 0; i <= random_starts && seconds_since(start_) < options_.max_seconds; ++i) {
      DesignProblem shifted = problem_;
      shifted.initial.reset();
      if (std::isfinite(best_.deviation)) {
        shifted.corrections = model_.split_by_target(best_.correction());
        const double modulus = model_.modulus_for(best_.simulated).modulus;
        if (!shifted.moduli.empty()) shifted.moduli = {{modulus, modulus}};
      }
      // The first search covers the whole box. The others start from a random point.
      if (i > 0) {
        Eigen::VectorXd x(model_.width().size());
        for (double& coordinate : x) coordinate = random.uniform(0, 1);
        const Eigen::VectorXd all = model_.parameters_at(x);
        shifted.initial = family_part(all);
        shifted.initial_orientation = orientation_in(all);
      }
      DesignOptions options;
      options.envelope = Switch::off;
      options.trust = Switch::off;  // the simulation decides
      options.multi_start = i > 0 ? Switch::off : Switch::automatic;
      options.equilibrium_tolerance = model_.search_tolerance();
      try {
        const Design found = find_design(space_, shifted, options, Execution{execution_.cancellation});
        const Eigen::VectorXd x = model_.normalized(FreeParameters::all_of(found.parameters, found.orientation));
        const double deviation = found.error.relative_rms;
        const auto same = std::find_if(minima.begin(), minima.end(), [&](const Minimum& other) {
          return (x - other.x).cwiseAbs().maxCoeff() < same_minimum_distance;
        });
        if (same == minima.end()) {
          minima.push_back({x, deviation});
        } else if (deviation < same->deviation) {
          *same = {x, deviation};
        }
      } catch (const Error& error) {
        if (error.code() != "design.no_equilibrium" && error.code() != "design.beyond_limits") throw;
      }
    }
    std::stable_sort(minima.begin(), minima.end(),
                     [](const Minimum& a, const Minimum& b) { return a.deviation < b.deviation; });
    std::vector<Eigen::VectorXd> result;
    for (Minimum& minimum : minima)
      if (minimum.deviation < max_start_deviation && static_cast<int>(result.size()) < max_other_starts)
        result.push_back(std::move(minimum.x));
    return result;
  }

  Eigen::VectorXd no_values() const {
    return Eigen::VectorXd::Constant(model_.samples(), std::numeric_limits<double>::quiet_NaN());
  }
  /// `values` is empty if nothing could be simulated.
  Eigen::VectorXd at_modulus(const Eigen::VectorXd& values, double factor) const {
    return values.size() > 0 ? scaled(model_.targets(), values, factor) : values;
  }

  static Eigen::VectorXd joined(const std::vector<Eigen::VectorXd>& parts) {
    Eigen::Index n = 0;
    for (const Eigen::VectorXd& part : parts) n += part.size();
    Eigen::VectorXd values(n);
    n = 0;
    for (const Eigen::VectorXd& part : parts) {
      values.segment(n, part.size()) = part;
      n += part.size();
    }
    return values;
  }

  /// Simulates the structure of the parameters, and keeps the design if it is the best so far.
  SimulatedDesign simulate_round(Proposal proposal, const Eigen::VectorXd& x, const Eigen::VectorXd& parameters) {
    const auto begin = Clock::now();
    PolishRound round;
    round.proposal = proposal;
    round.parameters = family_part(parameters);
    round.orientation = orientation_in(parameters);
    SimulatedDesign trial;
    trial.x = x;
    simulate(parameters, trial, round);
    if (std::isfinite(trial.deviation)) round.target_error = trial.deviation;
    round.accepted = result_.rounds.empty() ? round.target_error.has_value() : trial.deviation < best_.deviation;
    if (!round.accepted && round.reason.empty()) round.reason = "Its simulated deviation is not less.";
    tried_.push_back(x);
    if (std::isfinite(trial.deviation)) observations_.push_back({x, trial.correction()});
    // The design of the search is the answer until another one is accepted, even if its simulation failed.
    if (round.accepted || result_.rounds.empty()) best_ = trial;
    record(std::move(round), begin);
    return trial;
  }

  /// Simulates the parameters and writes the result into `trial`. If the design has to be refused, the reason goes into
  /// the round.
  void simulate(const Eigen::VectorXd& parameters, SimulatedDesign& trial, PolishRound& round) {
    const auto begin = Clock::now();
    try {
      // The design of the search is simulated even if it violates the limits.
      if (round.proposal != Proposal::search) round.reason = model_.excess_at(parameters);
      if (!round.reason.empty()) return;
      Eigen::VectorXd simulated(model_.samples());
      Eigen::Index at = 0;
      const Execution inner{execution_.cancellation, nullptr, execution_.cost};
      for (const SampledTarget& target : model_.targets()) {
        simulated.segment(at, target.y.size()) =
            simulate_(round.parameters, oriented(target.samples, parameters), inner);
        at += target.y.size();
      }
      trial.deviation = model_.deviation(simulated);
      trial.simulated = std::move(simulated);
      trial.model = model_.at(parameters).values;
      if (!std::isfinite(trial.deviation)) round.reason = "The simulation does not reach every sample.";
      if (!trial.model.allFinite()) {
        trial.deviation = result_.rounds.empty() ? trial.deviation : infinite;
        round.reason = "The network has no equilibrium at every sample.";
      }
    } catch (const Error& error) {
      if (!error.code().starts_with("tiling.") && !error.code().starts_with("simulation.")) {
        if (error.code() == "job.deadline_exceeded") {
          round.reason = "The deadline passed before the simulation had ended.";
          record(std::move(round), begin);
        }
        throw;
      }
      round.reason = error.what();
    }
  }

  void record(PolishRound round, Clock::time_point begin) {
    round.seconds = seconds_since(begin);
    longest_round_ = std::max(longest_round_, round.seconds);
    if (execution_.progress) {
      const double fraction = static_cast<double>(result_.rounds.size() + 1) / (options_.max_rounds + 1);
      execution_.progress->report(std::min(fraction, 0.99), "polish");
    }
    result_.rounds.push_back(std::move(round));
    if (on_round_) on_round_(result_.rounds.back());
  }

  /// The next design of the survey. None after too many without improvement, or if no lower confidence bound is below
  /// the best deviation.
  std::optional<Eigen::VectorXd> next_survey_point() {
    if (unsuccessful_surveys_ >= max_unsuccessful_surveys || observations_.empty()) return std::nullopt;
    if (!survey_) survey_.emplace(model_, observations_, tried_, execution_.cancellation);
    return survey_->next(observations_, tried_, (1 - min_predicted_reduction) * best_.deviation);
  }

  /// The correction around the best design of a descent, in normalized parameters.
  static Correction correction_at_best(const Descent& descent) {
    return {descent.best.correction(), descent.slope, descent.best.x};
  }

  const DesignSpace& space_;
  const DesignProblem problem_;
  const SimulateProfile& simulate_;
  const PolishOptions& options_;
  const Execution& execution_;
  const OnPolishRound& on_round_;
  const CorrectedModel model_;
  Polished result_;
  SimulatedDesign best_;
  std::vector<Survey::Observation> observations_;  ///< all simulations that reached every sample
  std::vector<Eigen::VectorXd> tried_;             ///< normalized parameters of each round
  int unsuccessful_surveys_ = 0;                   ///< consecutive surveyed designs without improvement
  std::optional<Survey> survey_;                   ///< none until it is needed
  /// Starts that are left; none until they are searched for.
  std::optional<std::vector<Eigen::VectorXd>> other_starts_;
  Clock::time_point start_;
  double longest_round_ = 0;
};

}  // namespace

std::string_view to_string(PolishStop termination) {
  switch (termination) {
    case PolishStop::reached:
      return "reached";
    case PolishStop::no_improvement:
      return "no_improvement";
    case PolishStop::round_limit:
      return "round_limit";
    case PolishStop::time_limit:
      return "time_limit";
    case PolishStop::deadline:
      return "deadline";
    case PolishStop::not_simulated:
      return "not_simulated";
  }
  return "";
}

std::string_view to_string(Proposal proposal) {
  switch (proposal) {
    case Proposal::search:
      return "search";
    case Proposal::step:
      return "step";
    case Proposal::probe:
      return "probe";
    case Proposal::new_search:
      return "new_search";
    case Proposal::survey:
      return "survey";
  }
  return "";
}

Polished polish(const DesignSpace& space, const DesignProblem& problem, const OrientedParameters& found,
                const SimulateProfile& simulate, const PolishOptions& options, const Execution& execution,
                const OnPolishRound& on_round) {
  return Polish(space, problem, simulate, options, execution, on_round)
      .run(FreeParameters::all_of(found.parameters, found.orientation));
}

Polished polish(const DesignSpace& space, const DesignProblem& problem, const Polished& before,
                const SimulateProfile& simulate, const PolishOptions& options, const Execution& execution,
                const OnPolishRound& on_round) {
  return Polish(space, problem, simulate, options, execution, on_round).resume(before);
}

Design design_at(const DesignSpace& space, const DesignProblem& problem, const OrientedParameters& at,
                 const Design& found, const DesignOptions& options) {
  DesignProblem all_fixed = problem;
  all_fixed.orientation = {at.orientation, at.orientation};
  all_fixed.initial.reset();
  all_fixed.fixed.clear();
  for (const double value : at.parameters) all_fixed.fixed.emplace_back(value);
  DesignOptions plain = options;
  plain.envelope = Switch::off;
  Design design = find_design(space, all_fixed, plain);
  design.space = found.space;
  design.iterations = found.iterations;
  design.starts = found.starts;
  design.stopped = found.stopped;
  design.evaluations += found.evaluations;
  for (std::size_t t = 0; t < design.profiles.size(); ++t) {
    DesignProfile& profile = design.profiles[t];
    const DesignProfile& before = found.profiles[t];
    profile.initial = before.initial;
    if (before.lowest.size() == 0) continue;
    profile.lowest = before.lowest.cwiseMin(profile.achieved);
    profile.highest = before.highest.cwiseMax(profile.achieved);
  }
  return design;
}

}  // namespace supple::design
