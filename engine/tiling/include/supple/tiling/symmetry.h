#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/tiling/family.h"

namespace supple::tiling {

/// A rotation or reflection that maps the tiling at parameters p, up to a translation, to the tiling at `linear` * p +
/// `constant`. Often this is the same tiling. In some families it is another one, such as the mirror image.
struct FamilySymmetry {
  Eigen::Matrix2d operation;
  Eigen::MatrixXd linear;  ///< parameters x parameters
  Eigen::VectorXd constant;

  Eigen::VectorXd image(const Eigen::Ref<const Eigen::VectorXd>& parameters) const {
    return linear * parameters + constant;
  }
};

/// The symmetries that hold all over the family, beginning with the identity. They are found from the edges of the
/// tiling at two points of the box, among the rotations by multiples of 30 degrees and the reflections in lines that
/// are 30 degrees apart. These are all symmetries of lattices of the plane that lie along the axes. Images may lie out
/// of bounds. This takes milliseconds.
std::vector<FamilySymmetry> symmetries(const Family& family);

}  // namespace supple::tiling
