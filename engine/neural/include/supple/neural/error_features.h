#pragma once

#include <Eigen/Core>
#include <span>

#include "supple/neural/network.h"
#include "supple/neural/uniaxial_frame.h"
#include "supple/neural/uniaxial_newton.h"

namespace supple::neural {

/// Stiffness d(d^T S d) / d(d^T E d) and Poisson's ratio -d(n^T E n) / d(d^T E d) along the path of a uniaxial load.
struct PathSlopes {
  double stiffness = 0;
  double poisson = 0;
};
PathSlopes path_slopes(const UniaxialFrame& frame, const Eigen::Matrix3d& tangent);

/// What of a design its error bars are read from.
struct DesignFeatures {
  Eigen::VectorXd mapped;         ///< parameters, from their bounds to [-1, 1]
  double rest_stiffness = 1;      ///< Evaluator::Design::rest_stiffness, MPa
  Eigen::Matrix3d rest_tangent;   ///< MPa; of uniaxial_features alone
  Eigen::Vector3d rest_stiffest;  ///< its eigenvalues, increasing
};
/// `rest_tangent` is that of the network at zero strain.
DesignFeatures design_features(const Network& network, std::span<const double> parameters, double rest_stiffness,
                               const Eigen::Matrix3d& rest_tangent = Eigen::Matrix3d::Identity());

/// Features of a uniaxial equilibrium of the network, for the bars of stress, stiffness and Poisson's ratio:
/// parameters, strains, energy, and how the stiffness there compares with that at rest, which tells buckled states.
/// `given` is d^T E d. Finite also at rest, where secants are tangents. As many as parameters + 19.
Eigen::VectorXd uniaxial_features(const DesignFeatures& design, const UniaxialFrame& frame, double given,
                                  const Eigen::Vector3d& strain, const UniaxialPoint& point);

/// Features of any strain (E_xx, E_yy, 2 E_xy), for the bar of the stress there; they need no tangent. As many as
/// parameters + 16.
Eigen::VectorXd strain_features(const DesignFeatures& design, const Eigen::Vector3d& strain, double energy_density,
                                const Eigen::Vector3d& stress);

/// Number of features of a quantity of a network with so many parameters.
inline Eigen::Index uniaxial_feature_count(int parameters) { return parameters + 19; }
inline Eigen::Index strain_feature_count(int parameters) { return parameters + 16; }

}  // namespace supple::neural
