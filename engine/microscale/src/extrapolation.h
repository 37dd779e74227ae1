#pragma once

#include <Eigen/Core>

#include "supple/microscale/simulation.h"

namespace supple::microscale {

/// Sums over the patch at an equilibrium, from which the macroscopic response is computed.
struct PatchResponse {
  Eigen::Matrix2d deformation_gradient = Eigen::Matrix2d::Identity();
  Eigen::Vector4d strain_gradient = Eigen::Vector4d::Zero();  ///< dE / dF, components as in CellCoordinates
  Eigen::Matrix4d condensed = Eigen::Matrix4d::Zero();        ///< d2 E / dF2 of the minimized energy
  double energy = 0;                                          ///< MPa mm^2
};

/// The estimated response on a mesh of vanishing size, from the responses on a mesh and on the one with each triangle
/// divided in four (Richardson extrapolation with a fixed rate of convergence). It is a linear combination of the two.
/// Therefore the gradient remains the derivative of the energy, prescribed components of F are exact, and there are no
/// forces along the free directions.
PatchResponse extrapolate(const PatchResponse& coarse, const PatchResponse& fine);

/// The estimated errors of the extrapolated response and of the coarse mesh, in stress and energy density, MPa. `area`
/// is the rest area of the patch.
MeshError extrapolation_error(const PatchResponse& coarse, const PatchResponse& fine, double area);
MeshError coarse_error(const PatchResponse& coarse, const PatchResponse& fine, double area);

}  // namespace supple::microscale
