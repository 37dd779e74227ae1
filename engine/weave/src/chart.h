#pragma once

#include <Eigen/Core>
#include <vector>

#include "rod_model.h"

namespace supple::weave {

/// What angles and rotations of a spatial weave are measured from. Reference directors are carried along with their
/// edges by parallel transport in time (Bergou et al. 2010), joints by their rotations; a chart at the state itself
/// keeps both far from any singularity. Changing the chart changes coordinates, never energies.
struct Chart {
  std::vector<Eigen::Vector3d> tangent;   ///< of each edge
  std::vector<Eigen::Vector3d> director;  ///< reference director d1, orthogonal to it
  std::vector<Eigen::Matrix3d> joint;     ///< rotation of each joint
  std::vector<double> twist;              ///< of the reference directors at each turn, rad, with all its turns
};

/// For a flat state: directors lie in the plane (the rest curves' normals), joints are turned by the angles given
/// (rad; empty: none).
Chart flat_chart(const RodModel& model, const Eigen::VectorXd& q, const std::vector<double>& joint_angles = {});

/// The chart at q, and q in its coordinates: the joints' unknowns become 0. q is seen from `chart`, no edge of it
/// opposite to where it was there.
Chart rebase(const RodModel& model, const Chart& chart, Eigen::VectorXd& q);

/// v, orthogonal to the unit vector `from`, turned along the shortest way that takes `from` to the unit vector `to`.
Eigen::Vector3d transport(const Eigen::Vector3d& v, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Cayley's rotation by w: 2 atan(|w| / 2) about w; it agrees with the exponential to third order.
Eigen::Matrix3d cayley(const Eigen::Vector3d& w);

/// Tangent, in-plane normal and z of a strand's rest curve where a joint holds it, as columns.
Eigen::Matrix3d rest_frame(const RodModel& model, const Turn& turn);

}  // namespace supple::weave
