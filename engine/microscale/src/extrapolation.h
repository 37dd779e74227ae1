#pragma once

#include <Eigen/Core>

#include "supple/microscale/simulation.h"

namespace supple::microscale {

/// What an equilibrium gives as sums over the patch.
struct PatchResponse {
  Eigen::Matrix2d deformation_gradient = Eigen::Matrix2d::Identity();
  Eigen::Vector4d strain_gradient = Eigen::Vector4d::Zero();  ///< dE / dF, components as in CellCoordinates
  Eigen::Matrix4d condensed = Eigen::Matrix4d::Zero();        ///< d2 E / dF2 of the minimized energy
  double energy = 0;                                          ///< MPa mm^2
};

/// A response on a mesh of vanishing size, from those on a mesh and on the one with each triangle divided in four
/// (Richardson's extrapolation with a fixed rate). It is linear in both: the gradient stays the derivative of the
/// energy, prescribed components of F are exact, and free directions stay free of force.
PatchResponse extrapolate(const PatchResponse& coarse, const PatchResponse& fine);

/// The estimated errors of the two meshes' extrapolation, and of the coarse mesh: of stress and energy density, MPa,
/// for a patch of the rest area `area`.
MeshError extrapolation_error(const PatchResponse& coarse, const PatchResponse& fine, double area);
MeshError coarse_error(const PatchResponse& coarse, const PatchResponse& fine, double area);

}  // namespace supple::microscale
