#pragma once

#include <memory>
#include <vector>

#include "cell_model.h"
#include "supple/numerics/objective.h"

namespace supple::microscale {

/// Energy of a patch with prescribed macroscopic strain: a function of the periodic displacements and of the free
/// components of F.
///
/// Unknowns y: two displacements for each node, then one number q_k for each free direction D_k of F (orthonormal
/// matrices, as (xx, xy, yx, yy)). Node 0 is held, since a translation costs nothing: its gradient is zero and its rows
/// of the Hessian are diagonal.
class CellObjective : public numerics::Objective {
 public:
  using FreeStrains = std::vector<Eigen::Vector4d>;

  /// `model` outlives the objective. `x` are coordinates as in cell_coordinates.h.
  CellObjective(CellModel& model, Eigen::VectorXd x, FreeStrains free, CostLedger* cost);

  const Eigen::VectorXd& x() const { return x_; }
  /// Moves to a state that `prepare` of the model called valid.
  void set_x(Eigen::VectorXd x) {
    x_ = std::move(x);
    forget();
  }
  /// A term has changed: what was evaluated no longer holds.
  void forget() { evaluated_ = -1; }
  const FreeStrains& free() const { return free_; }

  Eigen::Index dimension() const override { return x_.size() - 4 + static_cast<Eigen::Index>(free_.size()); }
  numerics::Evaluation evaluate(int order) override;
  double move(const Eigen::VectorXd& step) override;
  void accept() override;
  void reject() override;

  /// A change of y as a change of x.
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const;

  // Of the last evaluation of order 1 or 2:
  double energy() const { return sum_.value; }
  Eigen::Vector4d strain_gradient() const { return sum_.gradient.tail<4>(); }  ///< dE / dF
  // Of the last evaluation of order 2, with all four components of F as the border (rows of node 0 zero):
  const Eigen::MatrixXd& strain_columns() const { return border_; }
  const Eigen::Matrix4d& strain_corner() const { return corner_; }
  const numerics::SparseMatrix& core() const { return reduced_->core; }

 private:
  CellModel& model_;
  Eigen::VectorXd x_;
  Eigen::VectorXd trial_;  ///< empty while there is no trial state
  FreeStrains free_;
  CostLedger* cost_;
  numerics::EnergySum& sum_;
  int evaluated_ = -1;  ///< order of derivatives of the present state, trial or not, that `sum_` holds; -1 for none
  std::shared_ptr<numerics::BorderedMatrix> reduced_ = std::make_shared<numerics::BorderedMatrix>();
  Eigen::MatrixXd border_;
  Eigen::Matrix4d corner_ = Eigen::Matrix4d::Zero();
};

/// Replaces the rows and columns of the first two unknowns by a diagonal of the matrix's own scale.
void hold_first_node(numerics::SparseMatrix& lower);

}  // namespace supple::microscale
