#include "moved_supports.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tangent_change.h"

namespace supple::embedded {
namespace {

/// The share of a load step over which gradients are subtracted. Rounding and curvature spoil this difference about as
/// much.
constexpr double share_for_tangent = 1e-6;
/// The smallest shift that the convex matrix gets where it cannot be factorized without one, in mean entries of its
/// diagonal.
constexpr double min_shift = 1e-8;
/// Supports go the way of one rigid body if they are off it by less than this, in diagonals of the host.
constexpr double rigid_rounding = 1e-12;
/// A host that moved as a whole is at its equilibrium but for rounding if the gradient is at most so many tolerances.
constexpr double tolerances_of_rounding = 100;
/// The energy of another equilibrium is lower by more than this many times the predicted decrease,
/// and by more than this share of the energy.
constexpr double surprising_support_decrease = 10;
constexpr double support_decrease_of_rounding = 1e-9;

/// The positions of all nodes, then those of all points.
Eigen::VectorXd positions_of(const NetworkState& state) {
  const Eigen::Index nodes = state.nodes().size();
  Eigen::VectorXd positions(nodes + 3 * static_cast<Eigen::Index>(state.points().size()));
  positions.head(nodes) = state.nodes();
  for (std::size_t i = 0; i < state.points().size(); ++i)
    positions.segment<3>(nodes + 3 * static_cast<Eigen::Index>(i)) = surface::position(state.mesh(), state.points()[i]);
  return positions;
}

}  // namespace

MovedSupports::MovedSupports(numerics::System<NetworkState>& system, const HostModel& host, double gradient_tolerance)
    : system_(system), gradient_tolerance_(gradient_tolerance), start_{system.state(), 0} {
  const std::vector<MovedVertex>& moved = host.moved();
  const std::vector<bool>& held = host.held();
  bool partly = false;
  for (std::size_t i = 0; i < held.size(); i += 3) {
    const auto count = std::count(held.begin() + static_cast<std::ptrdiff_t>(i),
                                  held.begin() + static_cast<std::ptrdiff_t>(i) + 3, true);
    partly = partly || (count > 0 && count < 3);
    if (count == 3) supports_.push_back(static_cast<std::int32_t>(i / 3));
  }
  if (partly) supports_.clear();
  std::size_t stops = 0;
  Eigen::VectorXd places(3 * static_cast<Eigen::Index>(moved.size()));
  for (std::size_t i = 0; i < moved.size(); ++i) {
    vertices_.push_back(moved[i].vertex);
    places.segment<3>(3 * static_cast<Eigen::Index>(i)) = system.state().node(moved[i].vertex);
    stops = std::max(stops, moved[i].positions.size());
  }
  stops_.push_back(places);
  for (std::size_t k = 0; k < stops; ++k) {
    for (std::size_t i = 0; i < moved.size(); ++i)
      if (k < moved[i].positions.size()) places.segment<3>(3 * static_cast<Eigen::Index>(i)) = moved[i].positions[k];
    stops_.push_back(places);
  }
}

void MovedSupports::set_state(const State& state) {
  system_.set_state(state.network);
  system_.look_around();
  load_ = state.load;
}

Eigen::VectorXd MovedSupports::way_of_supports(const NetworkState& from, double load) const {
  const auto before = static_cast<std::size_t>(std::clamp(std::floor(load), 0.0, static_cast<double>(stops())));
  const double share = load - static_cast<double>(before);
  Eigen::VectorXd at = stops_[before];
  if (share > 0) at += share * (stops_[before + 1] - at);
  Eigen::VectorXd way = Eigen::VectorXd::Zero(from.dimension());
  for (std::size_t i = 0; i < vertices_.size(); ++i)
    way.segment<3>(from.node_row(vertices_[i])) =
        at.segment<3>(3 * static_cast<Eigen::Index>(i)) - from.node(vertices_[i]);
  return way;
}

std::optional<Eigen::VectorXd> MovedSupports::rigid_motion(const NetworkState& from, double load) const {
  if (supports_.empty()) return std::nullopt;
  const Eigen::VectorXd way = way_of_supports(from, load);
  Eigen::Matrix3Xd before(3, static_cast<Eigen::Index>(supports_.size()));
  Eigen::Matrix3Xd after = before;
  for (Eigen::Index i = 0; i < before.cols(); ++i) {
    const std::int32_t node = supports_[static_cast<std::size_t>(i)];
    before.col(i) = from.node(node);
    after.col(i) = before.col(i) + way.segment<3>(from.node_row(node));
  }
  const Eigen::Matrix4d motion = Eigen::umeyama(before, after, false);
  const auto moved = [&](const Eigen::Vector3d& at) -> Eigen::Vector3d {
    return motion.topLeftCorner<3, 3>() * at + motion.topRightCorner<3, 1>();
  };
  for (Eigen::Index i = 0; i < before.cols(); ++i)
    if (!((moved(before.col(i)) - after.col(i)).norm() <= rigid_rounding * from.mesh().diagonal())) return std::nullopt;
  Eigen::VectorXd step = way;
  const auto nodes = static_cast<std::int32_t>(from.nodes().size() / 3);
  for (std::int32_t node = 0; node < nodes; ++node) {
    if (std::ranges::binary_search(supports_, node)) continue;
    step.segment<3>(from.node_row(node)) = moved(from.node(node)) - from.node(node);
  }
  return step;
}

// With the energy's derivatives by unknowns u and the load t, an equilibrium stays one where H_uu du + H_ut dt = 0.
// H_ut is the difference of gradients for unknowns that stay while the supports move a little: that is as good as its
// derivative here, at the price of one gradient. Coordinates of points turn with the faces that they are on.
void MovedSupports::begin_step() {
  start_ = state();
  const NetworkState& from = start_.network;
  tangent_ = way_of_supports(from, announced_);
  has_factors_ = false;
  if (system_.dimension() == 0) return;
  const numerics::Evaluation here = system_.evaluate(2);
  has_factors_ = !at_kink_ && cholesky_.factorize(here.hessian, 0);
  Eigen::VectorXd unbalanced = -system_.full_gradient();
  if (!has_factors_) {
    if (const auto convex = system_.convex_hessian()) {
      const double scale = numerics::matrix_scale(*convex);
      for (double shift = 0; !has_factors_ && shift <= 1; shift = std::max(min_shift, 10 * shift))
        has_factors_ = cholesky_.factorize(*convex, shift * scale);
    }
  }
  if (!has_factors_) return;
  NetworkState carried = from;
  carried.move(share_for_tangent * tangent_);
  if (carried.collapsed()) return;
  if (at_kink_) {
    const Eigen::VectorXd response = -cholesky_.solve(system_.restrict(unbalanced_host(carried))) / share_for_tangent;
    if (!response.allFinite()) return;
    tangent_ += system_.expand(response);
    tangent_.head(2 * static_cast<Eigen::Index>(from.points().size())).setZero();
    return;
  }
  system_.set_state(carried);
  system_.look_around();
  const Eigen::VectorXd moved = system_.full_gradient();
  const bool finite = std::isfinite(system_.energy());
  set_state(start_);
  if (!finite) return;
  unbalanced += moved;
  for (std::size_t i = 0; i < from.points().size(); ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    if (carried.on_tip(i)) {
      unbalanced.segment<2>(row).setZero();
      continue;
    }
    const Eigen::Matrix2d change = tangent_change(from.mesh(), carried.mesh(), from.points()[i].face);
    unbalanced.segment<2>(row) += (change.transpose() - Eigen::Matrix2d::Identity()) * moved.segment<2>(row);
  }
  const Eigen::VectorXd answer = -cholesky_.solve(system_.restrict(unbalanced)) / share_for_tangent;
  if (!answer.allFinite()) return;
  tangent_ += system_.expand(answer);
  // Points that hardly anything holds would run far: they stay in their places.
  for (std::size_t i = 0; i < from.points().size(); ++i) {
    auto way = tangent_.segment<2>(2 * static_cast<Eigen::Index>(i));
    if (!(way.norm() <= from.mesh().diagonal())) way.setZero();
  }
}

bool MovedSupports::go(const State& from, const Eigen::VectorXd& step, double load) {
  for (const auto& term : system_.terms())
    if (term->largest_step(from.network, step) < 1) return false;
  NetworkState next = from.network;
  next.move(step);
  if (next.collapsed()) return false;
  set_state({std::move(next), load});
  return std::isfinite(system_.evaluate(0).value);
}

bool MovedSupports::go_lower(const Eigen::VectorXd& step, double load) {
  const bool valid = go(start_, step, load);
  const auto coordinates = 2 * static_cast<Eigen::Index>(start_.network.points().size());
  if (step.head(coordinates).isZero(0)) return valid;
  const double energy = valid ? system_.energy() : std::numeric_limits<double>::infinity();
  const State moved = state();
  Eigen::VectorXd carried = step;
  carried.head(coordinates).setZero();
  if (go(start_, carried, load) && system_.energy() < energy) return true;
  if (valid) set_state(moved);
  return valid;
}

Eigen::VectorXd MovedSupports::unbalanced_host(const NetworkState& carried) const {
  numerics::EnergySum before;
  numerics::EnergySum after;
  before.clear(carried.dimension(), 1);
  after.clear(carried.dimension(), 1);
  // The network is the last term, and the only one that has to search for its paths first.
  for (std::size_t i = 0; i + 1 < system_.terms().size(); ++i) {
    system_.terms()[i]->add(start_.network, 1, before);
    system_.terms()[i]->add(carried, 1, after);
  }
  return after.gradient - before.gradient;
}

bool MovedSupports::predict_rigid_motion() {
  const auto step = rigid_motion(start_.network, announced_);
  if (!step || !go(start_, *step, announced_)) return false;
  return system_.evaluate(1).gradient.norm() <= tolerances_of_rounding * gradient_tolerance_;
}

bool MovedSupports::carry_rigidly() {
  start_ = state();
  const double energy = system_.evaluate(0).value;
  // The gradient says nothing here: which of two equally short paths it belongs to is up to rounding.
  const auto step = rigid_motion(start_.network, announced_);
  if (step && go(start_, *step, announced_) &&
      std::abs(system_.evaluate(0).value - energy) <= support_decrease_of_rounding * std::abs(energy))
    return true;
  restart_step();
  return false;
}

void MovedSupports::note_prediction() {
  prediction_ = positions_of(std::as_const(system_).state());
  const numerics::Evaluation there = system_.evaluate(2);
  predicted_energy_ = there.value;
  predicted_decrease_ = has_factors_ ? 0.5 * there.gradient.dot(cholesky_.solve(there.gradient)) : 0;
}

bool MovedSupports::predict(double share) {
  // A whole way ends where it is to end, to the last digit.
  const double load = share == 1 ? announced_ : start_.load + share * (announced_ - start_.load);
  if (share == 1 && predict_rigid_motion()) {
    note_prediction();
    return true;
  }
  Eigen::VectorXd step = share * tangent_;
  const Eigen::VectorXd way = way_of_supports(start_.network, load);
  for (const std::int32_t vertex : vertices_) {
    const std::int32_t row = start_.network.node_row(vertex);
    step.segment<3>(row) = way.segment<3>(row);
  }
  if (!go_lower(step, load)) return false;
  note_prediction();
  return true;
}

bool MovedSupports::has_jumped(double energy) const {
  const double decrease = predicted_energy_ - energy;
  return decrease >
         surprising_support_decrease * predicted_decrease_ + support_decrease_of_rounding * std::abs(predicted_energy_);
}

double MovedSupports::missed_share() const {
  const double way = (prediction_ - positions_of(start_.network)).norm();
  const double missed = (positions_of(std::as_const(system_).state()) - prediction_).norm();
  return missed > 0 ? missed / way : 0;
}

bool MovedSupports::finish(const numerics::MinimizerResult& result) {
  if (system_.dimension() == 0) return true;
  const bool fresh = result.factorized_at >= 0 && result.history.back().regularization == 0 && !result.indefinite;
  return fresh || cholesky_.factorize(system_.evaluate(2).hessian, 0);
}

Eigen::VectorXd MovedSupports::unit_mode(const Eigen::VectorXd& mode) const {
  const double largest = mode.cwiseAbs().maxCoeff();
  return mode * (std::as_const(system_).state().mesh().diagonal() / std::max(largest, 1e-300));
}

bool MovedSupports::move_along(const State& from, const Eigen::VectorXd& mode, double amount) {
  return go(from, amount * mode, from.load);
}

}  // namespace supple::embedded
