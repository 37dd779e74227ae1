#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/json/answers.h"
#include "supple/json/limits.h"

/// The training of a family's network as request and answer; the request is read like those of requests.h.
namespace supple::json {

struct TrainingRequest {
  std::string family;
  double core_seconds = 0;  ///< of all simulations and trainings
  double error = 0;         ///< mean relative error at which no more designs are simulated; 0: never
  int seed = 1;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
TrainingRequest parse_training(std::string_view body, const Limits& limits, const CancellationToken& cancellation = {});

/// What a training takes, as far as it is known before.
struct TrainingEstimate {
  double simulation_seconds = 0;  ///< core-seconds
  double training_seconds = 0;    ///< core-seconds
  std::int64_t designs = 0;
  std::int64_t chosen_designs = 0;  ///< those of them that small networks choose
};
std::string write_training_plan(const std::string& family, const TrainingEstimate& estimate, const Bill& bill);

/// What networks err by that have learned from some number of designs.
struct ReachedError {
  double error = 0;  ///< mean relative error of the stress on designs held out
  std::int64_t designs = 0;
};
/// The errors that a running training has reached, in their order.
std::string write_partial_training(const std::string& family, const std::vector<ReachedError>& errors);

struct FinishedTraining {
  std::string model;                 ///< id
  std::string family;                ///< id
  std::vector<ReachedError> errors;  ///< the last one is that of the finished network
  TrainingEstimate estimate;
};
std::string write_training(const FinishedTraining& training, const Bill& bill);

}  // namespace supple::json
