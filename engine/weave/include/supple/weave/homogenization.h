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
  /// Stretch minus one along each direction, within [-0.5, 2], not 0.
  double strain = 0.1;
  /// rad; see `directions_over_half_turn`.
  std::vector<double> directions{};
  /// true: uniaxial stress, lateral strain and shear free. false: shear relative to the direction is suppressed,
  /// lateral strain free, as published results have it.
  bool shear_free = true;
  std::optional<double> thickness{};  ///< mm; for moduli in MPa
  std::vector<int> deformed{};        ///< indices of directions whose deformed strands are wanted
};

/// `count` directions pi k / count, k = 0, ..., count - 1.
std::vector<double> directions_over_half_turn(int count);

/// One equilibrium of the periodic cell.
struct CellState {
  Eigen::Matrix2d deformation_gradient = Eigen::Matrix2d::Identity();
  /// First Piola-Kirchhoff stress resultant (1 / A) dE / dF, A the cell's area at rest; N/m.
  Eigen::Matrix2d nominal_stress = Eigen::Matrix2d::Zero();
  /// Cauchy stress resultant P F^T / det F; N/m. Zero where folded flat.
  Eigen::Matrix2d cauchy_stress = Eigen::Matrix2d::Zero();
  double energy_density = 0;    ///< N/m, per area at rest
  std::vector<double> sliding;  ///< displacement along its strand of every member that slides, crossing by crossing; mm
  std::vector<std::vector<Eigen::Vector3d>> strands;  ///< deformed polylines, mm; where asked for
  bool out_of_plane = false;
  bool stable = true;  ///< the tangent is positive definite (always where buckling is followed to its end)
  Stop stopped = Stop::converged;
  double residual = 0;   ///< |g|, N, at most `tolerance` where converged
  double tolerance = 0;  ///< N
  int iterations = 0;
  int load_steps = 0;
  int branches = 0;  ///< unstable equilibria that were left on the way
};

struct DirectionalResponse {
  double direction = 0;  ///< rad
  /// d^T sigma d / (stretch - 1) with the Cauchy stress resultant; N/m (thesis equation 2.2). NaN where not converged
  /// or folded flat.
  double youngs_modulus = std::numeric_limits<double>::quiet_NaN();
  /// The same over the thickness, MPa; NaN without one.
  double youngs_modulus_mpa = std::numeric_limits<double>::quiet_NaN();
  /// -n^T (F - 1) n / (stretch - 1).
  double poisson_ratio = std::numeric_limits<double>::quiet_NaN();
  CellState state;
};

/// Uniaxial strain of a periodic weave in each direction, from rest. The deformation gradient F obeys F^T d = stretch d
/// exactly. Directions are computed in parallel; results do not depend on the number of threads. Reports progress by
/// directions; bills every term, "out-of-plane stability" and the effects. Throws what `validate` throws and
/// "weave.invalid_option"; "weave.not_periodic" without a lattice. A direction that cannot be followed to its end is no
/// error: its state says why.
std::vector<DirectionalResponse> homogenize(const Weave& weave, const HomogenizationOptions& options,
                                            const Execution& execution = {});

/// The equilibrium under a given deformation gradient (det > 0), imposed exactly, reached in a straight line from rest.
/// `polylines`: fill CellState::strands. Throws as `homogenize`.
CellState deform_cell(const Weave& weave, const Eigen::Matrix2d& deformation_gradient,
                      const EquilibriumOptions& options = {}, const Execution& execution = {}, bool polylines = false);

}  // namespace supple::weave
