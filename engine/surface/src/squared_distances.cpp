#include "squared_distances.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace supple::surface {
Eigen::VectorXd KarcherState::move(const Eigen::VectorXd& step) {
  const bool from_tip = on_tip_;
  const Retraction moved = retract(*mesh_, point_, step, cancellation_);
  point_ = moved.end;
  on_tip_ = on_cone_tip(*mesh_, point_);
  geodesics_.reset();
  turn_ = moved.turn;
  isometric_ = moved.isometric && !from_tip;
  return moved.travelled;
}

bool KarcherState::transport(Eigen::VectorXd& tangent) const {
  if (!isometric_) return false;
  const double c = std::cos(turn_);
  const double s = std::sin(turn_);
  tangent = Eigen::Vector2d(c * tangent[0] - s * tangent[1], s * tangent[0] + c * tangent[1]);
  return true;
}

bool is_at_kink(const KarcherState& state) {
  return state.on_tip() && std::ranges::any_of(*state.geodesics(), [](const AnchorGeodesic& g) {
           return g.neighbour.has_value() && !g.coincident;
         });
}

bool away_from_cut_loci(const KarcherState& state) {
  return std::ranges::all_of(*state.geodesics(), &AnchorGeodesic::certain);
}

SquaredDistances::SquaredDistances(const TriangleMesh& mesh, AnchorDistances& distances, std::vector<double> weights)
    : mesh_(mesh), distances_(distances), weights_(std::move(weights)) {}

void SquaredDistances::prepare(KarcherState& state, int /*order*/, const Execution& execution) {
  if (state.geodesics()) return;
  const auto need = state.on_tip() ? AnchorDistances::Need::directions : AnchorDistances::Need::derivatives;
  state.set_geodesics(distances_.at(state.point(), need, execution));
}

double SquaredDistances::value_of(const std::vector<AnchorGeodesic>& geodesics) const {
  double value = 0;
  for (std::size_t i = 0; i < geodesics.size(); ++i)
    value += 0.5 * weights_[i] * geodesics[i].distance * geodesics[i].distance;
  return value;
}

double SquaredDistances::value_at(const SurfacePoint& point, const Execution& execution) const {
  return value_of(distances_.at(point, AnchorDistances::Need::values, execution));
}

void SquaredDistances::add(const KarcherState& state, int order, numerics::EnergySum& sum) const {
  const std::vector<AnchorGeodesic>& geodesics = *state.geodesics();
  sum.value += value_of(geodesics);
  if (order < 1) return;
  if (state.on_tip()) return add_on_tip(state, sum);
  Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
  Eigen::Matrix2d hessian = Eigen::Matrix2d::Zero();
  for (std::size_t i = 0; i < geodesics.size(); ++i) {
    const AnchorGeodesic& g = geodesics[i];
    if (g.coincident) {
      hessian += weights_[i] * Eigen::Matrix2d::Identity();
      continue;
    }
    gradient += weights_[i] * g.distance * g.gradient;
    hessian += weights_[i] * (g.gradient * g.gradient.transpose() + g.distance * g.hessian);
  }
  sum.gradient += gradient;
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j <= i; ++j) sum.hessian.add(i, j, hessian(i, j));
}

void SquaredDistances::add_on_tip(const KarcherState& state, numerics::EnergySum& sum) const {
  const VertexCone cone(mesh_, vertex_of(mesh_, state.point()));
  std::vector<ArrivingPath> arrivals;
  for (std::size_t i = 0; i < state.geodesics()->size(); ++i) {
    const AnchorGeodesic& g = (*state.geodesics())[i];
    if (!g.neighbour || g.coincident) continue;
    const double angle = cone.angle_to(*g.neighbour);
    if (std::isfinite(angle)) arrivals.push_back({angle, weights_[i] * g.distance});
  }
  if (!arrivals.empty()) {
    const SteepestDescent descent = steepest_descent(cone, arrivals);
    if (descent.slope < 0) sum.gradient += descent.slope * cone_coordinates(cone, descent.angle);
  }
  for (int i = 0; i < 2; ++i) sum.hessian.add(i, i, 1);
}

}  // namespace supple::surface
