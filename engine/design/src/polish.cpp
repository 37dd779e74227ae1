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

/// The radius of the trust region as a share of the bounds' widths: at the start, at most, and where the search ends.
constexpr double first_radius = 0.1;
constexpr double max_radius = 0.5;
/// The radius after probes. Probes find the slopes of places where the response changes fast, and longer steps would
/// leave these places again.
constexpr double probed_radius = 0.01;
constexpr double min_radius = 2e-4;
/// A step that promises to lessen the deviation by a smaller share of itself is not worth a simulation.
constexpr double min_promise = 0.02;
/// A step is trusted where it lessens the deviation by at least this share of what it promised.
constexpr double trusted_share = 0.5;
/// If this many steps in a row were not accepted, probes are worth their simulations.
constexpr int patience = 2;
/// After probes, a start is given up when this many steps in a row were not accepted.
constexpr int probed_patience = 4;
/// Probes change the profile by this multiple of its deviation, within these lengths (as shares of the widths).
constexpr double probed_change = 2;
constexpr double shortest_probe = 1e-3;
constexpr double longest_probe = 0.05;
/// Where steps after probes, or all rounds of a turn, did not bring the deviation below this share, others would not.
constexpr double slow_share = 0.7;
/// Each start has at least this many rounds.
constexpr int min_rounds = 8;
/// Other starts are found by searches from this many random places, and only the best few of these ends are kept.
constexpr int random_starts = 16;
constexpr int max_kept_starts = 3;
/// A start from which the network deviates by more is not worth its simulations.
constexpr double worst_start = 0.1;
/// Designs nearer (as a share of the widths) were simulated already; minima nearer are one.
constexpr double same_design = 1e-3;
constexpr double another_design = 0.02;
/// After so many surveyed designs in a row that were not better the others are not simulated.
constexpr int survey_patience = 8;
/// Rounds after which no other minimum is begun with, as a share of all.
constexpr double starts_share = 0.5;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

/// What is known of one structure.
struct Known {
  Eigen::VectorXd x;          ///< free parameters, as shares of the bounds' widths
  Eigen::VectorXd simulated;  ///< all samples of all targets
  Eigen::VectorXd model;
  double deviation = infinite;
  Eigen::VectorXd correction() const { return simulated - model; }
};

/// How many of a target's samples are simulated: evenly spaced ones of its own where half of `limit` can be had so.
int samples_to_simulate(const Target& target, int limit) {
  const bool over_strain = target.task == Task::stress_strain;
  const int of_target = static_cast<int>(sample_target(target).y.size());
  if (of_target <= limit) return of_target;
  // Strains include both ends, directions are a period.
  const int intervals = over_strain ? of_target - 1 : of_target;
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
    return finished([&] {
      best_.x = model_.shares(parameters);
      return improve(simulate_round(Proposal::search, best_.x, parameters));
    });
  }

  Polished go_on(const Polished& before) {
    return finished([&] {
      result_.rounds = before.rounds;
      for (const PolishRound& round : before.rounds) {
        longest_ = std::max(longest_, round.seconds);
        tried_.push_back(model_.shares(FreeParameters::all_of(round.parameters, round.orientation)));
      }
      best_.x = model_.shares(FreeParameters::all_of(before.parameters, before.orientation));
      best_.simulated = scaled(model_.targets(), joined(before.simulated), 1 / before.stress_factor);
      best_.model = scaled(model_.targets(), joined(before.model), 1 / before.stress_factor);
      best_.deviation = before.target_error.value_or(infinite);
      if (std::isfinite(best_.deviation)) known_.push_back({best_.x, best_.correction()});
      return improve(best_);
    });
  }

 private:
  /// A descent from one start: its best design and what is known around it.
  struct Descent {
    Known best;
    Eigen::MatrixXd slope;  ///< of the correction, by shares of the bounds' widths
    double radius = first_radius;
    int rejected = 0;             ///< steps in a row
    bool probed = false;          ///< around the best design
    double probed_at = infinite;  ///< deviation at the last probes
    std::size_t first_round = 0;  ///< of its present turn
    double deviation_at_first_round = infinite;
  };

  template <class Work>
  Polished finished(const Work& work) {
    start_ = Clock::now();
    try {
      result_.stopped = work();
    } catch (const Error& error) {
      if (error.code() != "job.deadline_exceeded") throw;
      result_.stopped = PolishStop::deadline;
    }
    if (result_.stopped != PolishStop::deadline && !std::isfinite(best_.deviation))
      result_.stopped = PolishStop::not_simulated;
    // These are the parameters that were simulated. Converting them to shares of the widths and back would round them.
    const PolishRound* best = &result_.rounds.front();
    for (const PolishRound& round : result_.rounds)
      if (round.accepted) best = &round;
    result_.parameters = best->parameters;
    result_.orientation = best->orientation;
    const auto chosen = model_.modulus_for(best_.simulated.size() > 0 ? best_.simulated : no_values());
    result_.material = chosen.material;
    result_.youngs_modulus = chosen.modulus;
    result_.stress_factor = chosen.factor;
    result_.simulated = model_.parts_of(of_modulus(best_.simulated, chosen.factor));
    result_.model = model_.parts_of(of_modulus(best_.model, chosen.factor));
    if (std::isfinite(best_.deviation)) result_.target_error = best_.deviation;
    result_.targets = model_.targets();
    for (SampledTarget& target : result_.targets) target.samples.orientation = result_.orientation;
    return result_;
  }

  PolishStop improve(Known known) {
    while (true) {
      if (std::isfinite(known.deviation)) {
        if (const auto stop = descend(known)) return *stop;
      }
      bool found = false;
      while (!found) {
        if (const auto stop = stop_reached()) return *stop;
        // Other minima, whose descents take many rounds, leave a share of them to the survey.
        const auto rounds = static_cast<double>(result_.rounds.size());
        const bool starts_left = rounds <= starts_share * options_.max_rounds || !std::isfinite(best_.deviation);
        if (const auto start = starts_left ? new_start() : std::nullopt) {
          known = simulate_round(Proposal::new_search, *start, model_.parameters_at(*start));
          found = std::isfinite(known.deviation);
        } else if (const auto place = surveyed()) {
          // What is no better has taught the field of corrections, and the next place makes use of it.
          const double before = best_.deviation;
          known = simulate_round(Proposal::survey, *place, model_.parameters_at(*place));
          found = known.deviation < before;
          fruitless_ = found ? 0 : fruitless_ + 1;
        } else {
          return PolishStop::no_improvement;
        }
      }
    }
  }

  std::optional<PolishStop> stop_reached() const {
    if (best_.deviation <= options_.tolerance) return PolishStop::reached;
    if (model_.width().size() == 0) return PolishStop::no_improvement;
    if (static_cast<int>(result_.rounds.size()) > options_.max_rounds) return PolishStop::round_limit;
    if (seconds_since(start_) + longest_ > options_.max_seconds) return PolishStop::time_limit;
    return std::nullopt;
  }

  /// Nothing where this start leads no further.
  std::optional<PolishStop> descend(const Known& from) {
    Descent descent;
    descent.best = from;
    descent.slope = Eigen::MatrixXd::Zero(from.simulated.size(), model_.width().size());
    begin_turn(descent);
    while (true) {
      if (const auto stop = stop_reached()) return stop;
      if (turn_is_over(descent)) {
        if (descent.best.deviation > slow_share * descent.deviation_at_first_round) return std::nullopt;
        begin_turn(descent);
      }
      const CorrectedModel::Step step =
          model_.step_within(around_best(descent), descent.radius, execution_.cancellation);
      const bool promising = descent.radius >= min_radius && step.promised < (1 - min_promise) * descent.best.deviation;
      if (promising && descent.rejected < (descent.probed ? probed_patience : patience)) {
        try_step(descent, step);
        continue;
      }
      if (descent.probed || descent.best.deviation > slow_share * descent.probed_at) return std::nullopt;
      descent.probed = true;
      if (const auto stop = probe(descent, step.x - descent.best.x)) return stop;
    }
  }

  void begin_turn(Descent& descent) const {
    descent.first_round = result_.rounds.size();
    descent.deviation_at_first_round = descent.best.deviation;
  }

  /// Half of all rounds are kept for other starts, unless those of this turn have brought it far.
  bool turn_is_over(const Descent& descent) const {
    const auto spent = static_cast<int>(result_.rounds.size() - descent.first_round);
    return spent > std::max(min_rounds, options_.max_rounds / 2);
  }

  void try_step(Descent& descent, const CorrectedModel::Step& step) {
    const Known known = simulate_round(Proposal::step, step.x, model_.parameters_at(step.x));
    const Eigen::VectorXd moved = known.x - descent.best.x;
    const bool less = known.deviation < descent.best.deviation;
    const double gained = descent.best.deviation - known.deviation;
    if (std::isfinite(known.deviation)) learn(descent, known);
    const double length = moved.cwiseAbs().maxCoeff();
    const bool trusted = less && gained >= trusted_share * (descent.best.deviation - step.promised);
    descent.radius = trusted ? std::min(max_radius, std::max(descent.radius, 2 * length)) : length / 2;
    descent.rejected = less ? 0 : descent.rejected + 1;
    if (less) {
      descent.best = known;
      descent.probed = false;
    }
  }

  /// The secant: the corrected model then has the simulation's values at the best design and at `known`.
  static void learn(Descent& descent, const Known& known) {
    const Eigen::VectorXd moved = known.x - descent.best.x;
    const Eigen::VectorXd missed = known.correction() - descent.best.correction() - descent.slope * moved;
    descent.slope += missed * moved.transpose() / moved.squaredNorm();
  }

  /// Learns the slope of the correction by differences: moves along the right singular vectors of the corrected
  /// network's Jacobian, each so long that the profile changes by about as much as it deviates. Then stiff directions
  /// are not left for another landscape, and what valleys change stands out from the simulation's own noise.
  std::optional<PolishStop> probe(Descent& descent, const Eigen::VectorXd& towards) {
    descent.probed_at = descent.best.deviation;
    TargetResiduals residuals = model_.residuals(around_best(descent));
    Eigen::VectorXd r;
    Eigen::MatrixXd jacobian;
    if (!residuals.residuals(model_.free_parameters(descent.best.x), r)) return std::nullopt;
    residuals.jacobian(jacobian);
    jacobian *= model_.width().asDiagonal();
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(jacobian, Eigen::ComputeFullV);
    const Known from = descent.best;
    Known least = from;
    for (Eigen::Index k = 0; k < model_.width().size(); ++k) {
      if (const auto stop = stop_reached()) return stop;
      const double change = k < svd.singularValues().size() ? svd.singularValues()[k] : 0;
      const double length =
          std::clamp(probed_change * from.deviation / std::max(change, 1e-300), shortest_probe, longest_probe);
      Eigen::VectorXd move = svd.matrixV().col(k) * length;
      if (move.dot(towards) < 0) move = -move;
      if (!within_bounds(from.x + move) && within_bounds(from.x - move)) move = -move;
      const Eigen::VectorXd x = (from.x + move).cwiseMax(0).cwiseMin(1);
      if ((x - from.x).norm() < shortest_probe / 2) continue;
      const Known known = simulate_round(Proposal::probe, x, model_.parameters_at(x));
      if (!std::isfinite(known.deviation)) continue;
      // A move that the bounds have bent is not along the singular vector alone: its secant holds all the same.
      learn(descent, known);
      if (known.deviation < least.deviation) least = known;
    }
    descent.best = least;
    descent.radius = probed_radius;
    descent.rejected = 0;
    return std::nullopt;
  }

  static bool within_bounds(const Eigen::VectorXd& x) { return x.minCoeff() >= 0 && x.maxCoeff() <= 1; }

  /// The next design to start from that was not simulated yet: where the corrected network's search leads from other
  /// places of the box, the least deviation first. Nothing where there are no more.
  std::optional<Eigen::VectorXd> new_start() {
    if (!starts_) starts_ = other_minima();
    while (!starts_->empty()) {
      const Eigen::VectorXd x = std::move(starts_->front());
      starts_->erase(starts_->begin());
      if (distance_to_nearest(x, tried_) >= same_design) return x;
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
        shifted.corrections = model_.parts_of(best_.correction());
        const double modulus = model_.modulus_for(best_.simulated).modulus;
        if (!shifted.moduli.empty()) shifted.moduli = {{modulus, modulus}};
      }
      // The first is a search of the whole box, the others begin anywhere.
      if (i > 0) {
        Eigen::VectorXd x(model_.width().size());
        for (double& share : x) share = random.uniform(0, 1);
        const Eigen::VectorXd all = model_.parameters_at(x);
        shifted.initial = family_part(all);
        shifted.initial_orientation = orientation_in(all);
      }
      DesignOptions options;
      options.envelope = Switch::off;
      options.trust = Switch::off;  // the simulation is to judge
      options.multi_start = i > 0 ? Switch::off : Switch::automatic;
      options.equilibrium_tolerance = model_.search_tolerance();
      try {
        const Design found = find_design(space_, shifted, options, Execution{execution_.cancellation});
        const Eigen::VectorXd x = model_.shares(FreeParameters::all_of(found.parameters, found.orientation));
        const double deviation = found.error.relative_rms;
        const auto same = std::find_if(minima.begin(), minima.end(), [&](const Minimum& other) {
          return (x - other.x).cwiseAbs().maxCoeff() < another_design;
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
      if (minimum.deviation < worst_start && static_cast<int>(result.size()) < max_kept_starts)
        result.push_back(std::move(minimum.x));
    return result;
  }

  Eigen::VectorXd no_values() const {
    return Eigen::VectorXd::Constant(model_.samples(), std::numeric_limits<double>::quiet_NaN());
  }
  /// There are no values where nothing could be simulated.
  Eigen::VectorXd of_modulus(const Eigen::VectorXd& values, double factor) const {
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

  /// Simulates the structure of the parameters and keeps it if it is the best.
  Known simulate_round(Proposal proposal, const Eigen::VectorXd& x, const Eigen::VectorXd& parameters) {
    const auto begin = Clock::now();
    PolishRound round;
    round.proposal = proposal;
    round.parameters = family_part(parameters);
    round.orientation = orientation_in(parameters);
    Known known;
    known.x = x;
    simulate(parameters, known, round);
    if (std::isfinite(known.deviation)) round.target_error = known.deviation;
    round.accepted = result_.rounds.empty() ? round.target_error.has_value() : known.deviation < best_.deviation;
    if (!round.accepted && round.reason.empty()) round.reason = "Its simulated deviation is not less.";
    tried_.push_back(x);
    if (std::isfinite(known.deviation)) known_.push_back({x, known.correction()});
    // What the search found is told even where its simulation does not get everywhere.
    if (round.accepted || result_.rounds.empty()) best_ = known;
    record(std::move(round), begin);
    return known;
  }

  /// Simulates parameters; what they do goes into `known`, and why that is no use into the round.
  void simulate(const Eigen::VectorXd& parameters, Known& known, PolishRound& round) {
    const auto begin = Clock::now();
    try {
      // What the search has found is simulated in any case.
      if (round.proposal != Proposal::search) round.reason = model_.excess_at(parameters);
      if (!round.reason.empty()) return;
      Eigen::VectorXd simulated(model_.samples());
      Eigen::Index at = 0;
      const Execution inner{execution_.cancellation, nullptr, execution_.cost};
      for (const SampledTarget& target : model_.targets()) {
        simulated.segment(at, target.y.size()) = simulate_(round.parameters, turned(target.samples, parameters), inner);
        at += target.y.size();
      }
      known.deviation = model_.deviation(simulated);
      known.simulated = std::move(simulated);
      known.model = model_.at(parameters).values;
      if (!std::isfinite(known.deviation)) round.reason = "The simulation does not reach every sample.";
      if (!known.model.allFinite()) {
        known.deviation = result_.rounds.empty() ? known.deviation : infinite;
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
    longest_ = std::max(longest_, round.seconds);
    if (execution_.progress) {
      const double share = static_cast<double>(result_.rounds.size() + 1) / (options_.max_rounds + 1);
      execution_.progress->report(std::min(share, 0.99), "polish");
    }
    result_.rounds.push_back(std::move(round));
    if (on_round_) on_round_(result_.rounds.back());
  }

  /// The next place of the survey; nothing after too many that were not better, or where none may be by far.
  std::optional<Eigen::VectorXd> surveyed() {
    if (fruitless_ >= survey_patience || known_.empty()) return std::nullopt;
    if (!survey_) survey_.emplace(model_, known_, tried_, execution_.cancellation);
    return survey_->next(known_, tried_, (1 - min_promise) * best_.deviation);
  }

  /// What is added to the network around a design, everything by shares of the widths.
  static Correction around_best(const Descent& descent) {
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
  Known best_;
  std::vector<Survey::Known> known_;                    ///< all whose simulation reached every sample
  std::vector<Eigen::VectorXd> tried_;                  ///< of each round
  int fruitless_ = 0;                                   ///< surveyed designs in a row that were not better
  std::optional<Survey> survey_;                        ///< none before it was needed
  std::optional<std::vector<Eigen::VectorXd>> starts_;  ///< that are left; none before they were looked for
  Clock::time_point start_;
  double longest_ = 0;
};

}  // namespace

std::string_view to_string(PolishStop stop) {
  switch (stop) {
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
  return Polish(space, problem, simulate, options, execution, on_round).go_on(before);
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
