#include "computation_route.h"
#include "entity_tag.h"
#include "handlers.h"
#include "structure_spec.h"
#include "supple/json/json_writer.h"
#include "supple/json/model_answers.h"
#include "supple/neural/batch.h"
#include "supple/neural/uniaxial_curve.h"

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

/// Calls make(); the engine's pointers become the request's.
template <class Make>
auto with_pointers(Make make) {
  try {
    return make();
  } catch (const Error& error) {
    if (error.details().empty()) throw;
    throw moved(error, "/");
  }
}

neural::Batch batch_of(const json::EvaluationRequest& request) {
  return {request.designs, request.strains, request.order};
}

store::Result compute_evaluation(const store::LoadedModel& model, const json::EvaluationRequest& request,
                                 metrics::Metrics& metrics, const Execution& outer) {
  neural::BatchResult result;
  const auto bill = billed(outer, [&](const Execution& execution) {
    result = with_pointers(
        [&] { return neural::evaluate_batch(model.model, model.evaluator, batch_of(request), execution); });
    tell_asked(execution, "stresses", request.order >= neural::Order::stress);
    tell_asked(execution, "tangents", request.order >= neural::Order::tangent);
    tell_error_bars(model.model, execution);
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
    tell_error_bars(model.model, execution);
  });
  metrics.count_evaluations(model.model.id, static_cast<std::int64_t>(curve.states.size()));
  return json_result(json::write_uniaxial(version_of(model), request, curve.states, curve.trust, bill));
}

http::Response answer_evaluation(Services& services, const http::Request& http_request) {
  require_ready(services);
  auto model = model_of(services, http_request);
  auto request = std::make_shared<const json::EvaluationRequest>(
      json::parse_evaluation(json_body(http_request), services.limits.json));
  with_pointers([&] { neural::check_batch(model->model, batch_of(*request)); });
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
  with_pointers([&] { neural::check_designs(model->model, {&request.parameters, 1}, "parameters", false); });
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
