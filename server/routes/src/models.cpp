#include <cmath>

#include "computation_route.h"
#include "entity_tag.h"
#include "handlers.h"
#include "model_batch.h"
#include "supple/json/json_writer.h"
#include "supple/json/model_answers.h"

namespace supple::routes {
namespace {

using Model = std::shared_ptr<const store::LoadedModel>;

/// The model that the path names. Throws "model.not_found".
Model model_of(const Services& services, const http::Request& request) {
  return services.models->get(request.path_parameters.at("model"));
}

json::ModelVersion version_of(const store::LoadedModel& model) { return {model.model.id, model.sha256}; }

http::Response list(const Services& services) {
  require_ready(services);
  json::JsonWriter out;
  out.begin_object().key("models").begin_array();
  for (const auto& model : services.models->models()) out.raw(model->description);
  out.end_array().end_object();
  return json_response(out.take());
}

http::Response show_model(const Services& services, const http::Request& request) {
  require_ready(services);
  const auto model = model_of(services, request);
  if (matches(request.header("If-None-Match"), model->sha256)) return not_modified(model->sha256);
  auto response = json_response(model->description);
  response.set_header("ETag", quoted(model->sha256));
  return response;
}

store::Result compute_evaluation(const store::LoadedModel& model, const json::EvaluationRequest& request,
                                 metrics::Metrics& metrics, const Execution& outer) {
  ModelBatch batch;
  const auto bill = billed(outer, [&](const Execution& execution) { batch = evaluate(model, request, execution); });
  metrics.count_evaluations(model.model.id, request.strains.cols());
  return json_result(json::write_evaluation(version_of(model), request.order, batch.values, batch.trust,
                                            model.model.calibration.has_value(), bill));
}

/// Throws "model.not_finite" where a state has a number that is none; residuals may have.
void check_finite(const std::vector<neural::UniaxialState>& states) {
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto& state = states[i];
    if (state.strain.allFinite() && state.stress.allFinite() && std::isfinite(state.energy_density)) continue;
    throw Error("model.not_finite", "The model gives no finite value at state " + std::to_string(i) + " of the load.");
  }
}

std::vector<neural::Trust> trust_of(const store::LoadedModel& model, const json::UniaxialRequest& request,
                                    const neural::Evaluator::Design& design,
                                    const std::vector<neural::UniaxialState>& states) {
  const neural::ErrorBars bars(model.model, model.evaluator, design, request.parameters, true);
  const neural::UniaxialFrame frame(request.direction);
  std::vector<neural::Trust> trust;
  for (std::size_t i = 0; i < states.size(); ++i) {
    const auto& state = states[i];
    trust.push_back(bars.uniaxial(neural::Quantity::stress, frame, request.green_strains[i], state.strain,
                                  {state.energy_density, state.stress, state.tangent}));
    // What is no equilibrium is no answer to the question that bars are about.
    if (!state.converged) trust.back().error.reset();
  }
  return trust;
}

store::Result compute_uniaxial(const store::LoadedModel& model, const json::UniaxialRequest& request,
                               metrics::Metrics& metrics, const Execution& outer) {
  std::vector<neural::UniaxialState> states;
  std::vector<neural::Trust> trust;
  const auto bill = billed(outer, [&](const Execution& execution) {
    const auto design = model.evaluator.design(request.parameters);
    {
      const StageTimer timer(execution.cost, "equilibrium");
      states = neural::uniaxial_path(model.evaluator, design, request.direction, request.green_strains, request.options,
                                     execution);
    }
    check_finite(states);
    int iterations = 0;
    for (const auto& state : states) {
      iterations += state.iterations;
    }
    trust = trust_of(model, request, design, states);
    execution.cost->add_quantity("iterations", iterations);
    execution.checkpoint(1, "");
  });
  metrics.count_evaluations(model.model.id, static_cast<std::int64_t>(states.size()));
  return json_result(json::write_uniaxial(version_of(model), request, states, trust, bill));
}

http::Response answer_evaluation(Services& services, const http::Request& http_request) {
  require_ready(services);
  auto model = model_of(services, http_request);
  auto request = std::make_shared<const json::EvaluationRequest>(
      json::parse_evaluation(json_body(http_request), services.limits.json));
  check_evaluation(*model, *request);
  jobs::Computation computation{"model-evaluations", {}, request->deadline, {}};
  computation.run = [request, model = std::move(model), metrics = services.metrics](const Execution& execution) {
    return compute_evaluation(*model, *request, *metrics, execution);
  };
  return answer_computation(services, http_request, std::move(computation));
}

http::Response answer_uniaxial(Services& services, const http::Request& http_request) {
  require_ready(services);
  auto model = model_of(services, http_request);
  auto request = json::parse_uniaxial(json_body(http_request), services.limits.json);
  check_designs(*model, {&request.parameters, 1}, [](std::size_t) { return "/parameters"; });
  jobs::Computation computation{"model-uniaxial", {}, request.deadline, {}};
  computation.run = [request = std::move(request), model = std::move(model), metrics = services.metrics](
                        const Execution& execution) { return compute_uniaxial(*model, request, *metrics, execution); };
  return answer_computation(services, http_request, std::move(computation));
}

}  // namespace

void add_model_routes(http::Router& router, Services& services) {
  const http::BodyLimit json{services.limits.max_json, "--max-json"};
  router.add({"GET", "/v1/models", [&services](const http::Request&) { return list(services); }, {}});
  router.add(
      {"GET", "/v1/models/{model}", [&services](const http::Request& r) { return show_model(services, r); }, {}});
  router.add({"POST", "/v1/models/{model}/evaluations",
              [&services](const http::Request& r) { return answer_evaluation(services, r); }, json});
  router.add({"POST", "/v1/models/{model}/uniaxial",
              [&services](const http::Request& r) { return answer_uniaxial(services, r); }, json});
}

}  // namespace supple::routes
