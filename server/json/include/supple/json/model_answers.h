#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "supple/json/answers.h"
#include "supple/json/model_requests.h"
#include "supple/neural/error_bars.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/model.h"
#include "supple/neural/uniaxial.h"

/// The answers about neural models as JSON text; they throw like those of answers.h.
namespace supple::json {

/// The file that an answer comes from: the file of a model may be replaced between two requests.
struct ModelVersion {
  std::string id;
  std::string sha256;
};

/// One model; `sha256` is that of its file.
std::string write_model(const neural::Model& model, const std::string& sha256);

/// `trust` has an entry for each strain. Writes the `values` up to `order`. `has_bars` says whether the
/// model has a calibration.
std::string write_evaluation(const ModelVersion& model, neural::Order order, const neural::Evaluation& values,
                             const std::vector<neural::Trust>& trust, bool has_bars, const Bill& bill);

/// `trust` has an entry for each state. Residuals that are not finite are null.
std::string write_uniaxial(const ModelVersion& model, const UniaxialRequest& request,
                           const std::vector<neural::UniaxialState>& states, const std::vector<neural::Trust>& trust,
                           const Bill& bill);

}  // namespace supple::json
