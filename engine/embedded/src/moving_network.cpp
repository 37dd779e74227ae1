#include "moving_network.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "constrained_points.h"
#include "supple/base/error.h"
#include "tangent_change.h"

namespace supple::embedded {
namespace {

/// Largest motion of a vertex, in mesh diagonals, over which the energy's gradient is differenced for the tangent of
/// the equilibrium path. Rounding and truncation cause errors of about the same size there.
constexpr double tangent_motion = 1e-7;
/// Relative difference of the energy from the predicted one up to which `loss_on_return` is not needed.
constexpr double max_predicted_difference = 1e-7;
/// Energies that differ by at most the gradient's tolerance times this length, in mesh diagonals, count as equal.
constexpr double rounding_length = 1e-6;

}  // namespace

MovingNetwork::MovingNetwork(const surface::GeodesicSolver& solver, std::shared_ptr<const ElasticNetwork> network,
                             std::shared_ptr<PointDamping> damping, PathCacheOptions options, const MovingHost& host,
                             const State& start, double gradient_tolerance, Execution execution)
    : first_solver_(solver),
      network_(std::move(network)),
      unknowns_(fixed_coordinates(network_->fixed())),
      damping_(std::move(damping)),
      options_(options),
      gradient_tolerance_(gradient_tolerance),
      execution_(std::move(execution)),
      sums_(std::make_shared<numerics::EnergySum>()) {
  sums_->hessian = numerics::HessianEntries(unknowns_.numbering());
  const surface::TriangleMesh& mesh = solver.mesh();
  const auto add = [&](const std::vector<Eigen::Vector3d>& positions) {
    Eigen::VectorXd& nodes = positions_.emplace_back(3 * static_cast<Eigen::Index>(positions.size()));
    for (std::size_t i = 0; i < positions.size(); ++i)
      nodes.segment<3>(3 * static_cast<Eigen::Index>(i)) = positions[i];
  };
  add(mesh.positions());
  for (std::size_t k = 0; k < host.positions.size(); ++k) {
    try {
      static_cast<void>(mesh.with_positions(host.positions[k]));
    } catch (const Error& error) {
      throw Error("host.positions", "A position of the host is none of the mesh: " + std::string(error.what()),
                  {{"host/positions/" + std::to_string(k), error.what()}});
    }
    add(host.positions[k]);
  }
  set_state(start);
}

Eigen::VectorXd MovingNetwork::nodes_at(double load) const {
  const auto last = static_cast<double>(positions_.size() - 1);
  const double before = std::min(std::floor(load), last - 1);
  const auto k = static_cast<std::size_t>(std::max(0.0, before));
  if (load <= 0 || positions_.size() == 1) return positions_.front();
  // The last position is returned itself, because interpolation would round its coordinates.
  if (const double fraction = load - static_cast<double>(k); fraction < 1)
    return positions_[k] + fraction * (positions_[k + 1] - positions_[k]);
  return positions_[k + 1];
}

std::shared_ptr<const surface::GeodesicSolver> MovingNetwork::surface_at(double load) const {
  // The solver of the mesh belongs to the caller.
  if (load <= 0) return {std::shared_ptr<void>(), &first_solver_};
  const Eigen::VectorXd nodes = nodes_at(load);
  std::vector<Eigen::Vector3d> positions(static_cast<std::size_t>(nodes.size() / 3));
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = nodes.segment<3>(3 * static_cast<Eigen::Index>(i));
  return std::make_shared<surface::GeodesicSolver>(
      std::make_shared<const surface::TriangleMesh>(first_solver_.mesh().with_positions(std::move(positions))));
}

void MovingNetwork::place(double load, const std::vector<surface::SurfacePoint>& points,
                          std::vector<CutLocus> cut_loci) {
  auto solver = load == load_ && solver_ ? solver_ : surface_at(load);
  NetworkTerm term = network_term(*solver, network_, {.paths = options_});
  if (energy_) term.energy->take_strips(*energy_);
  NetworkState state(solver->mesh(), points);
  state.set_cut_loci(std::move(cut_loci));
  system_ = std::make_unique<numerics::System<NetworkState>>(
      std::move(state), numerics::System<NetworkState>::Terms{damping_, term.energy}, unknowns_,
      numerics::SystemOptions{.execution = execution_, .sums = sums_}, term.search);
  energy_ = std::move(term.energy);
  solver_ = std::move(solver);
  load_ = load;
}

// Let p be the points, t the load and H the energy's second derivatives. Along a path of equilibria H_pp dp + H_pt dt =
// 0. H_pt is the difference of two gradients, of which the second has the surface moved a little and points that keep
// their barycentric coordinates. That is accurate enough here and costs one gradient.
void MovingNetwork::begin_step() {
  start_energy_ = system_->evaluate(0).value;
  start_ = state();  // read after the evaluation, which moves the ends of paths to their cut loci
  tangent_ = Eigen::VectorXd::Zero(unknowns_.degrees_of_freedom());
  has_factors_ = false;
  const double motion = (nodes_at(target_) - nodes_at(load_)).lpNorm<Eigen::Infinity>();
  if (!(motion > 0) || unknowns_.size() == 0) return;
  const numerics::Evaluation here = system_->evaluate(2);
  has_factors_ = cholesky_.factorize(here.hessian, 0);
  if (!has_factors_) return;
  Eigen::VectorXd unbalanced = -system_->full_gradient();
  Eigen::VectorXd own_change;
  const double fraction = std::min(1.0, tangent_motion * solver_->mesh().diagonal() / motion);
  if (!add_gradient_change(fraction, unbalanced, own_change)) return;
  Eigen::VectorXd answer = -cholesky_.solve(unknowns_.restrict(unbalanced)) / fraction;
  // The evaluation ahead has moved the ends of paths to their cut loci, which move with the surface.
  if (own_change.size() > 0) answer += unknowns_.restrict(own_change) / fraction;
  if (!answer.allFinite()) return;
  tangent_ = unknowns_.expand(answer);
  // Points with hardly any stiffness would move far: they keep their barycentric coordinates.
  for (std::size_t i = 0; i < start_.points.size(); ++i) {
    auto step = tangent_.segment<2>(2 * static_cast<Eigen::Index>(i));
    if (!(step.norm() <= solver_->mesh().diagonal())) step.setZero();
  }
}

bool MovingNetwork::add_gradient_change(double fraction, Eigen::VectorXd& unbalanced,
                                        Eigen::VectorXd& own_change) const {
  std::shared_ptr<const surface::GeodesicSolver> ahead;
  try {
    ahead = surface_at(load_ + fraction * (target_ - load_));
  } catch (const Error&) {
    return false;
  }
  NetworkState carried(ahead->mesh(), start_.points);
  carried.set_cut_loci(start_.cut_loci);
  NetworkEnergy energy(*ahead, network_, options_);
  energy.take_strips(*energy_);
  energy.prepare(carried, 1, {execution_.cancellation, nullptr, nullptr});
  numerics::EnergySum sum;
  sum.clear(carried.dimension(), 1);
  energy.add(carried, 1, sum);
  if (!std::isfinite(sum.value)) return false;
  for (std::size_t i = 0; i < start_.points.size(); ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    if (carried.on_tip(i)) {
      unbalanced.segment<2>(row).setZero();
      continue;
    }
    const Eigen::Matrix2d change = tangent_change(solver_->mesh(), ahead->mesh(), start_.points[i].face);
    unbalanced.segment<2>(row) += change.transpose() * sum.gradient.segment<2>(row);
  }
  own_change = carried.last_step();
  return true;
}

// The surface carries the points along first, so that a motion that keeps all lengths does no work. The step along the
// tangent is made only if it lowers energy and gradient: at a cut locus, and for points with hardly any stiffness, the
// tangent may lead anywhere.
bool MovingNetwork::predict(double fraction) {
  const double load = fraction < 1 ? start_.load + fraction * (target_ - start_.load) : target_;
  const std::shared_ptr<const surface::GeodesicSolver> before = solver_;
  predicted_decrease_ = 0;
  try {
    place(load, start_.points, start_.cut_loci);
  } catch (const Error&) {
    return false;  // a face loses its area between two positions
  }
  const numerics::Evaluation carried = system_->evaluate(1);
  carried_energy_ = carried.value;
  if (!std::isfinite(carried.value)) return false;
  if (carried.gradient.norm() <= gradient_tolerance_ || !has_factors_) return true;
  predicted_decrease_ = 0.5 * carried.gradient.dot(cholesky_.solve(carried.gradient));
  if (tangent_.isZero(0)) return true;
  NetworkState ahead(before->mesh(), start_.points);
  ahead.set_cut_loci(start_.cut_loci);
  ahead.move(fraction * tangent_);
  decltype(system_) carried_system;
  carried_system.swap(system_);
  const auto carried_energy = energy_;
  place(load, ahead.points(), ahead.cut_loci());
  const numerics::Evaluation there = system_->evaluate(1);
  if (there.value <= carried.value && there.gradient.norm() < carried.gradient.norm()) return true;
  system_ = std::move(carried_system);
  system_->forget();  // both systems write into the same sums
  energy_ = carried_energy;
  return true;
}

bool MovingNetwork::is_doubtful(double energy) const {
  const double decrease = carried_energy_ - energy;
  return std::abs(decrease - predicted_decrease_) > max_predicted_difference * std::abs(energy) + energy_rounding();
}

// If the equilibrium was lost in the increment, the one found instead has another energy when the surface has moved
// back. A prediction is made, because points that only the surface carries back may return to the lost equilibrium.
double MovingNetwork::loss_on_return(const numerics::MinimizerOptions& options) {
  const State here = state();
  const State from = start_;
  const double energy_from = start_energy_;
  const double target = target_;
  set_target(from.load);
  begin_step();
  const double scale = std::max(std::abs(energy_from), std::abs(start_energy_));
  if (!predict(1)) place(from.load, here.points, here.cut_loci);
  const numerics::MinimizerResult back =
      numerics::minimize(*system_, options, {execution_.cancellation, nullptr, nullptr}, &cholesky_);
  place(here.load, here.points, here.cut_loci);
  start_ = from;
  start_energy_ = energy_from;
  target_ = target;
  const double difference = std::abs(back.value - energy_from) - energy_rounding();
  return difference > 0 ? difference / scale : 0;
}

double MovingNetwork::energy_rounding() const {
  return gradient_tolerance_ * rounding_length * first_solver_.mesh().diagonal();
}

}  // namespace supple::embedded
