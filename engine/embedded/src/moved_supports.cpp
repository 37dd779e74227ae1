#include "moved_supports.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tangent_change.h"

namespace supple::embedded {
namespace {

/// Fraction of a load increment over which the energy's gradient is differenced for the tangent of the equilibrium
/// path. Rounding and truncation cause errors of about the same size there.
constexpr double tangent_fraction = 1e-6;
/// The first shift of a convex matrix that cannot be factorized without one, in mean entries of its diagonal.
constexpr double min_shift = 1e-8;
/// Supports move as one rigid body if they deviate from its motion by at most this, in diagonals of the host.
constexpr double rigid_rounding = 1e-12;
/// A host that moved as a whole is at its equilibrium but for rounding if the gradient is at most this many tolerances.
constexpr double max_rigid_gradient = 100;
/// An equilibrium is another one if its energy is lower than predicted by more than this many times the predicted
/// decrease plus this fraction of the energy.
constexpr double max_decrease_ratio = 10;
constexpr double relative_energy_rounding = 1e-9;

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
    : system_(system), host_(host), gradient_tolerance_(gradient_tolerance), start_{system.state(), 0} {
  const std::vector<MovedVertex>& moved = host.moved();
  const std::vector<bool>& fixed = host.fixed();
  bool has_partly_fixed = false;
  for (std::size_t i = 0; i < fixed.size(); i += 3) {
    const auto count = std::count(fixed.begin() + static_cast<std::ptrdiff_t>(i),
                                  fixed.begin() + static_cast<std::ptrdiff_t>(i) + 3, true);
    has_partly_fixed = has_partly_fixed || (count > 0 && count < 3);
    if (count == 3) supports_.push_back(static_cast<std::int32_t>(i / 3));
  }
  if (has_partly_fixed) supports_.clear();
  std::size_t count = 0;
  Eigen::VectorXd places(3 * static_cast<Eigen::Index>(moved.size()));
  for (std::size_t i = 0; i < moved.size(); ++i) {
    vertices_.push_back(moved[i].vertex);
    places.segment<3>(3 * static_cast<Eigen::Index>(i)) = system.state().node(moved[i].vertex);
    count = std::max(count, moved[i].positions.size());
  }
  positions_.push_back(places);
  for (std::size_t k = 0; k < count; ++k) {
    for (std::size_t i = 0; i < moved.size(); ++i)
      if (k < moved[i].positions.size()) places.segment<3>(3 * static_cast<Eigen::Index>(i)) = moved[i].positions[k];
    positions_.push_back(places);
  }
}

void MovedSupports::set_state(const State& state) {
  system_.set_state(state.network);
  system_.prepare_terms();
  load_ = state.load;
}

Eigen::VectorXd MovedSupports::prescribed_change(const NetworkState& from, double load) const {
  const auto before =
      static_cast<std::size_t>(std::clamp(std::floor(load), 0.0, static_cast<double>(position_count())));
  const double fraction = load - static_cast<double>(before);
  Eigen::VectorXd at = positions_[before];
  if (fraction > 0) at += fraction * (positions_[before + 1] - at);
  Eigen::VectorXd change = Eigen::VectorXd::Zero(from.dimension());
  for (std::size_t i = 0; i < vertices_.size(); ++i)
    change.segment<3>(from.node_row(vertices_[i])) =
        at.segment<3>(3 * static_cast<Eigen::Index>(i)) - from.node(vertices_[i]);
  return change;
}

std::optional<Eigen::VectorXd> MovedSupports::rigid_motion(const NetworkState& from, double load) const {
  if (supports_.empty()) return std::nullopt;
  const Eigen::VectorXd prescribed = prescribed_change(from, load);
  Eigen::Matrix3Xd before(3, static_cast<Eigen::Index>(supports_.size()));
  Eigen::Matrix3Xd after = before;
  for (Eigen::Index i = 0; i < before.cols(); ++i) {
    const std::int32_t node = supports_[static_cast<std::size_t>(i)];
    before.col(i) = from.node(node);
    after.col(i) = before.col(i) + prescribed.segment<3>(from.node_row(node));
  }
  const Eigen::Matrix4d motion = Eigen::umeyama(before, after, false);
  const auto moved = [&](const Eigen::Vector3d& at) -> Eigen::Vector3d {
    return motion.topLeftCorner<3, 3>() * at + motion.topRightCorner<3, 1>();
  };
  for (Eigen::Index i = 0; i < before.cols(); ++i)
    if (!((moved(before.col(i)) - after.col(i)).norm() <= rigid_rounding * from.mesh().diagonal())) return std::nullopt;
  Eigen::VectorXd step = prescribed;
  const auto nodes = static_cast<std::int32_t>(from.nodes().size() / 3);
  for (std::int32_t node = 0; node < nodes; ++node) {
    if (std::ranges::binary_search(supports_, node)) continue;
    step.segment<3>(from.node_row(node)) = moved(from.node(node)) - from.node(node);
  }
  return step;
}

bool MovedSupports::factorize_at_start(const numerics::Evaluation& here) {
  if (!at_kink_ && cholesky_.factorize(here.hessian, 0)) return true;
  const auto convex = system_.convex_hessian();
  if (!convex) return false;
  const double scale = numerics::matrix_scale(*convex);
  double shift = 0;
  while (shift <= 1) {
    if (cholesky_.factorize(*convex, shift * scale)) return true;
    shift = std::max(min_shift, 10 * shift);
  }
  return false;
}

// Let u be the unknowns, t the load and H the energy's second derivatives. Along a path of equilibria
// H_uu du + H_ut dt = 0. H_ut is the difference of two gradients, of which the second has the supports moved a little
// and the same unknowns. That is accurate enough here and costs one gradient.
void MovedSupports::begin_step() {
  start_ = state();
  const NetworkState& from = start_.network;
  tangent_ = prescribed_change(from, target_);
  has_factors_ = false;
  if (system_.dimension() == 0) return;
  const numerics::Evaluation here = system_.evaluate(2);
  Eigen::VectorXd unbalanced = -system_.full_gradient();
  has_factors_ = factorize_at_start(here);
  if (!has_factors_) return;
  NetworkState carried = from;
  carried.move(tangent_fraction * tangent_);
  if (!carried.collapsed()) compute_tangent(carried, std::move(unbalanced));
}

void MovedSupports::compute_tangent(const NetworkState& carried, Eigen::VectorXd unbalanced) {
  const NetworkState& from = start_.network;
  if (at_kink_) {
    const Eigen::VectorXd response =
        -cholesky_.solve(system_.restrict(host_gradient_change(carried))) / tangent_fraction;
    if (!response.allFinite()) return;
    tangent_ += system_.expand(response);
    tangent_.head(2 * static_cast<Eigen::Index>(from.points().size())).setZero();
    return;
  }
  system_.set_state(carried);
  system_.prepare_terms();
  const Eigen::VectorXd gradient = system_.full_gradient();
  const bool is_finite = std::isfinite(system_.energy());
  set_state(start_);
  if (!is_finite) return;
  unbalanced += gradient;
  for (std::size_t i = 0; i < from.points().size(); ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    if (carried.on_tip(i)) {
      unbalanced.segment<2>(row).setZero();
      continue;
    }
    // The tangent coordinates of a point change with the face that carries it.
    const Eigen::Matrix2d change = tangent_change(from.mesh(), carried.mesh(), from.points()[i].face);
    unbalanced.segment<2>(row) += (change.transpose() - Eigen::Matrix2d::Identity()) * gradient.segment<2>(row);
  }
  const Eigen::VectorXd answer = -cholesky_.solve(system_.restrict(unbalanced)) / tangent_fraction;
  if (!answer.allFinite()) return;
  tangent_ += system_.expand(answer);
  // Points with hardly any stiffness would move far: they keep their barycentric coordinates.
  for (std::size_t i = 0; i < from.points().size(); ++i) {
    auto step = tangent_.segment<2>(2 * static_cast<Eigen::Index>(i));
    if (!(step.norm() <= from.mesh().diagonal())) step.setZero();
  }
}

bool MovedSupports::try_step(const State& from, const Eigen::VectorXd& step, double load) {
  for (const auto& term : system_.terms())
    if (term->largest_step(from.network, step) < 1) return false;
  NetworkState next = from.network;
  next.move(step);
  if (next.collapsed()) return false;
  set_state({std::move(next), load});
  return std::isfinite(system_.evaluate(0).value);
}

bool MovedSupports::take_lower_step(const Eigen::VectorXd& step, double load) {
  const bool valid = try_step(start_, step, load);
  const auto coordinates = 2 * static_cast<Eigen::Index>(start_.network.points().size());
  if (step.head(coordinates).isZero(0)) return valid;
  const double energy = valid ? system_.energy() : std::numeric_limits<double>::infinity();
  const State moved = state();
  Eigen::VectorXd carried = step;
  carried.head(coordinates).setZero();
  if (try_step(start_, carried, load) && system_.energy() < energy) return true;
  if (valid) set_state(moved);
  return valid;
}

Eigen::VectorXd MovedSupports::host_gradient_change(const NetworkState& carried) const {
  numerics::EnergySum before;
  numerics::EnergySum after;
  before.clear(carried.dimension(), 1);
  after.clear(carried.dimension(), 1);
  for (const auto& term : host_.terms()) {
    term->add(start_.network, 1, before);
    term->add(carried, 1, after);
  }
  return after.gradient - before.gradient;
}

bool MovedSupports::predict_rigid_motion() {
  const auto step = rigid_motion(start_.network, target_);
  if (!step || !try_step(start_, *step, target_)) return false;
  return system_.evaluate(1).gradient.norm() <= max_rigid_gradient * gradient_tolerance_;
}

bool MovedSupports::move_rigidly() {
  start_ = state();
  const double energy = system_.evaluate(0).value;
  // The energy is compared and not the gradient: rounding decides which of two equally short paths that belongs to.
  const auto step = rigid_motion(start_.network, target_);
  if (step && try_step(start_, *step, target_) &&
      std::abs(system_.evaluate(0).value - energy) <= relative_energy_rounding * std::abs(energy))
    return true;
  restart_step();
  return false;
}

void MovedSupports::store_prediction() {
  prediction_ = positions_of(std::as_const(system_).state());
  const numerics::Evaluation there = system_.evaluate(2);
  predicted_energy_ = there.value;
  predicted_decrease_ = has_factors_ ? 0.5 * there.gradient.dot(cholesky_.solve(there.gradient)) : 0;
}

bool MovedSupports::predict(double fraction) {
  // A whole increment ends exactly at the target.
  const double load = fraction == 1 ? target_ : start_.load + fraction * (target_ - start_.load);
  if (fraction == 1 && predict_rigid_motion()) {
    store_prediction();
    return true;
  }
  Eigen::VectorXd step = fraction * tangent_;
  const Eigen::VectorXd prescribed = prescribed_change(start_.network, load);
  for (const std::int32_t vertex : vertices_) {
    const std::int32_t row = start_.network.node_row(vertex);
    step.segment<3>(row) = prescribed.segment<3>(row);
  }
  if (!take_lower_step(step, load)) return false;
  store_prediction();
  return true;
}

bool MovedSupports::has_jumped(double energy) const {
  const double decrease = predicted_energy_ - energy;
  return decrease > max_decrease_ratio * predicted_decrease_ + relative_energy_rounding * std::abs(predicted_energy_);
}

double MovedSupports::prediction_error() const {
  const double distance = (prediction_ - positions_of(start_.network)).norm();
  const double error = (positions_of(std::as_const(system_).state()) - prediction_).norm();
  return error > 0 ? error / distance : 0;
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
  return try_step(from, amount * mode, from.load);
}

}  // namespace supple::embedded
