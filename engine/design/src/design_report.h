#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/design/inverse_design.h"
#include "supple/design/polish.h"

namespace supple::design {

/// Sentences about a design: its deviation from a target that it does not reach, whether the target nevertheless lies
/// within the envelope, what is at its limits (`Design::at_limits`), and how many samples the model is not trusted at.
/// Empty if none of these applies.
std::string message_about(const Design& design, const neural::Model& model);

/// Sentences about the free parameters of a problem that are at their bounds in its design, and about a modulus at the
/// end of its range, each after a space: the reasons why no design comes closer, if it misses the target.
std::string sentences_about_limits(const Design& design, const DesignSpace& space, const DesignProblem& problem);

/// Makes a design the answer of a search that was stopped by the deadline or a limit of memory: `stopped`, and a
/// sentence after the others of its message.
void report_stop(Design& design, StopReason reason);

/// The reason of the stop that ended a polish; `none` if it ended by itself.
StopReason reason_of(PolishTermination stopped);

/// Sets whether the target is reached by the simulation instead of the model, and replaces the model's message by what
/// the simulation found. It stays empty if both reach the target. If the simulation does not reach every sample, the
/// message says so before what the model found, and nothing else changes. The same holds if it was stopped before its
/// end.
void report_simulation(Design& design, const Polished& polished);

/// Fills a profile's `lowest` and `highest`: the extremes of the candidates' profiles `y` (one column each) at the
/// samples of `coarse`, interpolated to all samples, and of `achieved`. They stay empty if no candidate has any value.
void fill_envelope(DesignProfile& profile, const SampledTarget& coarse, const Eigen::MatrixXd& y);

}  // namespace supple::design
