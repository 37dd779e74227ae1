#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "supple/base/execution.h"
#include "supple/weave/equilibrium.h"
#include "supple/weave/weave.h"

namespace supple::weave {

struct HomogenizationOptions {
  EquilibriumOptions equilibrium{};
  /// The stretch minus one along each direction. It lies within [-0.5, 2] and is not 0.
  double strain = 0.1;
  /// The directions in rad; see `directions_over_half_turn`.
  std::vector<double> directions{};
  /// If true, the stress is uniaxial, and lateral strain and shear are free. If false, the shear relative to the
  /// direction is suppressed and the lateral strain is free, as in published results.
  bool shear_free = true;
  std::optional<double> thickness{};  ///< mm; needed for moduli in MPa
  std::vector<int> deformed{};        ///< indices of directions whose deformed strands are wanted
};

/// Returns `count` directions pi k / count, k = 0, ..., count - 1.
std::vector<double> directions_over_half_turn(int count);

/// One equilibrium of the periodic cell.
struct CellState {
  Eigen::Matrix2d deformation_gradient = Eigen::Matrix2d::Identity();
  /// First Piola-Kirchhoff stress resultant (1 / A) dE / dF, where A is the cell's area at rest; N/m.
  Eigen::Matrix2d nominal_stress = Eigen::Matrix2d::Zero();
  /// Cauchy stress resultant P F^T / det F; N/m. It is zero if the cell is folded flat.
  Eigen::Matrix2d cauchy_stress = Eigen::Matrix2d::Zero();
  double energy_density = 0;    ///< N/m, per area at rest
  std::vector<double> sliding;  ///< displacement along its strand of every member that slides, crossing by crossing; mm
  std::vector<std::vector<Eigen::Vector3d>> strands;  ///< deformed polylines, mm; empty unless asked for
  bool out_of_plane = false;
  /// Whether the tangent stiffness is positive definite. It always is if buckling is followed to its end.
  bool stable = true;
  Stop stopped = Stop::converged;
  double residual = 0;   ///< |g|, N; at most `tolerance` if it converged
  double tolerance = 0;  ///< N
  /// Estimated relative error of the energy because sliders do not reach their limits. It is at most
  /// EquilibriumOptions::limit_tolerance, unless no equilibrium with rigid limits was found nearby.
  double limit_error = 0;
  /// Estimates of the errors of `cauchy_stress` (N/m, Frobenius norm) and `energy_density` (N/m) because of the rods'
  /// resolution and sliders short of their limits. Only `deform_cells` sets them; NaN if they were not estimated.
  double stress_error = std::numeric_limits<double>::quiet_NaN();
  double energy_error = std::numeric_limits<double>::quiet_NaN();
  int iterations = 0;
  int load_steps = 0;
  int branches = 0;  ///< number of unstable equilibria that were left on the path
};

struct DirectionalResponse {
  double direction = 0;  ///< rad
  /// d^T sigma d / (stretch - 1) with the Cauchy stress resultant sigma, N/m [Thesis, eq. 2.2]. NaN if the state did
  /// not converge or folded flat.
  double youngs_modulus = std::numeric_limits<double>::quiet_NaN();
  /// `youngs_modulus` divided by the thickness, MPa; NaN without a thickness.
  double youngs_modulus_mpa = std::numeric_limits<double>::quiet_NaN();
  /// -n^T (F - 1) n / (stretch - 1), where n is the normal of the direction.
  double poisson_ratio = std::numeric_limits<double>::quiet_NaN();
  /// Estimates of the errors of `youngs_modulus` (N/m) and `poisson_ratio`: what the rods' resolution makes, and what
  /// the tolerance and sliders short of their limits leave. The error is smaller in at least 90 of 100 directions. NaN
  /// if it was not estimated, or the state of the other resolution did not converge.
  double youngs_modulus_error = std::numeric_limits<double>::quiet_NaN();
  double poisson_ratio_error = std::numeric_limits<double>::quiet_NaN();
  CellState state;
};

/// Strains a periodic weave uniaxially in each direction, from rest. The deformation gradient F obeys F^T d = stretch d
/// exactly. Directions are computed in parallel, and results do not depend on the number of threads.
///
/// If the energies of neighbouring directions, at most 0.16 rad apart, differ by more than their derivatives explain,
/// the direction of higher energy is computed again from the state of the other one, and the lower energy is the
/// answer. If there are fewer than 20 directions, each direction whose path left an unstable equilibrium is instead
/// compared with a path of three times as many load steps.
///
/// Reports progress by directions. Bills every term, "out-of-plane stability" and the effects. Throws what `validate`
/// throws, "weave.invalid_option", and "weave.not_periodic" if there is no lattice. A direction that cannot be followed
/// to its end is no error: its state says why.
std::vector<DirectionalResponse> homogenize(const Weave& weave, const HomogenizationOptions& options,
                                            const Execution& execution = {});

/// Computes the equilibrium under a given deformation gradient (det > 0). The gradient is imposed exactly and reached
/// in a straight line from rest. `polylines` says whether CellState::strands is filled. Throws what `homogenize`
/// throws, and "weave.invalid_load" for a gradient that is not finite or has no positive determinant.
CellState deform_cell(const Weave& weave, const Eigen::Matrix2d& deformation_gradient,
                      const EquilibriumOptions& options = {}, const Execution& execution = {}, bool polylines = false);

/// Computes the equilibria under several deformation gradients in parallel, each from rest. Results do not depend on
/// the number of threads. `deformed` has the indices of the gradients for which CellState::strands is filled. Reports
/// progress by gradients, and bills like `homogenize`. Errors name entries of "deformation_gradients" and "deformed".
std::vector<CellState> deform_cells(const Weave& weave, const std::vector<Eigen::Matrix2d>& deformation_gradients,
                                    const EquilibriumOptions& options = {}, const std::vector<int>& deformed = {},
                                    const Execution& execution = {});

}  // namespace supple::weave
