#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/design/ways_out.h"

namespace supple::design {

/// Young's moduli from soft silicones to rigid plastics, MPa.
inline constexpr Range known_moduli{0.1, 5000};
/// The shortest part of a range of strains that is worth asking for, as a fraction of the range.
inline constexpr double min_range_fraction = 0.25;

/// A design that misses its target, and how it is searched again.
struct Miss {
  const WaysOutSearch& search;
  const Design& design;
  /// Deviation of the design: by the model, or by the simulation if only that one misses. It is infinite if the
  /// simulation does not reach every sample.
  double deviation;
  const Polished* simulated;  ///< the simulation, if only that one misses; otherwise null
  DesignOptions options;
  Execution execution;  ///< without progress and bill
};

using Ways = std::vector<WayOut>;
/// A kind of ways out. It sees those that the kinds before it have found.
using FindWays = Ways (*)(const Miss& miss, const Ways& before);

/// How the deviation of a way out is known, if only the simulation misses the target.
enum class Basis {
  model,            ///< the model alone
  corrected_model,  ///< the model with the error that the simulation has found at the design
  simulation,       ///< the simulated values themselves
};
/// "3.5 % instead of 55 % by the model".
std::string comparison(const Miss& miss, double deviation, Basis basis = Basis::model);
std::string words_for_turn(double angle);
std::string words_for_material(const Miss& miss, double modulus);
/// "Green strains from 0 to 12 %: it is reached up to there".
std::string words_for_range(const Target& target, const Range& range);

WayOut way_to(const Design& design, WayOut::Change change, const DesignProblem& problem);
/// The problem of the design, which starts at the design and keeps its material.
DesignProblem problem_from_design(const Miss& miss);
/// The best design of a problem in the same space; none if there is none.
std::optional<Design> best_design_of(const Miss& miss, const DesignProblem& problem, Switch multi_start);
bool may_turn(const Miss& miss);
/// Whether another modulus changes the response, and the request does not leave the best one open already.
bool may_change_modulus(const Miss& miss);
/// A quarter of a turn to either side, since responses repeat after half a turn.
void leave_orientation_open(const Miss& miss, DesignProblem& problem);
bool is_turned(const Miss& miss, const Design& design);
bool is_other_modulus(const Miss& miss, double youngs_modulus);
/// Whether a way out among these reaches the target.
bool one_suffices(const Ways& ways);
/// The target at those of its samples that lie within a part of its range. The part has the strain zero, or the end
/// next to it, in common with the range, and is this fraction as long.
Target shortened_target(const Target& target, const SampledTarget& whole, double fraction);

/// Ways out for a design of which the model does not know that it misses the target. The modulus and the range follow
/// from the simulated values. The orientation is sought by the model with the error that the simulation has found.
Ways simulated_ways_by_turn(const Miss& miss, const Ways& before);
Ways simulated_ways_by_modulus(const Miss& miss, const Ways& before);
Ways simulated_ways_by_turn_and_modulus(const Miss& miss, const Ways& before);
Ways simulated_ways_by_shortening(const Miss& miss, const Ways& before);

}  // namespace supple::design
