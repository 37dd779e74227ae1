#include "endpoint.h"
#include "entity_tag.h"
#include "handlers.h"
#include "results.h"
#include "supple/json/json_writer.h"
#include "supple/json/model_answers.h"
#include "supple/neural/batch.h"
#include "supple/neural/uniaxial_curve.h"

namespace supple::routes {
namespace {

using Model = std::shared_ptr<const store::LoadedModel>;

/// The model that the path names. Throws "model.not_found".
Model model_of(const store::VisibleModels& models, const std::map<std::string, std::string>& path_parameters) {
  return models.get(path_parameters.at("model"));
}

json::ModelVersion version_of(const store::LoadedModel& model) { return {model.model.id, model.sha256}; }

http::Response list_models(const Services& services, const http::Request& request) {
  require_ready(services);
  json::JsonWriter out;
  out.begin_object().key("models").begin_array();
  for (const auto& model : services.models->models(request.key)) out.raw(model->description);
  out.end_array().end_object();
  return json_response(out.take());
}

http::Response show_model(const Services& services, const http::Request& request) {
  require_ready(services);
  const auto model = model_of({*services.models, request.key}, request.path_parameters);
  if (matches(request.header("If-None-Match"), model->sha256)) return not_modified(model->sha256);
  auto response = json_response(model->description);
  response.set_header("ETag", quoted(model->sha256));
  return response;
}

neural::Batch batch_of(const json::EvaluationRequest& request) {
  return {request.designs, request.strains, request.order};
}

store::Result compute_evaluation(const store::LoadedModel& model, const json::EvaluationRequest& request,
                                 metrics::Metrics& metrics, const Execution& outer) {
  neural::BatchResult result;
  const auto bill = billed(outer, [&](const Execution& execution) {
    result = neural::evaluate_batch(model.model, model.evaluator, batch_of(request), execution);
    bill_requested(execution, "stresses", request.order >= neural::Order::stress);
    bill_requested(execution, "tangents", request.order >= neural::Order::tangent);
    bill_error_bars(model.model, execution);
  });
  metrics.count_evaluations(model.model.id, request.strains.cols());
  return json_result(json::write_evaluation(version_of(model), request.order, result.values, result.trust,
                                            model.model.calibration.has_value(), bill));
}

store::Result compute_uniaxial(const store::LoadedModel& model, const json::UniaxialRequest& request,
                               metrics::Metrics& metrics, const Execution& outer) {
  neural::UniaxialCurve curve;
  const auto bill = billed(outer, [&](const Execution& execution) {
    curve = neural::uniaxial_curve(model.model, model.evaluator, request.parameters, request.direction,
                                   request.green_strains, request.options, execution);
    bill_error_bars(model.model, execution);
  });
  metrics.count_evaluations(model.model.id, static_cast<std::int64_t>(curve.states.size()));
  return json_result(json::write_uniaxial(version_of(model), request, curve.states, curve.trust, bill));
}

PreparedComputation prepare_evaluation(const EndpointRequest& asked, const Loader& loader) {
  auto model = model_of(loader.models(), asked.path_parameters);
  auto request = std::make_shared<const json::EvaluationRequest>(
      json::parse_evaluation(asked.body, loader.limits(), loader.cancellation()));
  neural::check_batch(model->model, batch_of(*request));
  return {.deadline = request->deadline,
          .run = [request, model = std::move(model), &metrics = loader.metrics()](const Execution& execution) {
            return compute_evaluation(*model, *request, metrics, execution);
          }};
}

PreparedComputation prepare_uniaxial(const EndpointRequest& asked, const Loader& loader) {
  auto model = model_of(loader.models(), asked.path_parameters);
  auto request = json::parse_uniaxial(asked.body, loader.limits(), loader.cancellation());
  neural::check_designs(model->model, {&request.parameters, 1}, "parameters", false);
  return {.deadline = request.deadline,
          .run = [request = std::move(request), model = std::move(model), &metrics = loader.metrics()](
                     const Execution& execution) { return compute_uniaxial(*model, request, metrics, execution); }};
}

}  // namespace

void add_model_routes(http::Router& router, Services& services) {
  router.add({"GET", "/v1/models", [&services](const http::Request& r) { return list_models(services, r); }, {}});
  router.add(
      {"GET", "/v1/models/{model}", [&services](const http::Request& r) { return show_model(services, r); }, {}});
  add_endpoint(router, services,
               {.path = "/v1/models/{model}/evaluations", .kind = "model-evaluations", .prepare = prepare_evaluation});
  add_endpoint(router, services,
               {.path = "/v1/models/{model}/uniaxial", .kind = "model-uniaxial", .prepare = prepare_uniaxial});
}

}  // namespace supple::routes
