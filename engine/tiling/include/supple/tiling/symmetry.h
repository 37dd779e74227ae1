#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/tiling/family.h"

namespace supple::tiling {

/// A rotation or reflection that carries the tiling at parameters p, up to a translation, to the tiling at
/// `linear` * p + `constant`: often the same, in some families another one of them, such as the mirror image.
struct FamilySymmetry {
  Eigen::Matrix2d operation;
  Eigen::MatrixXd linear;  ///< parameters x parameters
  Eigen::VectorXd constant;

  Eigen::VectorXd image(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
    return linear * parameters + constant;
  }
};

/// Those that hold all over the family, the identity first. Found from the edges of the tiling at two places of the box
/// among the rotations by multiples of 30 degrees and the reflections in lines as far apart, which are those of the
/// plane's lattices along the axes; images may lie out of bounds. Milliseconds.
std::vector<FamilySymmetry> symmetries(const Family& family);

}  // namespace supple::tiling
