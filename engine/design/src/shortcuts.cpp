#include "supple/design/shortcuts.h"

namespace supple::design {

Design find_design(const neural::Model& model, const DesignProblem& problem, const DesignOptions& options,
                   const Execution& execution) {
  const neural::Evaluator evaluator(model.network);
  const Candidates candidates(model.network);
  return find_design(design_space(model, evaluator, candidates), problem, options, execution);
}

VerifiedDesigns find_verified_design(const neural::Model& model, const DesignProblem& problem,
                                     const VerificationPlan& plan, const Execution& execution) {
  const neural::Evaluator evaluator(model.network);
  const Candidates candidates(model.network);
  const DesignSpace space = design_space(model, evaluator, candidates);
  const FamilySimulation simulation = simulation_of_model(model);
  return search_designs({&space, 1}, {&simulation, 1}, {.problem = problem, .verification = plan}, execution);
}

}  // namespace supple::design
