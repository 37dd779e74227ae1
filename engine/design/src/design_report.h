#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "supple/design/inverse_design.h"
#include "supple/design/polish.h"

namespace supple::design {

/// Sentences about a design: its deviation from a target that it does not reach, whether the target nevertheless lies
/// within the envelope, which of the `free` parameters are at their bounds, and how many samples the model is not
/// trusted at. Empty if none of these applies.
std::string message_about(const Design& design, const neural::Model& model, const std::vector<Eigen::Index>& free);

/// Sentences about the `free` parameters that are at their bounds, each after a space. Empty if the model reaches the
/// target.
std::string message_about_bounds(const Design& design, const neural::Model& model,
                                 const std::vector<Eigen::Index>& free);

/// Sets whether the target is reached by the simulation instead of the model, and replaces the model's message by what
/// the simulation found. It stays empty if both reach the target. If the simulation does not reach every sample, the
/// message says so before what the model found, and nothing else changes.
void report_simulation(Design& design, const Polished& polished);

/// Fills a profile's `lowest` and `highest`: the extremes of the candidates' profiles `y` (one column each) at the
/// samples of `coarse`, interpolated to all samples, and of `achieved`. They stay empty if no candidate has any value.
void fill_envelope(DesignProfile& profile, const SampledTarget& coarse, const Eigen::MatrixXd& y);

}  // namespace supple::design
