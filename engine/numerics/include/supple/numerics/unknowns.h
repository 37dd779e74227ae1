#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/numerics/hessian_entries.h"

namespace supple::numerics {

/// The part of a state's degrees of freedom that a minimization may change. Each of the first ones is free or held. The
/// last few are the border: they couple with all others and move along given directions only.
///
/// The unknowns are the free degrees of freedom in their order, then one number for each direction.
class Unknowns {
 public:
  /// All degrees of freedom, without a border.
  explicit Unknowns(Eigen::Index degrees_of_freedom)
      : Unknowns(std::vector<bool>(static_cast<std::size_t>(degrees_of_freedom), false)) {}
  /// `held` says for each degree of freedom whether it is held.
  explicit Unknowns(const std::vector<bool>& held) : Unknowns(held, Eigen::MatrixXd(0, 0)) {}
  /// The border's degrees of freedom follow those of `held`: as many as `directions` has rows; its columns are
  /// orthonormal.
  Unknowns(const std::vector<bool>& held, Eigen::MatrixXd directions);

  Eigen::Index degrees_of_freedom() const { return below_border() + directions_.rows(); }
  Eigen::Index below_border() const { return static_cast<Eigen::Index>(numbering_.size()); }
  Eigen::Index core() const { return core_; }  ///< number of free degrees of freedom below the border
  Eigen::Index size() const { return core_ + directions_.cols(); }
  const Numbering& numbering() const { return numbering_; }
  const Eigen::MatrixXd& directions() const { return directions_; }

  /// A change y of the unknowns as a change of all degrees of freedom; 0 for those that are held.
  Eigen::VectorXd expand(const Eigen::VectorXd& y) const;
  /// The part of a change of all degrees of freedom, or of derivatives by them, that belongs to the unknowns.
  Eigen::VectorXd restrict(const Eigen::VectorXd& x) const;
  /// The rows of the core's unknowns at the places of their degrees of freedom below the border; 0 for held ones.
  Eigen::MatrixXd expand_core(const Eigen::MatrixXd& rows) const;

 private:
  Numbering numbering_;
  Eigen::Index core_ = 0;
  Eigen::MatrixXd directions_;
};

}  // namespace supple::numerics
