#pragma once

#include "supple/base/random.h"
#include "supple/design/rest_shape.h"

namespace supple::design {

/// A compliance that is symmetric and positive definite, with no eigenvalue below `least`.
inline Compliance random_compliance(RandomStream& random, double least = 1e-3) {
  Eigen::Matrix3d factor;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) factor(i, j) = random.uniform(-1, 1);
  return factor * factor.transpose() + least * Compliance::Identity();
}

}  // namespace supple::design
