#pragma once

#include <Eigen/Core>
#include <string_view>
#include <vector>

#include "supple/base/cancellation.h"
#include "supple/json/limits.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/uniaxial.h"

/// The requests to neural models as types; they are read like those of requests.h and throw the same. Whether there are
/// as many parameters as the model has, and as many designs as strains, is not checked here.
namespace supple::json {

struct EvaluationRequest {
  std::vector<std::vector<double>> designs;  ///< parameters of one design, or of one design for each strain
  Eigen::Matrix3Xd strains;                  ///< columns (E_xx, E_yy, 2 E_xy), as the engine has them
  neural::Order order = neural::Order::stress;
  double deadline = 0;  ///< seconds; set also where the request leaves it out
};
EvaluationRequest parse_evaluation(std::string_view body, const Limits& limits,
                                   const CancellationToken& cancellation = {});

struct UniaxialRequest {
  std::vector<double> parameters;
  double direction = 0;               ///< rad
  std::vector<double> green_strains;  ///< strains along the direction; stretches are converted to them
  neural::UniaxialOptions options;
  double deadline = 0;
};
UniaxialRequest parse_uniaxial(std::string_view body, const Limits& limits, const CancellationToken& cancellation = {});

}  // namespace supple::json
