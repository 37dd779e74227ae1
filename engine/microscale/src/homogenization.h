#pragma once

#include <Eigen/Core>

namespace supple::microscale {

/// Green strain (E_xx, E_yy, E_xy) of a deformation gradient.
Eigen::Vector3d green_strain(const Eigen::Matrix2d& f);

/// Second Piola-Kirchhoff stress (S_xx, S_yy, S_xy) = F^-1 P for dE/dF of a patch (components xx, xy, yx, yy) and the
/// patch's rest area: the derivative of the minimized energy density with respect to Green strain (thesis eq. 4.4; the
/// multipliers of the prescribed strain, by the envelope theorem).
Eigen::Vector3d second_piola_kirchhoff(const Eigen::Matrix2d& f, const Eigen::Vector4d& strain_gradient, double area);

/// d (S_xx, S_yy, S_xy) / d (E_xx, E_yy, 2 E_xy) for the patch's condensed d2E/dF2: with H = F^-T dE for a variation dE
/// of the Green strain, C(dE, dE') = H : A : H' - S : sym(H^T H').
Eigen::Matrix3d tangent_stiffness(const Eigen::Matrix2d& f, const Eigen::Vector3d& stress,
                                  const Eigen::Matrix4d& condensed, double area);

}  // namespace supple::microscale
