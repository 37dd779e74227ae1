#include "karcher_objective.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "supple/surface/exponential_map.h"
#include "vertex_cone.h"

namespace supple::surface {
namespace {

/// Points closer than this, relative to the mean edge, differ by rounding alone.
constexpr double kSamePoint = 1e-13;
/// And so do objectives that differ by less than this, relative.
constexpr double kSameValue = 1e-12;

/// A vertex whose angle is within this of 2 pi (radians) is treated as a point of a flat face.
constexpr double flat_angle = 1e-12;

std::int32_t vertex_of(const TriangleMesh& mesh, const SurfacePoint& point) {
  const int corner = corner_of(point);
  return corner < 0 ? -1 : mesh.faces()[index(point.face)][corner];
}

bool is_flat(const TriangleMesh& mesh, std::int32_t vertex) {
  return !mesh.is_boundary(vertex) && std::abs(mesh.vertex_angle(vertex) - 2 * std::numbers::pi) <= flat_angle;
}

}  // namespace

KarcherObjective::KarcherObjective(const TriangleMesh& mesh, AnchorDistances& distances, std::vector<double> weights,
                                   const SurfacePoint& start, const Execution& execution)
    : mesh_(mesh), distances_(distances), weights_(std::move(weights)), execution_(execution) {
  current_ = state_at(start);
}

void KarcherObjective::place(const SurfacePoint& point) {
  trial_ = state_at(point);
  accept();
}

KarcherObjective::State KarcherObjective::state_at(const SurfacePoint& point) const {
  State state;
  state.point = point;
  const std::int32_t vertex = vertex_of(mesh_, point);
  state.vertex = vertex >= 0 && !is_flat(mesh_, vertex);
  return state;
}

double KarcherObjective::value_at(const SurfacePoint& point) const {
  const auto found = distances_.at(point, AnchorDistances::Need::values, execution_);
  double value = 0;
  for (std::size_t i = 0; i < found.size(); ++i) value += 0.5 * weights_[i] * found[i].distance * found[i].distance;
  return value;
}

bool KarcherObjective::on_tip() {
  evaluate_state(current_);
  return current_.tip;
}

bool KarcherObjective::away_from_cut_loci() {
  evaluate_state(current_);
  return current_.certain;
}

void KarcherObjective::evaluate_state(State& state) const {
  if (state.evaluated) return;
  if (state.vertex)
    evaluate_vertex(state);
  else
    evaluate_smooth(state);
  state.evaluated = true;
}

void KarcherObjective::evaluate_smooth(State& state) const {
  const auto found = distances_.at(state.point, AnchorDistances::Need::derivatives, execution_);
  const StageTimer timer(execution_.cost, "derivatives");
  double value = 0;
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < found.size(); ++i) {
    const AnchorGeodesic& g = found[i];
    value += 0.5 * weights_[i] * g.distance * g.distance;
    state.certain = state.certain && g.certain;
    if (g.coincident) {
      hessian += weights_[i] * Eigen::Matrix2d::Identity();
      continue;
    }
    gradient += weights_[i] * g.distance * g.gradient;
    hessian += weights_[i] * (g.gradient * g.gradient.transpose() + g.distance * g.hessian);
  }
  state.evaluation = {value, gradient, Eigen::MatrixXd(hessian)};
}

void KarcherObjective::evaluate_vertex(State& state) const {
  const auto found = distances_.at(state.point, AnchorDistances::Need::directions, execution_);
  const StageTimer timer(execution_.cost, "derivatives");
  const VertexCone cone(mesh_, vertex_of(mesh_, state.point));
  double value = 0;
  std::vector<ArrivingPath> arrivals;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const AnchorGeodesic& g = found[i];
    value += 0.5 * weights_[i] * g.distance * g.distance;
    state.certain = state.certain && g.certain;
    if (!g.neighbour || g.coincident) continue;
    const double angle = cone.angle_to(*g.neighbour);
    if (std::isfinite(angle)) arrivals.push_back({angle, weights_[i] * g.distance});
  }
  state.tip = !arrivals.empty();
  Eigen::VectorXd gradient = Eigen::Vector2d::Zero();
  if (state.tip) {
    const SteepestDescent descent = steepest_descent(cone, arrivals);
    const auto direction = cone.direction(descent.angle);
    // The state is rewritten in the face that the descent enters: the frame of what follows.
    state.point = direction.vertex;
    if (descent.slope < 0)
      gradient = descent.slope * (tangent_frame(mesh_, state.point.face).transpose() * direction.vector);
  }
  state.evaluation = {value, gradient, Eigen::MatrixXd(Eigen::Matrix2d::Identity())};
}

numerics::Evaluation KarcherObjective::evaluate(int /*order*/) {
  State& state = trial_ ? *trial_ : current_;
  evaluate_state(state);
  return state.evaluation;
}

double KarcherObjective::move(const Eigen::VectorXd& step) {
  const StageTimer timer(execution_.cost, "step");
  Eigen::Vector3d tangent = tangent_frame(mesh_, current_.point.face) * step;
  slid_ = false;
  const int side = side_of(current_.point);
  if (side >= 0 && mesh_.twin(3 * index(current_.point.face) + side) < 0) {
    const Triangle& face = mesh_.faces()[index(current_.point.face)];
    const auto& positions = mesh_.positions();
    const Eigen::Vector3d along = (positions[face[(side + 1) % 3]] - positions[face[side]]).normalized();
    const Eigen::Vector3d to_apex = positions[face[(side + 2) % 3]] - positions[face[side]];
    const Eigen::Vector3d inward = (to_apex - along.dot(to_apex) * along).normalized();
    if (tangent.dot(inward) < 0) {
      tangent = along.dot(tangent) * along;
      slid_ = true;
    }
  }
  const double length = tangent.norm();
  const ExponentialMap walked = exponential_map(mesh_, current_.point, tangent, false);
  trial_ = state_at(walked.end);
  turn_ = walked.transport_angle;
  reach_ = std::max(reach_, walked.length);
  faces_tried_.push_back(index(walked.end.face));
  return length > 0 ? std::min(1.0, walked.length / length) : 0.0;
}

void KarcherObjective::accept() {
  current_ = std::move(*trial_);
  reject();
  reach_ = 0;
  faces_tried_.clear();
  vertices_tried_.clear();
}

void KarcherObjective::reject() { trial_.reset(); }

bool KarcherObjective::transport(Eigen::VectorXd& tangent) const {
  if (current_.vertex || (trial_ && trial_->vertex) || slid_) return false;
  const double c = std::cos(turn_);
  const double s = std::sin(turn_);
  tangent = Eigen::Vector2d(c * tangent[0] - s * tangent[1], s * tangent[0] + c * tangent[1]);
  return true;
}

std::optional<double> KarcherObjective::snap() {
  const Eigen::Vector3d here = position(mesh_, current_.point);
  double best = current_.evaluation.value;
  if (trial_) best = std::min(best, trial_->evaluation.value);
  std::optional<double> distance;
  faces_tried_.push_back(index(current_.point.face));
  for (const std::int32_t f : faces_tried_) {
    for (const std::int32_t vertex : mesh_.faces()[f]) {
      if (std::ranges::find(vertices_tried_, vertex) != vertices_tried_.end()) continue;
      vertices_tried_.push_back(vertex);
      const double away = (mesh_.positions()[vertex] - here).norm();
      if (away > reach_ || vertex == vertex_of(mesh_, current_.point)) continue;
      if (!VertexCone(mesh_, vertex).bends_paths()) continue;
      State state = state_at(vertex_point(mesh_, VertexId{vertex}));
      evaluate_state(state);
      // A point that rounding alone keeps from the vertex has the vertex's value, or one below it by rounding.
      const bool same_point = away <= kSamePoint * mesh_.mean_edge_length();
      if (same_point ? state.evaluation.value > best * (1 + kSameValue) : !(state.evaluation.value < best)) continue;
      best = state.evaluation.value;
      distance = away;
      trial_ = std::move(state);
    }
  }
  return distance;
}

}  // namespace supple::surface
