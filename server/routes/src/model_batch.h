#pragma once

#include <cstdint>
#include <vector>

#include "supple/base/execution.h"
#include "supple/json/model_requests.h"
#include "supple/store/model_store.h"

// Many strains of many designs at once.
namespace supple::routes {

/// What a model says about the strains of a request, in their order.
struct ModelBatch {
  neural::Evaluation values;
  std::vector<std::uint8_t> in_range;
};

/// Throws "model.parameter_count", with a pointer to each design at fault, and "model.design_count".
void check_designs(const store::LoadedModel& model, const json::EvaluationRequest& request);

/// Evaluates a request that has passed `check_designs`, in parallel; equal designs that follow one another are prepared
/// once. Throws "model.not_finite".
ModelBatch evaluate(const store::LoadedModel& model, const json::EvaluationRequest& request,
                    const Execution& execution);

}  // namespace supple::routes
