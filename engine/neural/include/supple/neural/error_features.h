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

/// The properties of a design on which its error bars depend.
struct DesignFeatures {
  Eigen::VectorXd mapped;            ///< parameters, mapped linearly from their bounds to [-1, 1]
  double rest_stiffness = 1;         ///< BasicEvaluator::Design::rest_stiffness, MPa
  Eigen::Matrix3d rest_tangent;      ///< MPa; used by uniaxial_features only
  Eigen::Vector3d rest_eigenvalues;  ///< eigenvalues of the rest tangent, increasing
};
/// Computes these properties. `rest_tangent` is the tangent of the network at zero strain.
DesignFeatures design_features(const Network& network, std::span<const double> parameters, double rest_stiffness,
                               const Eigen::Matrix3d& rest_tangent = Eigen::Matrix3d::Identity());

/// The features of a uniaxial equilibrium of the network, on which the error bars of stress, stiffness and Poisson's
/// ratio depend. They are the parameters, the strains, the energy, and the ratio of the stiffness to that at rest,
/// which shows whether the structure has buckled. `axial_strain` is d^T E d. There are parameters + 19 features. They
/// are finite at rest too, where secants are replaced by tangents.
Eigen::VectorXd uniaxial_features(const DesignFeatures& design, const UniaxialFrame& frame, double axial_strain,
                                  const Eigen::Vector3d& strain, const UniaxialPoint& point);

/// The features of any strain (E_xx, E_yy, 2 E_xy), on which the error bar of the stress there depends. There are
/// parameters + 16 features. They require no tangent.
Eigen::VectorXd strain_features(const DesignFeatures& design, const Eigen::Vector3d& strain, double energy_density,
                                const Eigen::Vector3d& stress);

/// The number of features for a network with this number of parameters.
inline Eigen::Index uniaxial_feature_count(int parameters) { return parameters + 19; }
inline Eigen::Index strain_feature_count(int parameters) { return parameters + 16; }

}  // namespace supple::neural
