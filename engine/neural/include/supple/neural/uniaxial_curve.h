#pragma once

#include <span>
#include <vector>

#include "supple/base/execution.h"
#include "supple/neural/error_bars.h"
#include "supple/neural/uniaxial.h"

namespace supple::neural {

/// The states of a model under a uniaxial load, and the trust in each of them.
struct UniaxialCurve {
  std::vector<UniaxialState> states;
  std::vector<Trust> trust;  ///< trust in the stress; has no error bar if the state did not converge
};

/// Computes the states under a uniaxial load. `parameters` must have as many entries as the model has parameters.
/// Throws what `uniaxial_path` throws, and "model.not_finite" if a number of a state other than its residual is not
/// finite. Bills the stage "equilibrium" and the quantity "iterations".
UniaxialCurve uniaxial_curve(const Model& model, const Evaluator& evaluator, const std::vector<double>& parameters,
                             double direction, std::span<const double> green_strains,
                             const UniaxialOptions& options = {}, const Execution& execution = {});

}  // namespace supple::neural
