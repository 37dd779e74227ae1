#pragma once

#include <string_view>

namespace supple::microscale {

/// Hyperelastic laws in two dimensions. F is the deformation gradient, J = det F, C = F^T F.
enum class Law {
  /// psi = mu/2 (tr C - 2 - 2 ln J) + lambda/2 (ln J)^2 with lambda = E nu / ((1 + nu) (1 - 2 nu)): the law of the
  /// published data.
  neo_hookean,
  /// psi = mu/2 (tr C + 1/J^2 - 3), mu = E/3: an incompressible sheet that is free to change its thickness by 1/J.
  incompressible_plane_stress
};
std::string_view to_string(Law law);

/// The material of the solid. Throws nothing: Simulator checks E > 0 and -1 < nu < 0.5.
struct Material {
  Law law = Law::neo_hookean;
  double youngs_modulus = 26;   ///< MPa
  double poisson_ratio = 0.48;  ///< unused by incompressible_plane_stress
};

}  // namespace supple::microscale
