#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/neural/error_bars.h"

namespace supple::neural {

/// Strains of one design, or strains that each belong to a design of their own.
struct Batch {
  std::span<const std::vector<double>> designs;  ///< parameters of one design, or of one design for each strain
  const Eigen::Matrix3Xd& strains;               ///< columns (E_xx, E_yy, 2 E_xy)
  Order order = Order::stress;
};

/// A model's results for the strains of a batch, in their order.
struct BatchResult {
  Evaluation values;
  std::vector<Trust> trust;
};

/// Throws "model.parameter_count" unless each design has as many numbers as the model has parameters. There is one
/// detail for each of the first 20 faulty designs. It names `field`, followed by "/" and the index of the design if
/// there are `several`.
void check_designs(const Model& model, std::span<const std::vector<double>> designs, const std::string& field,
                   bool several);

/// Throws what `check_designs` throws for the field "parameters", and "model.design_count" unless there is one design,
/// or one for each strain.
void check_batch(const Model& model, const Batch& batch);

/// Evaluates a batch that has passed `check_batch`, in parallel. Consecutive designs that are equal are prepared once.
/// Throws "model.not_finite" with a detail such as "green_strain/7". Bills the stages "designs" and "evaluation" and
/// the quantities "designs" and "strains".
BatchResult evaluate_batch(const Model& model, const Evaluator& evaluator, const Batch& batch,
                           const Execution& execution = {});

}  // namespace supple::neural
