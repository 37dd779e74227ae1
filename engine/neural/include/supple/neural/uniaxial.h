#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "supple/base/execution.h"
#include "supple/neural/evaluator.h"
#include "supple/neural/uniaxial_newton.h"

namespace supple::neural {

/// An equilibrium under a uniaxial load. The Green strain along d is given, and the stress does no work on the other
/// components of strain.
struct UniaxialState {
  Eigen::Vector3d strain = Eigen::Vector3d::Zero();   ///< E_xx, E_yy, 2 E_xy
  Eigen::Vector3d stress = Eigen::Vector3d::Zero();   ///< S_xx, S_yy, S_xy, MPa
  double directional_stress = 0;                      ///< d^T S d, MPa
  double energy_density = 0;                          ///< MPa
  Eigen::Matrix3d tangent = Eigen::Matrix3d::Zero();  ///< MPa
  bool converged = false;
  double residual = 0;  ///< uniaxial_residual, which UniaxialOptions::tolerance bounds
  int iterations = 0;   ///< Newton iterations of this state
};

/// The states of least energy for given strains E_dd = d^T E d, where d = (cos, sin) of `direction` (rad); see
/// [Thesis, eq. 4.9c]. UniaxialNewton finds each state from the one before it in `green_strains`. A state takes about 3
/// to 6 evaluations with tangents. The strains along d must be > -1/2 (a stretch > 0), otherwise "model.invalid_load"
/// is thrown. A state that is not reached has converged = false. Its numbers are not finite if the energy overflowed.
template <class Real>
std::vector<UniaxialState> uniaxial_path(const BasicEvaluator<Real>& evaluator,
                                         const typename BasicEvaluator<Real>::Design& design, double direction,
                                         std::span<const double> green_strains, const UniaxialOptions& options = {},
                                         const Execution& execution = {});

/// The Green strain E_dd that belongs to a stretch.
inline double green_strain_of_stretch(double stretch) { return 0.5 * (stretch * stretch - 1); }

}  // namespace supple::neural
