#pragma once

#include "supple/base/execution.h"
#include "supple/design/verified_designs.h"

// Functions for one search with one model. Programs with several searches keep the model's evaluator and its
// candidates, which hold what searches have in common, and call the functions that take a DesignSpace.
namespace supple::design {

/// Finds the design of a model's family that follows the targets best, among structures that can be built. Throws what
/// the function of this name throws that takes a DesignSpace.
Design find_design(const neural::Model& model, const DesignProblem& problem, const DesignOptions& options = {},
                   const Execution& execution = {});

/// The same, and then simulates the design and corrects it until its simulated response follows the targets: the first
/// design of `search_designs`. `plan` says what is simulated. Throws what `search_designs` throws.
VerifiedDesigns find_verified_design(const neural::Model& model, const DesignProblem& problem,
                                     const VerificationPlan& plan = {}, const Execution& execution = {});

}  // namespace supple::design
