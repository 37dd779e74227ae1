#include "euclidean_springs.h"

#include <cmath>

#include "element_energies.h"
#include "supple/surface/vertex_cone.h"

namespace supple::embedded {
namespace {

/// Number of directions at a vertex of which the steepest is taken.
constexpr int directions_at_vertex = 256;

using Frame = Eigen::Matrix<double, 3, 2>;

/// The negative of the steepest descent at a vertex, in cone_coordinates. It takes the place of the gradient, of which
/// each face has its own there. Zero if no direction descends.
Eigen::Vector2d steepest_descent_at_vertex(const NetworkState& state, std::size_t point,
                                           const Eigen::Vector3d& gradient) {
  const surface::VertexCone cone(state.mesh(), state.vertex_of(point));
  double least = 0;
  double at = 0;
  for (int k = 0; k < directions_at_vertex; ++k) {
    const double angle = (k + 0.5) / directions_at_vertex * cone.total_angle();
    const double slope = gradient.dot(cone.direction(angle).vector);
    if (slope >= least) continue;
    least = slope;
    at = angle;
  }
  return least * surface::cone_coordinates(cone, at);
}

}  // namespace

void EuclideanSprings::add(const NetworkState& state, int order, numerics::EnergySum& sum) const {
  const auto& points = state.points();
  std::vector<Eigen::Vector3d> positions(points.size());
  std::vector<Frame> frames(order >= 1 ? points.size() : 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    positions[i] = surface::position(state.mesh(), points[i]);
    if (order < 1) continue;
    frames[i] = state.on_tip(i) ? Frame(Frame::Zero()) : Frame(surface::tangent_frame(state.mesh(), points[i].face));
  }
  std::vector<Eigen::Vector3d> vertex_gradients(points.size(), Eigen::Vector3d::Zero());
  std::vector<double> stiffness(points.size(), 0);
  for (std::size_t i = 0; i < springs_.size(); ++i) {
    const Spring& spring = springs_[i];
    const auto from = static_cast<std::size_t>(spring.from);
    const auto to = static_cast<std::size_t>(spring.to);
    for (const std::size_t end : {from, to}) stiffness[end] += 2 * spring.weight;
    const Eigen::Vector3d difference = positions[to] - positions[from];
    SpringElement element;
    if (const double length = difference.norm(); length > 0 || order < 1) {
      LengthDerivatives derivatives;
      derivatives.length = length;
      if (order >= 1) {
        const Eigen::Vector3d d = difference / length;
        Eigen::Matrix<double, 3, 4> by_ends;
        by_ends << -frames[from], frames[to];
        derivatives.gradient = by_ends.transpose() * d;
        derivatives.hessian =
            (by_ends.transpose() * by_ends - derivatives.gradient * derivatives.gradient.transpose()) / length;
        const double force = 2 * spring.weight * (length - spring.rest_length);
        if (state.on_tip(from)) vertex_gradients[from] -= force * d;
        if (state.on_tip(to)) vertex_gradients[to] += force * d;
      }
      element = spring_element(spring, derivatives);
    } else {
      // The ends coincide. If they are given in the two faces of an edge, the frames differ by a rotation about it.
      const Eigen::Matrix2d turn = frames[from].transpose() * frames[to];
      element = spring_element_at_zero(spring, std::atan2(turn(1, 0) - turn(0, 1), turn.trace()), i);
    }
    element.add_to(sum, order);
  }
  if (order < 1) return;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!state.on_tip(i)) continue;
    const auto row = 2 * static_cast<Eigen::Index>(i);
    sum.gradient.segment<2>(row) += steepest_descent_at_vertex(state, i, vertex_gradients[i]);
    if (order < 2) continue;
    for (int k = 0; k < 2; ++k) sum.hessian.add(row + k, row + k, stiffness[i]);
  }
}

void EuclideanSprings::bill(CostLedger& cost, double seconds) const {
  cost.add_stage("assembly", seconds);
  cost.add_effect(name(), true, "asked for: the springs are straight through space", 1, seconds);
}

}  // namespace supple::embedded
