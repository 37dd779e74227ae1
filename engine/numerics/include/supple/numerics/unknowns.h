#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/numerics/hessian_entries.h"

namespace supple::numerics {

/// The part of a state's degrees of freedom that a minimization may change.
///
/// The last few degrees of freedom are the border: they couple with all others, and move along given directions only.
/// Each of the others is free or fixed. The unknowns are the free ones in their order, then one number for each
/// direction.
class Unknowns {
 public:
  /// All degrees of freedom, without a border.
  explicit Unknowns(Eigen::Index degrees_of_freedom)
      : Unknowns(std::vector<bool>(static_cast<std::size_t>(degrees_of_freedom), false)) {}
  /// `fixed` says for each degree of freedom whether it is fixed.
  explicit Unknowns(const std::vector<bool>& fixed) : Unknowns(fixed, Eigen::MatrixXd(0, 0)) {}
  /// The degrees of freedom of the border follow those of `fixed`. `directions` has a row for each of them, and
  /// orthonormal columns.
  Unknowns(const std::vector<bool>& fixed, Eigen::MatrixXd directions);

  Eigen::Index degrees_of_freedom() const { return below_border() + directions_.rows(); }
  Eigen::Index below_border() const { return static_cast<Eigen::Index>(numbering_.size()); }
  Eigen::Index core() const { return core_; }  ///< number of free degrees of freedom below the border
  Eigen::Index size() const { return core_ + directions_.cols(); }
  const Numbering& numbering() const { return numbering_; }
  const Eigen::MatrixXd& directions() const { return directions_; }

  /// Writes a change y of the unknowns as a change of all degrees of freedom, which is 0 for fixed ones.
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const;
  /// The entries of x that belong to the unknowns. x is a change of all degrees of freedom, or a vector of derivatives
  /// with respect to them.
  Eigen::VectorXd restrict(const Eigen::VectorXd& x) const;
  /// Copies the rows of the core's unknowns to the rows of their degrees of freedom below the border. Rows of fixed
  /// ones are 0.
  Eigen::MatrixXd expand_core(const Eigen::MatrixXd& rows) const;

 private:
  Numbering numbering_;
  Eigen::Index core_ = 0;
  Eigen::MatrixXd directions_;
};

}  // namespace supple::numerics
