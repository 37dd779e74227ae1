#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "supple/design/inverse_design.h"
#include "supple/design/polish.h"

namespace supple::design {

/// In sentences: how far a design that does not reach its target is from it, which of the `free` parameters are at
/// their bounds, and how many samples lie outside of what the model was trained on. Empty where there is nothing to
/// say.
std::string message_about(const Design& design, const neural::Model& model, const std::vector<Eigen::Index>& free);

/// Gives the simulation the last word on whether the target is reached, and says so in the design's message. Nothing
/// changes where it did not get to every sample.
void tell_of_simulation(Design& design, const Polished& polished);

/// Fills a profile's `lowest` and `highest`: the extremes of the candidates' profiles `y`, one column each, at the
/// samples of `coarse`, interpolated to all samples, and the profile itself. Left empty where no candidate has any
/// value.
void bound_profile(DesignProfile& profile, const SampledTarget& coarse, const Eigen::MatrixXd& y);

}  // namespace supple::design
