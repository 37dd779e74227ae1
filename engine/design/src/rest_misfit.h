#pragma once

#include <Eigen/Core>
#include <vector>

#include "supple/design/target.h"

namespace supple::design {

/// The entries of a lower triangular L of three rows, in the order 00, 10, 20, 11, 21, 22.
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

Eigen::Matrix3d factor_of(const Vector6& entries);
Vector6 entries_of(const Eigen::Matrix3d& factor);

/// The stress (s_xx, s_yy, s_xy) of a unit load along a direction, and the vector whose product with a strain
/// (e_xx, e_yy, 2 e_xy) is the strain lateral to the direction.
struct LoadVectors {
  Eigen::Vector3d stress;
  Eigen::Vector3d lateral;
};
LoadVectors load_vectors(double direction);

/// Half the mean squared relative deviation of a material's profiles at rest from targets of stiffness and Poisson's
/// ratio, as a function of L in its compliance S = least + L L^T. Both are quotients of quadratic functions of L: 1 /
/// S11 and -S12 / S11.
class RestMisfit {
 public:
  /// `unit` is the unit of stiffness in MPa. Compliances, `least` among them, are in 1 / `unit`.
  RestMisfit(const Eigen::Matrix3d& least, double unit);
  /// `weight` is the factor of the target's mean squared relative deviation.
  void add(const SampledTarget& target, double weight);

  double value(const Vector6& entries) const;
  void derivatives(const Vector6& entries, Vector6& gradient, Matrix6& hessian) const;
  /// S - least for the S that fits S11 = 1 / y and S12 = -y S11 best by least squares. It need not be positive. If
  /// there is no stiffness, the mean of S11 is 1.
  Eigen::Matrix3d linear_fit() const;

 private:
  struct Sample {
    double y = 0;
    double band = 0;
    double weight = 0;            ///< factor of the squared deviation
    double numerator_offset = 0;  ///< constant of the quotient's numerator: 1 of a stiffness
    Matrix6 numerator;            ///< quadratic form of the numerator: that of -S12, or 0
    double axial_offset = 0;      ///< constant of S11
    Matrix6 axial;                ///< quadratic form of S11
    LoadVectors load;
    bool is_stiffness = true;
  };

  Eigen::Matrix3d least_;
  double unit_;
  std::vector<Sample> samples_;
};

}  // namespace supple::design
