#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/numerics/hessian_entries.h"

namespace supple::numerics {

/// What a minimization may change of a state's degrees of freedom: each of the first ones is free or held; the last
/// few, the border, couple with all others and move along given directions only.
///
/// The unknowns are the free degrees of freedom in their order, then one number for each direction.
class Unknowns {
 public:
  /// All of them, without a border.
  explicit Unknowns(Eigen::Index degrees_of_freedom)
      : Unknowns(std::vector<bool>(static_cast<std::size_t>(degrees_of_freedom), false)) {}
  /// `held` says of each whether it is.
  explicit Unknowns(const std::vector<bool>& held) : Unknowns(held, Eigen::MatrixXd(0, 0)) {}
  /// The border's degrees of freedom follow those of `held`: as many as `directions` has rows; its columns are
  /// orthonormal.
  Unknowns(const std::vector<bool>& held, Eigen::MatrixXd directions);

  Eigen::Index degrees_of_freedom() const { return below_border() + directions_.rows(); }
  Eigen::Index below_border() const { return static_cast<Eigen::Index>(numbering_.size()); }
  Eigen::Index core() const { return core_; }  ///< free ones below the border
  Eigen::Index size() const { return core_ + directions_.cols(); }
  const Numbering& numbering() const { return numbering_; }
  const Eigen::MatrixXd& directions() const { return directions_; }

  /// A change y of the unknowns as one of all degrees of freedom; 0 where held.
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const;
  /// The part of a change of all degrees of freedom, or of derivatives by them, that belongs to the unknowns.
  Eigen::VectorXd restrict(const Eigen::VectorXd& x) const;
  /// Rows of the core's unknowns at the places of their degrees of freedom below the border; 0 where held.
  Eigen::MatrixXd expand_core(const Eigen::MatrixXd& rows) const;

 private:
  Numbering numbering_;
  Eigen::Index core_ = 0;
  Eigen::MatrixXd directions_;
};

}  // namespace supple::numerics
