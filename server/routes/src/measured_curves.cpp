#include <string>
#include <utility>

#include "endpoint.h"
#include "handlers.h"
#include "request_pointers.h"
#include "results.h"
#include "supple/design/design_fault.h"
#include "supple/json/measured_curve_answers.h"
#include "supple/json/measured_curve_requests.h"

namespace supple::routes {
namespace {

/// Pointers for the engine's faults of a measurement. The points of a table come from its text.
PointerMap measurement_pointers(const json::MeasuredCurveRequest& request) {
  std::vector<FieldPlace> places{{.field = "text", .pointer = request.text_field}};
  if (request.measurements.text) places.push_back({.field = "points", .pointer = request.text_field});
  return PointerMap("", std::move(places));
}

store::Result compute(const json::MeasuredCurveRequest& request, const Execution& outer) {
  json::MeasuredCurveAnswer answer;
  answer.task = request.measurements.task;
  answer.options = request.options;
  answer.encoding = request.encoding;
  const auto bill = billed(outer, [&](const Execution& execution) {
    execution.checkpoint(0, "reading");
    const PointerMap pointers = measurement_pointers(request);
    with_pointers<design::MeasurementFault>(pointers, [&] {
      answer.measurements = design::read_measurements(request.measurements, execution);
      answer.curve = design::reduce(answer.measurements.curve, request.options, execution);
    });
  });
  return json_result(json::write_measured_curve(answer, bill));
}

PreparedComputation prepare_measured_curve(const EndpointRequest& asked, const Loader& loader) {
  auto request = json::parse_measured_curve(asked.body, loader.limits(), loader.cancellation());
  return {.deadline = request.deadline,
          .run = [request = std::move(request)](const Execution& execution) { return compute(request, execution); }};
}

}  // namespace

void add_measured_curve_route(http::Router& router, Services& services) {
  add_endpoint(router, services, {.kind = "measured-curves", .prepare = prepare_measured_curve});
}

}  // namespace supple::routes
