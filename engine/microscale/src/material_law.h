#pragma once

#include "supple/microscale/material.h"

namespace supple::microscale {

/// The constants of an isotropic law psi(F) = mu/2 (tr C - 2) + g(J). Both laws of `Law` have this form:
/// neo-Hookean g = -mu ln J + lambda/2 (ln J)^2, incompressible plane stress g = mu/2 (1/J^2 - 1).
///
/// With a = J g' and b = J (J g')', the first Piola-Kirchhoff stress and its derivative are
///   P = mu F + a F^-T,
///   dP_ik / dF_jl = mu d_ij d_kl + b F^-T_ik F^-T_jl - a F^-T_il F^-T_jk.
struct MaterialLaw {
  explicit MaterialLaw(const Material& material) : law(material.law) {
    const double e = material.youngs_modulus;
    const double nu = material.poisson_ratio;
    if (law == Law::neo_hookean) {
      mu = e / (2 * (1 + nu));
      lambda = e * nu / ((1 + nu) * (1 - 2 * nu));
    } else {
      mu = e / 3;
    }
  }

  Law law;
  double mu = 0;      ///< MPa
  double lambda = 0;  ///< MPa; used by neo-Hookean only
};

}  // namespace supple::microscale
