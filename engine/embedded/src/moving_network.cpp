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

/// How far the surface moves for a difference of gradients, in diagonals. Rounding and curvature spoil it about as
/// much.
constexpr double small_surface_motion = 1e-7;
/// A load step is beyond doubt where the energy falls as the Hessian at its start predicts, but for this share of the
/// energy.
constexpr double doubtful_decrease = 1e-7;
/// The tolerance of the gradient times this, in diagonals, is no difference of energies.
constexpr double unbalanced_length = 1e-6;

}  // namespace

MovingNetwork::MovingNetwork(const surface::GeodesicSolver& solver, const Network& network,
                             std::vector<bool> held_points, std::shared_ptr<PointDamping> damping,
                             GeodesicElementsOptions options, const MovingHost& host, double gradient_tolerance,
                             Execution execution)
    : first_(solver),
      network_(network),
      held_points_(std::move(held_points)),
      unknowns_(held_coordinates(held_points_)),
      damping_(std::move(damping)),
      options_(options),
      gradient_tolerance_(gradient_tolerance),
      execution_(std::move(execution)),
      sums_(std::make_shared<numerics::EnergySum>()) {
  sums_->hessian = numerics::HessianEntries(unknowns_.numbering());
  const surface::TriangleMesh& mesh = solver.mesh();
  const auto add = [&](const std::vector<Eigen::Vector3d>& positions) {
    Eigen::VectorXd& nodes = stops_.emplace_back(3 * static_cast<Eigen::Index>(positions.size()));
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
  place(0, network.points);
}

Eigen::VectorXd MovingNetwork::nodes_at(double load) const {
  const auto last = static_cast<double>(stops_.size() - 1);
  const double before = std::min(std::floor(load), last - 1);
  const auto k = static_cast<std::size_t>(std::max(0.0, before));
  if (load <= 0 || stops_.size() == 1) return stops_.front();
  // A position itself has its own digits.
  if (const double share = load - static_cast<double>(k); share < 1)
    return stops_[k] + share * (stops_[k + 1] - stops_[k]);
  return stops_[k + 1];
}

std::shared_ptr<const surface::GeodesicSolver> MovingNetwork::surface_at(double load) const {
  // The mesh's own is the caller's, who keeps it.
  if (load <= 0) return {std::shared_ptr<void>(), &first_};
  const Eigen::VectorXd nodes = nodes_at(load);
  std::vector<Eigen::Vector3d> positions(static_cast<std::size_t>(nodes.size() / 3));
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = nodes.segment<3>(3 * static_cast<Eigen::Index>(i));
  return std::make_shared<surface::GeodesicSolver>(
      std::make_shared<const surface::TriangleMesh>(first_.mesh().with_positions(std::move(positions))));
}

void MovingNetwork::place(double load, const std::vector<surface::SurfacePoint>& points,
                          std::vector<CutLocus> cut_loci) {
  auto solver = load == load_ && solver_ ? solver_ : surface_at(load);
  auto elements = std::make_shared<GeodesicElements>(*solver, network_, held_points_, options_);
  if (elements_) elements->take_strips(*elements_);
  NetworkState state(solver->mesh(), points);
  state.set_cut_loci(std::move(cut_loci));
  system_ = std::make_unique<numerics::System<NetworkState>>(
      std::move(state), numerics::System<NetworkState>::Terms{damping_, elements}, unknowns_,
      numerics::SystemOptions{.execution = execution_, .sums = sums_});
  elements_ = std::move(elements);
  solver_ = std::move(solver);
  load_ = load;
}

// With the energy's derivatives by points p and the load t, an equilibrium stays one where H_pp dp + H_pt dt = 0. H_pt
// is the difference of gradients for points that keep their places in the material while the surface moves a little:
// that is as good as its derivative here, at the price of one gradient.
void MovingNetwork::begin_step() {
  start_energy_ = system_->evaluate(0).value;  // paths are at their cut loci from now on
  start_ = state();
  tangent_ = Eigen::VectorXd::Zero(unknowns_.degrees_of_freedom());
  has_factors_ = false;
  const double motion = (nodes_at(announced_) - nodes_at(load_)).lpNorm<Eigen::Infinity>();
  if (!(motion > 0) || unknowns_.size() == 0) return;
  const numerics::Evaluation here = system_->evaluate(2);
  has_factors_ = cholesky_.factorize(here.hessian, 0);
  if (!has_factors_) return;
  Eigen::VectorXd unbalanced = -system_->full_gradient();
  const double small_share = std::min(1.0, small_surface_motion * solver_->mesh().diagonal() / motion);
  std::shared_ptr<const surface::GeodesicSolver> ahead;
  try {
    ahead = surface_at(load_ + small_share * (announced_ - load_));
  } catch (const Error&) {
    return;
  }
  NetworkState carried(ahead->mesh(), start_.points);
  carried.set_cut_loci(network_state().cut_loci());
  GeodesicElements elements(*ahead, network_, held_points_, options_);
  elements.take_strips(*elements_);
  elements.prepare(carried, 1, {execution_.cancellation, nullptr, nullptr});
  numerics::EnergySum sum;
  sum.clear(carried.dimension(), 1);
  elements.add(carried, 1, sum);
  if (!std::isfinite(sum.value)) return;
  for (std::size_t i = 0; i < start_.points.size(); ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    if (carried.on_tip(i)) {
      unbalanced.segment<2>(row).setZero();
      continue;
    }
    const Eigen::Matrix2d change = tangent_change(solver_->mesh(), ahead->mesh(), start_.points[i].face);
    unbalanced.segment<2>(row) += change.transpose() * sum.gradient.segment<2>(row);
  }
  Eigen::VectorXd answer = -cholesky_.solve(unknowns_.restrict(unbalanced)) / small_share;
  // Paths that are kept at cut loci have followed these.
  if (carried.last_step().size() > 0) answer += unknowns_.restrict(carried.last_step()) / small_share;
  if (!answer.allFinite()) return;
  tangent_ = unknowns_.expand(answer);
  // Points that hardly anything holds would run far: they stay in their places.
  for (std::size_t i = 0; i < start_.points.size(); ++i) {
    auto way = tangent_.segment<2>(2 * static_cast<Eigen::Index>(i));
    if (!(way.norm() <= solver_->mesh().diagonal())) way.setZero();
  }
}

// The points are first carried along by the surface, so that a motion that keeps all lengths does no work. The step
// along the tangent is taken only where it lowers energy and gradient: at a cut locus, and where hardly anything holds
// a point, the tangent may lead anywhere.
bool MovingNetwork::predict(double share) {
  const double load = share < 1 ? start_.load + share * (announced_ - start_.load) : announced_;
  const std::shared_ptr<const surface::GeodesicSolver> before = solver_;
  predicted_decrease_ = 0;
  try {
    place(load, start_.points, start_.cut_loci);
  } catch (const Error&) {
    return false;  // a face loses its area on the way between two positions
  }
  const numerics::Evaluation carried = system_->evaluate(1);
  carried_energy_ = carried.value;
  if (!std::isfinite(carried.value)) return false;
  if (carried.gradient.norm() <= gradient_tolerance_ || !has_factors_) return true;
  predicted_decrease_ = 0.5 * carried.gradient.dot(cholesky_.solve(carried.gradient));
  if (tangent_.isZero(0)) return true;
  NetworkState ahead(before->mesh(), start_.points);
  ahead.set_cut_loci(start_.cut_loci);
  ahead.move(share * tangent_);
  decltype(system_) carried_system;
  carried_system.swap(system_);
  const auto carried_elements = elements_;
  place(load, ahead.points(), ahead.cut_loci());
  const numerics::Evaluation there = system_->evaluate(1);
  if (there.value <= carried.value && there.gradient.norm() < carried.gradient.norm()) return true;
  system_ = std::move(carried_system);
  system_->forget();  // the sums are those of the other system
  elements_ = carried_elements;
  return true;
}

bool MovingNetwork::is_doubtful(double energy) const {
  const double decrease = carried_energy_ - energy;
  return std::abs(decrease - predicted_decrease_) > doubtful_decrease * std::abs(energy) + energy_rounding();
}

// Where an equilibrium was lost on the way, the one that was found instead is followed back past that place. This is
// done as a load step is: points that are only carried back may come to the equilibrium that was lost.
double MovingNetwork::loss_on_way_back(const numerics::MinimizerOptions& options) {
  const State here = state();
  const State from = start_;
  const double energy_from = start_energy_;
  const double announced = announced_;
  announce(from.load);
  begin_step();
  const double scale = std::max(std::abs(energy_from), std::abs(start_energy_));
  if (!predict(1)) place(from.load, here.points, here.cut_loci);
  const numerics::MinimizerResult back =
      numerics::minimize(*system_, options, {execution_.cancellation, nullptr, nullptr}, &cholesky_);
  place(here.load, here.points, here.cut_loci);
  start_ = from;
  start_energy_ = energy_from;
  announced_ = announced;
  const double difference = std::abs(back.value - energy_from) - energy_rounding();
  return difference > 0 ? difference / scale : 0;
}

double MovingNetwork::energy_rounding() const {
  return gradient_tolerance_ * unbalanced_length * first_.mesh().diagonal();
}

}  // namespace supple::embedded
