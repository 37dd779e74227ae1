#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/neural/evaluator.h"

namespace supple::neural {

/// A strain seen through maps e -> T e as well as it is, and the mean of what an energy answers to all of them: an
/// energy that has the maps' symmetry, where they and the identity are a group.
class StrainImages {
 public:
  /// Of some maps without the identity.
  explicit StrainImages(const std::vector<Eigen::Matrix3d>& maps);

  bool none() const { return pullbacks_.empty(); }
  /// The strains as they are, then through one map after another.
  void see(const Eigen::Ref<const Eigen::Matrix3Xd>& strains, Eigen::Matrix3Xd& images) const;
  /// The mean over a strain and its images, with derivatives by the strain as it is.
  void mean(const Evaluation& of_images, long strains, Evaluation& answer) const;

 private:
  /// Derivatives by e of a function of T e, from those by T e: linear maps of the components that `Evaluation` lists.
  struct Pullback {
    Eigen::Matrix3d map;
    Eigen::Matrix3d stress;
    Eigen::Matrix<double, 6, 6> tangent;
    Eigen::Matrix<double, 10, 10> third;
  };
  std::vector<Pullback> pullbacks_;
};

}  // namespace supple::neural
