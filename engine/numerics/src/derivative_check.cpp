#include "supple/numerics/derivative_check.h"

#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>
#include <stdexcept>
#include <variant>
#include <vector>

namespace supple::numerics {
namespace {

/// Derivatives extrapolated from central differences to step zero by Neville's scheme in the square of the step. Each
/// entry has the extrapolation that shorter steps change least.
struct Extrapolated {
  Eigen::ArrayXd value;
  Eigen::ArrayXd uncertainty;
};

Extrapolated ridders(const std::vector<Eigen::ArrayXd>& differences) {
  Extrapolated best;
  best.value = differences.front();
  best.uncertainty = Eigen::ArrayXd::Constant(best.value.size(), std::numeric_limits<double>::infinity());
  std::vector<Eigen::ArrayXd> previous;  // row of the tableau for the longer step
  for (const Eigen::ArrayXd& difference : differences) {
    std::vector<Eigen::ArrayXd> row{difference};
    double factor = 1;
    for (std::size_t j = 0; j < previous.size(); ++j) {
      factor *= 4;
      row.push_back((factor * row[j] - previous[j]) / (factor - 1));
      const Eigen::ArrayXd change = (row[j + 1] - row[j]).abs().max((row[j + 1] - previous[j]).abs());
      for (Eigen::Index i = 0; i < change.size(); ++i) {
        if (change[i] <= best.uncertainty[i]) {
          best.uncertainty[i] = change[i];
          best.value[i] = row[j + 1][i];
        }
      }
    }
    previous = std::move(row);
  }
  return best;
}

class Comparison {
 public:
  Comparison(double scale, DerivativeCheck::Worst& worst) : scale_(scale > 0 ? scale : 1), worst_(worst) {}

  void add(Eigen::Index row, Eigen::Index column, double analytic, double numeric, double uncertainty) {
    const double error = std::abs(analytic - numeric) / scale_;
    // The comparison is written so that a NaN counts as the largest error.
    if (error <= worst_.error && !first_) return;
    first_ = false;
    worst_ = {std::isnan(error) ? std::numeric_limits<double>::infinity() : error,
              row,
              column,
              analytic,
              numeric,
              uncertainty / scale_};
  }

 private:
  double scale_;
  DerivativeCheck::Worst& worst_;
  bool first_ = true;
};

/// Converts any kind of Hessian to a dense matrix with both triangles, or to an empty one if there is none. A kind that
/// is not listed does not compile.
struct ToDense {
  Eigen::MatrixXd operator()(std::monostate) const { return {}; }
  Eigen::MatrixXd operator()(const Eigen::MatrixXd& dense) const { return dense; }
  Eigen::MatrixXd operator()(const SparseMatrix& sparse) const { return sparse; }
  Eigen::MatrixXd operator()(const std::shared_ptr<const BorderedMatrix>& bordered) const {
    const Eigen::Index n = bordered->core.rows();
    const Eigen::Index m = bordered->corner.rows();
    Eigen::MatrixXd dense(n + m, n + m);
    const Eigen::MatrixXd lower(bordered->core);
    dense.topLeftCorner(n, n) = lower.selfadjointView<Eigen::Lower>();
    dense.topRightCorner(n, m) = bordered->border;
    dense.bottomLeftCorner(m, n) = bordered->border.transpose();
    dense.bottomRightCorner(m, m) = bordered->corner;
    if (bordered->low_rank.size() > 0) dense += bordered->low_rank * bordered->low_rank.transpose();
    return dense;
  }
};

}  // namespace

std::string DerivativeCheck::summary() const {
  char text[400];
  std::snprintf(text, sizeof text,
                "gradient off by %.2e at %td (analytic %.17g, numeric %.17g, uncertain by %.1e); "
                "Hessian off by %.2e at (%td, %td) (analytic %.17g, numeric %.17g, uncertain by %.1e)",
                gradient.error, gradient.row, gradient.analytic, gradient.numeric, gradient.uncertainty, hessian.error,
                hessian.row, hessian.column, hessian.analytic, hessian.numeric, hessian.uncertainty);
  return text;
}

DerivativeCheck check_derivatives(const LocalFunction& function, Eigen::Index dimension,
                                  const DerivativeCheckOptions& options) {
  const Evaluation base = function(Eigen::VectorXd::Zero(dimension), options.hessian ? 2 : 1);
  // The function may overwrite a bordered Hessian at its next evaluation, so a copy is made here.
  const Eigen::MatrixXd hessian = options.hessian ? std::visit(ToDense{}, base.hessian) : Eigen::MatrixXd();
  if (base.gradient.size() != dimension)
    throw std::invalid_argument("check_derivatives: the function gave no gradient of the dimension");
  if (options.hessian && (hessian.rows() != dimension || hessian.cols() != dimension))
    throw std::invalid_argument(
        "check_derivatives: a Hessian was to be checked and the function gave none of the dimension");

  DerivativeCheck check;
  Comparison gradient_comparison(base.gradient.cwiseAbs().maxCoeff(), check.gradient);
  Eigen::MatrixXd numeric_hessian(dimension, dimension);
  Eigen::MatrixXd uncertainty(dimension, dimension);
  for (Eigen::Index column = 0; column < dimension; ++column) {
    // One array per step length: first the difference of the value, then those of the gradient.
    std::vector<Eigen::ArrayXd> differences;
    double h = options.step;
    for (int level = 0; level < options.levels; ++level, h /= 2) {
      const Evaluation ahead = function(h * Eigen::VectorXd::Unit(dimension, column), 1);
      const Evaluation behind = function(-h * Eigen::VectorXd::Unit(dimension, column), 1);
      Eigen::ArrayXd difference(1 + dimension);
      difference[0] = (ahead.value - behind.value) / (2 * h);
      difference.tail(dimension) = (ahead.gradient - behind.gradient).array() / (2 * h);
      differences.push_back(std::move(difference));
    }
    const Extrapolated numeric = ridders(differences);
    gradient_comparison.add(column, 0, base.gradient[column], numeric.value[0], numeric.uncertainty[0]);
    numeric_hessian.col(column) = numeric.value.tail(dimension).matrix();
    uncertainty.col(column) = numeric.uncertainty.tail(dimension).matrix();
  }
  if (!options.hessian) return check;
  if (options.frames_turn) {
    numeric_hessian = (numeric_hessian + numeric_hessian.transpose()).eval() / 2;
    uncertainty = (uncertainty + uncertainty.transpose()).eval() / 2;
  }
  Comparison hessian_comparison(hessian.cwiseAbs().maxCoeff(), check.hessian);
  for (Eigen::Index column = 0; column < dimension; ++column)
    for (Eigen::Index row = 0; row < dimension; ++row)
      hessian_comparison.add(row, column, hessian(row, column), numeric_hessian(row, column), uncertainty(row, column));
  return check;
}

DerivativeCheck check_derivatives(Objective& objective, const DerivativeCheckOptions& options) {
  const Eigen::Index n = objective.dimension();
  const LocalFunction function = [&](const Eigen::VectorXd& step, int order) {
    if (step.isZero(0)) return objective.evaluate(order);
    objective.move(step);
    Evaluation evaluation = objective.evaluate(order);
    // The transport is an isometry, so its transpose carries the gradient back.
    Eigen::MatrixXd transport(n, n);
    for (Eigen::Index i = 0; i < n; ++i) {
      Eigen::VectorXd e = Eigen::VectorXd::Unit(n, i);
      objective.transport(e);
      transport.col(i) = e;
    }
    evaluation.gradient = transport.transpose() * evaluation.gradient;
    objective.reject();
    return evaluation;
  };
  return check_derivatives(function, n, options);
}

}  // namespace supple::numerics
