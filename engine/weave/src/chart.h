#pragma once

#include <Eigen/Core>
#include <vector>

#include "rod_model.h"

namespace supple::weave {

/// Reference frames of the edges and joints of a spatial weave, from which angles and rotations are measured. The
/// reference directors of an edge follow it by parallel transport in time [Bergou2010], and joints follow their
/// rotations. A chart at the state itself keeps both far from any singularity. Changing the chart changes coordinates,
/// never energies.
struct Chart {
  std::vector<Eigen::Vector3d> tangent;   ///< unit tangent of each edge
  std::vector<Eigen::Vector3d> director;  ///< reference director d1 of each edge, orthogonal to its tangent
  std::vector<Eigen::Matrix3d> joint;     ///< rotation of each joint
  std::vector<double> twist;  ///< twist of the reference directors at each Turn of the model, rad, with all revolutions
};

/// The chart of a flat state q. Directors lie in the plane, normal to their edges. Joints are rotated about z by the
/// angles given (rad; empty for 0).
Chart flat_chart(const RodModel& model, const Eigen::VectorXd& q, const std::vector<double>& joint_angles = {});

/// Returns the chart at q, and converts q, which refers to `chart`, to the new one: the joints' unknowns become 0. No
/// edge may point opposite to its tangent in `chart`.
Chart rebase(const RodModel& model, const Chart& chart, Eigen::VectorXd& q);

/// Parallel transport of v, which is orthogonal to the unit vector `from`: the rotation by the smallest angle that
/// takes `from` to the unit vector `to`.
Eigen::Vector3d transport(const Eigen::Vector3d& v, const Eigen::Vector3d& from, const Eigen::Vector3d& to);

/// Cayley's rotation by w: by the angle 2 atan(|w| / 2) about w. It agrees with the exponential map to third order.
Eigen::Matrix3d cayley(const Eigen::Vector3d& w);

/// Tangent, in-plane normal and z of a strand's rest curve at a Turn of the model, as columns.
Eigen::Matrix3d rest_frame(const RodModel& model, const Turn& turn);

}  // namespace supple::weave
