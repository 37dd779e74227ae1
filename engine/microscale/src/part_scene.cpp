#include "part_scene.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "path_limits.h"

namespace supple::microscale {
namespace {

/// After this many corrections of what the plates hold, single nodes are held or released. This comes to an end, where
/// all at once could repeat themselves.
constexpr int max_joint_corrections = 8;
/// Ratio of a pull of a plate on a node that is accepted to the tolerance of the gradient's norm.
constexpr double pull_tolerance = 10;
/// Displacement of the nodes that are held, divided by the size of the mesh, for a difference of the forces.
constexpr double difference_step = 1e-5;

}  // namespace

PartScene::PartScene(const tiling::PeriodicMesh& mesh, const PartSupports& supports,
                     const PartSimulationOptions& options, const Execution& execution)
    : mesh_(mesh),
      supports_(supports),
      options_(options),
      execution_(execution),
      elastic_(std::make_shared<ElasticEnergy>(mesh, options.material)),
      plates_(std::make_shared<PlateBarrier>(supports, options.material, mesh.mesh_size)),
      constraints_(supports.at_rest()) {
  if (options.contact != Switch::off)
    contact_ = std::make_shared<ContactBarrier>(mesh, contact_options(mesh, options.material));
  retraction_ = std::make_unique<RotationRetraction>(mesh, constraints_.fixed());
  cholesky_.bill_to(execution.cost);
  cholesky_.stop_with(execution.cancellation);
  make_system(Eigen::VectorXd::Zero(CellCoordinates{mesh.nodes.cols()}.size()));
}

void PartScene::make_system(Eigen::VectorXd x) {
  numerics::SystemOptions options;
  options.execution = {execution_.cancellation, nullptr, execution_.cost};
  options.min_order = 1;
  // Elasticity comes first, so that a step that would invert an element is shortened before contacts are searched.
  CellSystem::Terms terms{elastic_, plates_};
  if (contact_) terms.push_back(contact_);
  system_ = std::make_unique<CellSystem>(
      cell_state(std::move(x)), std::move(terms),
      numerics::Unknowns(constraints_.fixed(), Eigen::MatrixXd(CellCoordinates::strain_components, 0)),
      std::move(options));
  system_->prepare_terms();
}

void PartScene::set_fraction(double fraction) {
  fraction_ = fraction;
  plates_->set_fraction(fraction);
}

void PartScene::set_state(State state) {
  set_fraction(state.fraction);
  at_ = std::move(state.at);
  if (state.constraints != constraints_) {
    constraints_ = std::move(state.constraints);
    retraction_->fix(constraints_.fixed());
    make_system(std::move(state.x));
    return;
  }
  system_->set_state(cell_state(std::move(state.x)));
  system_->prepare_terms();
}

double PartScene::set_target(double fraction) {
  target_ = fraction;
  return std::abs(target_ - fraction_);
}

double PartScene::gradient_tolerance() const {
  return std::max(options_.tolerance * elastic_->force_scale(x()), elastic_->force_rounding());
}

bool PartScene::must_minimize_again(const numerics::MinimizerResult& result) {
  // The tolerance is in proportion to the forces at the predicted state, which can be larger than those at the
  // equilibrium.
  const bool above_tolerance = result.gradient_norm > gradient_tolerance() && result.iterations > 0;
  return raise_contact_stiffness() || above_tolerance || correct_constraints();
}

bool PartScene::raise_contact_stiffness() {
  if (!contact_ || !contact_->active()) return false;
  const double suggested = contact_->suggested_stiffness(x());
  if (suggested == contact_->stiffness()) return false;
  contact_->set_stiffness(suggested);
  system_->forget();
  previous_.reset();
  return true;
}

bool PartScene::correct_constraints() {
  using Scope = PartSupports::Scope;
  const auto correct = [this](Scope scope) {
    return supports_.corrected(constraints_, x(), system_->full_gradient(), fraction_,
                               pull_tolerance * gradient_tolerance(), scope);
  };
  auto corrected = correct(corrections_ < max_joint_corrections ? Scope::all_plates : Scope::one_node);
  if (!corrected) return false;
  ++corrections_;
  // Two plates that both pull the part are not released at once: one of them may still carry it.
  if (supports_.leaves_rigid_motion(*corrected)) corrected = correct(Scope::one_plate);
  lost_support_ = supports_.leaves_rigid_motion(*corrected);
  // The path gives up after some repetitions, and tries a shorter load step.
  if (lost_support_) return true;
  Eigen::VectorXd moved = x();
  supports_.impose(*corrected, fraction_, moved);
  numerics::EnergySum sum;
  elastic_->add(cell_state(moved), 0, sum);
  if (!std::isfinite(sum.value)) return true;
  constraints_ = std::move(*corrected);
  retraction_->fix(constraints_.fixed());
  make_system(std::move(moved));
  previous_.reset();
  return true;
}

Eigen::VectorXd PartScene::load() const {
  const Eigen::VectorXd rate = supports_.rate(constraints_, x().size());
  const double largest = rate.cwiseAbs().maxCoeff();
  if (largest == 0) return Eigen::VectorXd::Zero(system_->unknowns().size());
  const double step = difference_step * mesh_.mesh_size / largest;
  Eigen::VectorXd difference = Eigen::VectorXd::Zero(x().size());
  for (const double sign : {1.0, -1.0}) {
    numerics::EnergySum sum;
    sum.clear(x().size(), 1);
    elastic_->add(cell_state(x() + sign * step * rate), 1, sum);
    if (!std::isfinite(sum.value)) return Eigen::VectorXd::Zero(system_->unknowns().size());
    difference += sign / (2 * step) * sum.gradient;
  }
  return system_->restrict(difference);
}

bool PartScene::finish(const numerics::MinimizerResult& result) {
  at_.residual = result.gradient_norm / elastic_->force_scale(x());
  const numerics::Evaluation evaluation = system_->evaluate(2);
  at_.energy = system_->energy();
  at_.gradient = system_->full_gradient();
  if (!cholesky_.factorize(evaluation.hessian, 0)) return false;
  at_.tangent = supports_.rate(constraints_, x().size()) - system_->expand(cholesky_.solve(load()));
  return at_.tangent.allFinite();
}

bool PartScene::finish_unstable() {
  // The stiffness is indefinite, or even singular to rounding if the equilibrium is at a bifurcation.
  system_->evaluate(2);
  const Eigen::SimplicialLDLT<numerics::SparseMatrix, Eigen::Lower> indefinite(system_->core());
  const Eigen::VectorXd along = indefinite.solve(load());
  if (!along.allFinite()) return false;
  at_.tangent = supports_.rate(constraints_, x().size()) - system_->expand(along);
  return true;
}

void PartScene::begin_step() {
  start_ = x();
  start_fraction_ = fraction_;
  step_tangent_ = (target_ - fraction_) * at_.tangent;
}

std::vector<Eigen::VectorXd> PartScene::predictions(double part) const {
  std::vector<Eigen::VectorXd> states;
  const double change = target_ - start_fraction_;
  if (previous_ && previous_->change * change > 0) {
    const double ratio = part * change / previous_->change;
    if (ratio <= max_extrapolation) {
      // The cubic Hermite polynomial that has the last two equilibria and their tangents at u = 0 and u = 1.
      const double u = 1 + ratio;
      const double h00 = u * u * (2 * u - 3) + 1;
      const double h10 = u * (u - 1) * (u - 1);
      const double h11 = u * u * (u - 1);
      states.emplace_back(h00 * previous_->x + (1 - h00) * start_ + h10 * previous_->tangent +
                          h11 * (previous_->change / change) * step_tangent_);
    }
  }
  CellState state = cell_state(start_);
  state.move(part * step_tangent_);
  states.push_back(std::move(state.x));
  return states;
}

bool PartScene::predict(double part) {
  corrections_ = 0;
  lost_support_ = false;
  const double fraction = part == 1 ? target_ : start_fraction_ + part * (target_ - start_fraction_);
  std::optional<Eigen::VectorXd> best;
  double best_norm = std::numeric_limits<double>::infinity();
  for (Eigen::VectorXd& state : predictions(part)) {
    supports_.impose(constraints_, fraction, state);
    state.tail<4>().setZero();
    set_fraction(start_fraction_);
    if (system_->look_ahead(cell_state(start_), cell_state(state)) < 1) continue;
    set_fraction(fraction);
    system_->set_state(cell_state(state));
    const numerics::Evaluation evaluation = system_->evaluate(1);
    system_->set_state(cell_state(start_));
    const double norm = evaluation.gradient.norm();
    if (!std::isfinite(evaluation.value) || !(norm < best_norm)) continue;
    best_norm = norm;
    best = std::move(state);
  }
  if (!best) return false;
  set_fraction(fraction);
  system_->set_state(cell_state(std::move(*best)));
  system_->prepare_terms();
  return true;
}

void PartScene::finish_load_step(const numerics::LoadStepResult& arrival) {
  previous_.reset();
  if (!arrival.same_branch || corrections_ > 0) return;
  previous_ = Previous{arrival.fraction * (target_ - start_fraction_), start_, arrival.fraction * step_tangent_};
}

Eigen::VectorXd PartScene::unit_mode(const Eigen::VectorXd& mode) const {
  return mode * (mesh_.beam_width / std::max(mode.cwiseAbs().maxCoeff(), 1e-300));
}

bool PartScene::move_along(const State& from, const Eigen::VectorXd& mode, double amount) {
  CellState state = cell_state(from.x);
  state.move(amount * mode);
  if (system_->look_ahead(cell_state(from.x), state) < 1) return false;
  system_->set_state(std::move(state));
  return true;
}

void PartScene::left_branch() {
  previous_.reset();
  system_->prepare_terms();
}

}  // namespace supple::microscale
