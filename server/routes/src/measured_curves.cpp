#include <optional>
#include <tuple>

#include "computation_route.h"
#include "handlers.h"
#include "supple/json/measured_curve_answers.h"
#include "supple/json/measured_curve_requests.h"

namespace supple::routes {
namespace {

using Column = design::MeasuredTable::Column;

/// The request's unit, else the header's where it is one of the table of units, else the profile's own.
std::string unit_of(const std::optional<std::string>& asked, const Column* column, const char* usual) {
  if (asked) {
    std::string known = design::known_unit(*asked);
    return known.empty() ? *asked : known;
  }
  if (column && !column->unit.empty()) {
    std::string known = design::known_unit(column->unit);
    if (!known.empty()) return known;
  }
  return usual;
}

design::MeasuredCurve measured(const json::MeasuredCurveRequest& request, json::MeasuredCurveAnswer& answer,
                               const Execution& execution) {
  const StageTimer timer(execution.cost, "reading");
  const bool strains = request.task == design::Task::stress_strain;
  const Column* x_column = nullptr;
  const Column* y_column = nullptr;
  if (request.text) {
    answer.table = design::read_table(*request.text, execution.cancellation);
    std::tie(answer.x, answer.y) = design::choose_columns(*answer.table, request.x, request.y);
    x_column = &answer.table->columns[answer.x];
    y_column = &answer.table->columns[answer.y];
  }
  answer.x_unit = unit_of(request.x_unit, x_column, strains ? "1" : "rad");
  answer.y_unit = unit_of(request.y_unit, y_column, request.task == design::Task::poisson ? "1" : "MPa");
  const auto x = design::conversion_of_x(request.task, answer.x_unit, request.specimen);
  const auto y = design::conversion_of_y(request.task, answer.y_unit, request.specimen);
  design::MeasuredCurve curve;
  curve.task = request.task;
  const std::size_t count = answer.table ? answer.table->rows() : request.points.size();
  curve.points.reserve(count);
  for (std::size_t i = 0; i < count; ++i) {
    const Eigen::Vector2d raw =
        x_column ? Eigen::Vector2d(x_column->values[i], y_column->values[i]) : request.points[i];
    curve.points.emplace_back(raw.x() * x.factor + x.offset, raw.y() * y.factor + y.offset);
  }
  return curve;
}

store::Result compute(const json::MeasuredCurveRequest& request, const Execution& outer) {
  json::MeasuredCurveAnswer answer;
  answer.task = request.task;
  answer.options = request.options;
  const auto bill = billed(outer, [&](const Execution& execution) {
    execution.checkpoint(0, "reading");
    try {
      answer.curve = design::reduce(measured(request, answer, execution), request.options, execution);
    } catch (const Error& error) {
      // Places of the engine become pointers into the request.
      if (error.code() != "design.invalid_measurement" && error.code() != "design.unreadable_table") throw;
      auto details = error.details();
      for (auto& detail : details) {
        if (!request.text && detail.where == "points") detail.where = "/points";
        if (request.text && detail.where == "points") detail.where = "/text";
        if (!detail.where.starts_with('/')) detail.where.insert(0, "/");
      }
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
