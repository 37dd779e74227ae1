#include "moving_network.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "supple/base/error.h"
#include "tangent_change.h"

namespace supple::embedded {
namespace {

/// Of a load step, for the difference of gradients: rounding and curvature spoil it about as much.
constexpr double small_share = 1e-6;

}  // namespace

MovingNetwork::MovingNetwork(const surface::GeodesicSolver& solver, const Network& network,
                             std::vector<bool> held_points, const std::vector<bool>& held_coordinates,
                             GeodesicElementsOptions options, const MovingHost& host, double gradient_tolerance,
                             Execution execution)
    : first_(solver),
      network_(network),
      held_points_(std::move(held_points)),
      unknowns_(held_coordinates),
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
      std::move(state), numerics::System<NetworkState>::Terms{elements}, unknowns_,
      numerics::SystemOptions{.execution = execution_, .sums = sums_});
  elements_ = std::move(elements);
  solver_ = std::move(solver);
  load_ = load;
}

// With the energy's derivatives by points p and the load t, an equilibrium stays one where H_pp dp + H_pt dt = 0. H_pt
// is the difference of gradients for points that keep their places in the material while the surface moves a little:
// that is as good as its derivative here, at the price of one gradient.
void MovingNetwork::begin_step() {
  start_ = state();
  tangent_ = Eigen::VectorXd::Zero(unknowns_.degrees_of_freedom());
  const numerics::Evaluation here = system_->evaluate(2);
  Eigen::VectorXd unbalanced = -system_->full_gradient();
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
  numerics::ShiftedCholesky cholesky;
  if (!cholesky.factorize(here.hessian, 0)) return;
  Eigen::VectorXd answer = -cholesky.solve(unknowns_.restrict(unbalanced)) / small_share;
  // Paths that are kept at cut loci have followed these.
  if (carried.last_step().size() > 0) answer += unknowns_.restrict(carried.last_step()) / small_share;
  if (answer.allFinite()) tangent_ = unknowns_.expand(answer);
}

bool MovingNetwork::predict(double share) {
  NetworkState ahead(solver_->mesh(), start_.points);
  // The surface where the step began, which the last trial may have left.
  place(start_.load, start_.points);
  ahead = NetworkState(solver_->mesh(), start_.points);
  ahead.set_cut_loci(start_.cut_loci);
  ahead.move(share * tangent_);
  const double load = start_.load + share * (announced_ - start_.load);
  try {
    place(load, ahead.points(), ahead.cut_loci());
  } catch (const Error&) {
    return false;  // a face loses its area on the way between two positions
  }
  if (std::isfinite(system_->evaluate(0).value)) return true;
  // A triangle of a membrane is inside out where the tangent leads: it is not where the points stay in their places.
  place(load, start_.points, start_.cut_loci);
  return std::isfinite(system_->evaluate(0).value);
}

}  // namespace supple::embedded
