#pragma once

#include <string_view>

namespace supple::microscale {

/// Hyperelastic laws in two dimensions. F is the deformation gradient, J = det F, C = F^T F.
enum class Law {
  /// psi = mu/2 (tr C - 2 - 2 ln J) + lambda/2 (ln J)^2 with mu = E / (2 (1 + nu)) and lambda = E nu / ((1 + nu) (1 - 2
  /// nu)) [Bonet2008, eq. 6.27]. It is the law of the published data [LiCoros2023].
  neo_hookean,
  /// psi = mu/2 (tr C + 1/J^2 - 3) with mu = E/3: an incompressible sheet whose thickness is free to change by 1/J.
  incompressible_plane_stress
};
std::string_view to_string(Law law);

/// The material of the solid. Simulator checks that E > 0 and, for neo_hookean, that -1 < nu < 0.4999.
struct Material {
  Law law = Law::neo_hookean;
  double youngs_modulus = 26;   ///< MPa
  double poisson_ratio = 0.48;  ///< not used by incompressible_plane_stress
};

}  // namespace supple::microscale
