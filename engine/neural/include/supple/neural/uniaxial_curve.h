#pragma once

#include <span>
#include <vector>

#include "supple/base/execution.h"
#include "supple/neural/error_bars.h"
#include "supple/neural/uniaxial.h"

namespace supple::neural {

/// A model's states under a uniaxial load and how far each is to be trusted.
struct UniaxialCurve {
  std::vector<UniaxialState> states;
  std::vector<Trust> trust;  ///< of the stress; no error bar where the state is no equilibrium
};

/// `parameters` is as long as the model's. Throws what `uniaxial_path` throws, and "model.not_finite" where a state has
/// numbers that are none (residuals may have). Bills the stage "equilibrium" and the quantity "iterations".
UniaxialCurve uniaxial_curve(const Model& model, const Evaluator& evaluator, const std::vector<double>& parameters,
                             double direction, std::span<const double> green_strains,
                             const UniaxialOptions& options = {}, const Execution& execution = {});

}  // namespace supple::neural
