#include "stiffness_outputs.h"

#include <cmath>

namespace supple::training {

StiffnessOutputs outputs_of(const Eigen::Matrix3d& factor) {
  const auto& l = factor;
  StiffnessOutputs q;
  q << std::log(l(0, 0)), std::log(l(1, 1)), std::log(l(2, 2)), l(1, 0) / l(0, 0), l(2, 0) / l(0, 0), l(2, 1) / l(1, 1);
  return q;
}

Eigen::Matrix3d factor_of(const StiffnessOutputs& outputs) {
  const auto& q = outputs;
  const Eigen::Array3d d = q.head<3>().array().exp();
  Eigen::Matrix3d l;
  l << d[0], 0, 0, q[3] * d[0], d[1], 0, q[4] * d[0], q[5] * d[1], d[2];
  return l;
}

}  // namespace supple::training
