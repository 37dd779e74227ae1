#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/json/model_requests.h"
#include "supple/neural/error_bars.h"
#include "supple/store/model_store.h"

// Many strains of many designs at once.
namespace supple::routes {

/// What a model says about the strains of a request, in their order.
struct ModelBatch {
  neural::Evaluation values;
  std::vector<neural::Trust> trust;
};

/// Throws "model.parameter_count" unless each design has as many numbers as the model has parameters; `pointer` says
/// where in the request the design of an index stands.
void check_designs(const store::LoadedModel& model, std::span<const std::vector<double>> designs,
                   const std::function<std::string(std::size_t)>& pointer);

/// Throws what `check_designs` throws, and "model.design_count" unless there is one design, or one for each strain.
void check_evaluation(const store::LoadedModel& model, const json::EvaluationRequest& request);

/// Evaluates a request that has passed `check_evaluation`, in parallel; equal designs that follow one another are
/// prepared once. Throws "model.not_finite".
ModelBatch evaluate(const store::LoadedModel& model, const json::EvaluationRequest& request,
                    const Execution& execution);

}  // namespace supple::routes
