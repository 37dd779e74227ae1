#include "cell_system.h"

#include <utility>

namespace supple::microscale {

CellSystem cell_system(CellModel& model, Eigen::VectorXd x, const FreeStrains& free, const Execution& execution) {
  Eigen::MatrixXd directions(CellCoordinates::strain_components, static_cast<Eigen::Index>(free.size()));
  for (std::size_t k = 0; k < free.size(); ++k) directions.col(static_cast<Eigen::Index>(k)) = free[k];
  numerics::SystemOptions options;
  options.execution = {execution.cancellation, nullptr, execution.cost};
  options.min_order = 1;
  options.sums = model.workspace().sums;
  return {model.state(std::move(x)), model.terms(),
          numerics::Unknowns(model.fixed_displacements(), std::move(directions)), std::move(options)};
}

}  // namespace supple::microscale
