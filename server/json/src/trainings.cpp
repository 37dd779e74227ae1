#include "supple/json/trainings.h"

#include "answer_parts.h"
#include "family_fields.h"
#include "request_parts.h"

namespace supple::json {
namespace {

// The ranges of api/openapi.yaml.
constexpr double min_core_seconds = 60;
constexpr double max_core_seconds = 1e7;
constexpr double max_training_error = 0.5;
constexpr int max_seed = 1'000'000'000;

void write_estimate(JsonWriter& out, const TrainingEstimate& estimate) {
  out.key("estimate")
      .begin_object()
      .field("simulation", estimate.simulation_seconds)
      .field("training", estimate.training_seconds)
      .field("designs", estimate.designs)
      .field("chosen_designs", estimate.chosen_designs)
      .end_object();
}

void write_errors(JsonWriter& out, const std::vector<ReachedError>& errors) {
  out.key("errors").begin_array();
  for (const auto& [error, designs] : errors)
    out.begin_object().field("designs", designs).field("error", error).end_object();
  out.end_array();
}

}  // namespace

TrainingRequest parse_training(std::string_view body, const Limits& limits, const CancellationToken& cancellation) {
  return read_request<TrainingRequest>(body, limits, cancellation, [&](Fields& fields, TrainingRequest& request) {
    read_family_id(fields, "family", request.family);
    fields.required("budget");
    nested(fields, "budget", [&](Fields& budget) {
      budget.required("core_seconds");
      budget.number("core_seconds", request.core_seconds, min_core_seconds, max_core_seconds);
    });
    nested(fields, "accuracy",
           [&](Fields& accuracy) { accuracy.number("error", request.error, 0, max_training_error); });
    fields.integer("seed", request.seed, 1, max_seed);
  });
}

std::string write_training_plan(const std::string& family, const TrainingEstimate& estimate, const Bill& bill) {
  JsonWriter out;
  out.begin_object().field("family", family);
  write_estimate(out, estimate);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

std::string write_partial_training(const std::string& family, const std::vector<ReachedError>& errors) {
  JsonWriter out;
  out.begin_object().field("family", family);
  write_errors(out, errors);
  out.end_object();
  return out.take();
}

std::string write_training(const FinishedTraining& training, const Bill& bill) {
  const auto last = training.errors.empty() ? ReachedError() : training.errors.back();
  JsonWriter out;
  out.begin_object()
      .field("model", training.model)
      .field("family", training.family)
      .field("error", last.error)
      .field("designs", last.designs);
  write_errors(out, training.errors);
  write_estimate(out, training.estimate);
  write_bill(out, bill);
  out.end_object();
  return out.take();
}

}  // namespace supple::json
