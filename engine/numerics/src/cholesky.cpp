#include "supple/numerics/cholesky.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <vector>

#include "multifrontal_cholesky.h"

namespace supple::numerics {
namespace {

/// The pattern of a compressed matrix, which tells whether the next matrix has the same one.
struct Pattern {
  std::vector<int> outer;
  std::vector<int> inner;

  bool matches(const SparseMatrix& m) const {
    return outer.size() == static_cast<std::size_t>(m.outerSize() + 1) &&
           inner.size() == static_cast<std::size_t>(m.nonZeros()) &&
           std::equal(outer.begin(), outer.end(), m.outerIndexPtr()) &&
           std::equal(inner.begin(), inner.end(), m.innerIndexPtr());
  }
  void assign(const SparseMatrix& m) {
    outer.assign(m.outerIndexPtr(), m.outerIndexPtr() + m.outerSize() + 1);
    inner.assign(m.innerIndexPtr(), m.innerIndexPtr() + m.nonZeros());
  }
};

}  // namespace

struct ShiftedCholesky::Implementation {
  Eigen::LLT<Eigen::MatrixXd> dense;
  MultifrontalCholesky sparse;
  Pattern pattern;
  bool last_was_sparse = false;
  int analyses = 0;
  CostLedger* cost = nullptr;
  // These are for a bordered matrix H = [core border; border^T corner].
  Eigen::MatrixXd border;
  Eigen::MatrixXd core_inverse_border;
  Eigen::LLT<Eigen::MatrixXd> schur;
  // These are for a low-rank part L L^T: A^-1 L for the matrix A without it, and the factors of I + L^T A^-1 L.
  Eigen::MatrixXd low_rank;
  Eigen::MatrixXd inverse_low_rank;
  Eigen::LLT<Eigen::MatrixXd> capacitance;

  bool factorize_dense(Eigen::MatrixXd matrix, double shift) {
    matrix.diagonal().array() += shift;
    last_was_sparse = false;
    if (!matrix.allFinite()) return false;
    dense.compute(matrix);
    return dense.info() == Eigen::Success;
  }

  bool factorize_sparse(const SparseMatrix& matrix, double shift) {
    if (!matrix.isCompressed()) return factorize_sparse(SparseMatrix(matrix), shift);
    last_was_sparse = true;
    if (!std::all_of(matrix.valuePtr(), matrix.valuePtr() + matrix.nonZeros(),
                     [](double v) { return std::isfinite(v); }))
      return false;
    if (analyses == 0 || !pattern.matches(matrix)) {
      sparse.analyze(matrix);
      pattern.assign(matrix);
      ++analyses;
    }
    return sparse.factorize(matrix, shift);
  }

  bool factorize_core(const SparseMatrix& core, double shift) {
    if (core.rows() >= dense_cholesky_limit) return factorize_sparse(core, shift);
    return factorize_dense(Eigen::MatrixXd(core).selfadjointView<Eigen::Lower>(), shift);
  }

  bool factorize_bordered(const BorderedMatrix& matrix, double shift) {
    if (!matrix.border.allFinite() || !matrix.corner.allFinite() || !factorize_core(matrix.core, shift)) return false;
    border = matrix.border;
    if (border.cols() > 0) {
      core_inverse_border = solve_core(border);
      Eigen::MatrixXd complement = matrix.corner - border.transpose() * core_inverse_border;
      complement.diagonal().array() += shift;
      schur.compute(complement);
      if (schur.info() != Eigen::Success) return false;
    }
    if (matrix.low_rank.size() == 0) return true;
    if (!matrix.low_rank.allFinite()) return false;
    inverse_low_rank = solve_bordered(matrix.low_rank);
    low_rank = matrix.low_rank;
    Eigen::MatrixXd sum = low_rank.transpose() * inverse_low_rank;
    sum.diagonal().array() += 1;
    capacitance.compute(sum);
    return capacitance.info() == Eigen::Success;
  }

  /// Solves with the matrix without its low-rank part.
  Eigen::MatrixXd solve_bordered(const Eigen::MatrixXd& b) const {
    if (border.cols() == 0) return solve_core(b);
    Eigen::MatrixXd x(b.rows(), b.cols());
    x.topRows(border.rows()) = solve_core(b.topRows(border.rows()));
    x.bottomRows(border.cols()) =
        schur.solve(b.bottomRows(border.cols()) - border.transpose() * x.topRows(border.rows()));
    x.topRows(border.rows()) -= core_inverse_border * x.bottomRows(border.cols());
    return x;
  }

  Eigen::VectorXd solve(const Eigen::VectorXd& b) const {
    Eigen::VectorXd x = solve_bordered(b);
    if (low_rank.size() == 0) return x;
    return x - inverse_low_rank * capacitance.solve(low_rank.transpose() * x);
  }

  Eigen::MatrixXd solve_core(const Eigen::MatrixXd& b) const {
    if (!last_was_sparse) return dense.solve(b);
    Eigen::MatrixXd x = b;
    sparse.solve(x);
    return x;
  }
};

ShiftedCholesky::ShiftedCholesky() : implementation_(std::make_unique<Implementation>()) {}
ShiftedCholesky::~ShiftedCholesky() = default;

bool ShiftedCholesky::factorize(const Hessian& hessian, double shift) {
  const StageTimer timer(implementation_->cost, "factorization");
  implementation_->border.resize(0, 0);
  implementation_->low_rank.resize(0, 0);
  if (const auto* bordered = std::get_if<std::shared_ptr<const BorderedMatrix>>(&hessian))
    return implementation_->factorize_bordered(**bordered, shift);
  if (const auto* dense = std::get_if<Eigen::MatrixXd>(&hessian))
    return implementation_->factorize_dense(*dense, shift);
  const auto& sparse = std::get<SparseMatrix>(hessian);
  if (sparse.rows() < dense_cholesky_limit) return implementation_->factorize_dense(Eigen::MatrixXd(sparse), shift);
  return implementation_->factorize_sparse(sparse, shift);
}

Eigen::VectorXd ShiftedCholesky::solve(const Eigen::VectorXd& b) const {
  const StageTimer timer(implementation_->cost, "solve");
  return implementation_->solve(b);
}

Eigen::MatrixXd ShiftedCholesky::solve_core(const Eigen::MatrixXd& b) const {
  const StageTimer timer(implementation_->cost, "solve");
  return implementation_->solve_core(b);
}

int ShiftedCholesky::analyses() const { return implementation_->analyses; }

void ShiftedCholesky::stop_with(const CancellationToken& cancellation) {
  implementation_->sparse.stop_with(cancellation);
}

void ShiftedCholesky::use_fast_ordering() { implementation_->sparse.search_orderings(OrderingSearch::quick); }

void ShiftedCholesky::bill_to(CostLedger* cost) { implementation_->cost = cost; }

double matrix_scale(const Hessian& hessian) {
  double squares = 0;
  Eigen::Index n = 0;
  if (const auto* dense = std::get_if<Eigen::MatrixXd>(&hessian)) {
    n = dense->rows();
    squares = dense->squaredNorm();
  } else if (const auto* sparse = std::get_if<SparseMatrix>(&hessian)) {
    n = sparse->rows();
    squares = sparse->squaredNorm();
  } else if (const auto* bordered = std::get_if<std::shared_ptr<const BorderedMatrix>>(&hessian)) {
    const SparseMatrix& core = (*bordered)->core;
    n = core.rows();
    squares = 2 * core.squaredNorm() - Eigen::VectorXd(core.diagonal()).squaredNorm();
  }
  return n > 0 && squares > 0 ? std::sqrt(squares / static_cast<double>(n)) : 1.0;
}

}  // namespace supple::numerics
