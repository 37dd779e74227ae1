#include <string>
#include <utility>

#include "computation_route.h"
#include "handlers.h"
#include "supple/json/measured_curve_answers.h"
#include "supple/json/measured_curve_requests.h"

namespace supple::routes {
namespace {

/// Pointer into the request for a place that the engine names.
std::string pointer_of(const std::string& where, const json::MeasuredCurveRequest& request) {
  if (where == "points" && request.measurements.text) return request.text_field;
  if (where == "text") return request.text_field;
  return where.starts_with('/') ? where : "/" + where;
}

store::Result compute(const json::MeasuredCurveRequest& request, const Execution& outer) {
  json::MeasuredCurveAnswer answer;
  answer.task = request.measurements.task;
  answer.options = request.options;
  answer.encoding = request.encoding;
  const auto bill = billed(outer, [&](const Execution& execution) {
    execution.checkpoint(0, "reading");
    try {
      answer.measurements = design::read_measurements(request.measurements, execution);
      answer.curve = design::reduce(answer.measurements.curve, request.options, execution);
    } catch (const Error& error) {
      if (error.code() != "design.invalid_measurement" && error.code() != "design.unreadable_table") throw;
      auto details = error.details();
      for (auto& detail : details) detail.where = pointer_of(detail.where, request);
      throw Error(error.code(), error.what(), std::move(details));
    }
  });
  return json_result(json::write_measured_curve(answer, bill));
}

}  // namespace

void add_measured_curve_route(http::Router& router, Services& services) {
  const auto handler = [&services](const http::Request& http_request) {
    require_ready(services);
    auto request = json::parse_measured_curve(json_body(http_request), services.limits.json);
    jobs::Computation computation{"measured-curves", {}, request.deadline, {}};
    computation.run = [request = std::move(request)](const Execution& execution) {
      return compute(request, execution);
    };
    return answer_computation(services, http_request, std::move(computation));
  };
  router.add({"POST", "/v1/measured-curves", handler, {services.limits.max_json, "--max-json"}});
}

}  // namespace supple::routes
