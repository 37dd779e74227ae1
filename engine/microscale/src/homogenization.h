#pragma once

#include <Eigen/Core>

namespace supple::microscale {

/// Green strain (E_xx, E_yy, E_xy) of a deformation gradient.
Eigen::Vector3d green_strain(const Eigen::Matrix2d& f);

/// Second Piola-Kirchhoff stress (S_xx, S_yy, S_xy) = F^-1 P, where P is dE/dF of a patch (components xx, xy, yx, yy)
/// divided by the patch's rest area. It is the derivative of the minimized energy density with respect to Green strain
/// [Thesis, eq. 4.4], and consists of the Lagrange multipliers of the prescribed strain (envelope theorem).
Eigen::Vector3d second_piola_kirchhoff(const Eigen::Matrix2d& f, const Eigen::Vector4d& strain_gradient, double area);

/// Tangent stiffness C = d (S_xx, S_yy, S_xy) / d (E_xx, E_yy, 2 E_xy). `condensed` is d2E/dF2 of the patch's minimized
/// energy; A below is `condensed` divided by the rest area. With H = F^-T dE for a variation dE of the Green strain,
/// C(dE, dE') = H : A : H' - S : sym(H^T H').
Eigen::Matrix3d tangent_stiffness(const Eigen::Matrix2d& f, const Eigen::Vector3d& stress,
                                  const Eigen::Matrix4d& condensed, double area);

}  // namespace supple::microscale
