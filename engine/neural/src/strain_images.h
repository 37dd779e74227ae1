#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/neural/evaluator.h"

namespace supple::neural {

/// The images T e of strains e, and the mean of an energy over a strain and its images. If the maps T and the identity
/// are a group, the mean has its symmetry.
class StrainImages {
 public:
  /// `maps` does not contain the identity.
  explicit StrainImages(const std::vector<Eigen::Matrix3d>& maps);

  bool empty() const { return pullbacks_.empty(); }
  /// Sets `images` to the strains themselves, followed by their images under one map after another.
  void map_strains(const Eigen::Ref<const Eigen::Matrix3Xd>& strains, Eigen::Matrix3Xd& images) const;
  /// Sets `answer` to the mean over each strain and its images, with derivatives with respect to the strain itself.
  /// `of_images` is the evaluation of what map_strains has returned for `strains` strains.
  void average(const Evaluation& of_images, long strains, Evaluation& answer) const;

 private:
  /// Linear maps from the derivatives of a function of T e with respect to T e to those with respect to e. Components
  /// are in the order of `Evaluation`.
  struct Pullback {
    Eigen::Matrix3d map;
    Eigen::Matrix3d stress;
    Eigen::Matrix<double, 6, 6> tangent;
    Eigen::Matrix<double, 10, 10> third;
  };
  std::vector<Pullback> pullbacks_;  ///< beginning with the identity; empty if there are no maps
};

}  // namespace supple::neural
