#include "cell_path.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <limits>
#include <utility>

#include "path_limits.h"

namespace supple::microscale {
namespace {

/// A load step below this change of F (largest component) is not divided again.
constexpr double min_load_step = 1e-6;
/// Two load steps have the same direction if the cosine of the angle between them is above this.
constexpr double same_direction_cosine = 1 - 1e-9;

/// The curvature of the energy along the buckling of a beam is about 1e-8 of the Hessian's scale. The first
/// regularization that is tried, relative to that scale, is therefore well below.
constexpr double first_regularization = 1e-10;

/// Relative residual of the response to strains below which its iterative refinement ends, if tangents are returned.
constexpr double max_tangent_residual = 1e-9;
/// The same, if the response only predicts the next state.
constexpr double max_prediction_residual = 1e-5;
constexpr int max_refinements = 5;

/// Factor of each reduction of the contact barrier's range.
constexpr double range_factor = 0.25;
constexpr int max_range_reductions = 4;
/// The range no longer matters if its reduction changes dE/dF by less than this ratio.
constexpr double negligible_change = 2e-4;

numerics::PathOptions path_options(const SimulationOptions& simulation) {
  numerics::PathOptions options;
  options.minimizer.reuse_contraction = reuse_contraction;
  options.minimizer.first_regularization = first_regularization;
  options.minimizer.max_expansion = max_expansion;
  options.max_iterations = simulation.max_iterations;
  options.largest_step = simulation.max_load_step;
  options.smallest_step = min_load_step;
  options.leave_unstable = simulation.buckling != Switch::off;
  // Beams can be so soft in bending, compared with elements, that a curvature of 1e-13 of the matrix's scale may be
  // theirs. With a tolerance for it, paths of the family IH29 ended although they can be followed.
  options.curvature_tolerance = 0;
  return options;
}

/// K x for the symmetric K of which `lower` is the lower triangle. All four columns of x are multiplied in one pass
/// over K.
Eigen::MatrixXd product(const numerics::SparseMatrix& lower, const Eigen::MatrixXd& x) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
  const Rows from = x;
  Rows to = Rows::Zero(x.rows(), 4);
  for (Eigen::Index column = 0; column < lower.outerSize(); ++column) {
    const Eigen::RowVector4d own = from.row(column);
    Eigen::RowVector4d sum = Eigen::RowVector4d::Zero();
    for (numerics::SparseMatrix::InnerIterator entry(lower, column); entry; ++entry) {
      sum += entry.value() * from.row(entry.row());
      if (entry.row() != column) to.row(entry.row()) += entry.value() * own;
    }
    to.row(column) += sum;
  }
  return to;
}

}  // namespace

CellScene::CellScene(CellModel& model, Eigen::VectorXd x, const FreeStrains& free, const SimulationOptions& options,
                     const Execution& execution)
    : model_(model),
      options_(options),
      execution_(execution),
      system_(cell_system(model, std::move(x), free, execution)) {
  cholesky().bill_to(execution.cost);
  prepare_terms();
}

void CellScene::set_state(State state) {
  system_.set_state(model_.state(std::move(state.x)));
  at_ = std::move(state.at);
  prepare_terms();
}

double CellScene::set_target(const Eigen::Matrix2d& target) {
  const Eigen::Vector4d target_strain(target(0, 0) - 1, target(0, 1), target(1, 0), target(1, 1) - 1);
  change_ = prescribed_part(target_strain - x().tail<4>());
  return change_.cwiseAbs().maxCoeff();
}

void CellScene::begin_step() {
  start_ = x();
  step_tangent_ = tangent(change_);
}

Eigen::Vector4d CellScene::prescribed_part(const Eigen::Vector4d& change) const {
  Eigen::Vector4d part = change;
  const Eigen::MatrixXd& free = system_.unknowns().directions();
  for (Eigen::Index k = 0; k < free.cols(); ++k) part -= free.col(k).dot(change) * free.col(k);
  return part;
}

Eigen::VectorXd CellScene::tangent(const Eigen::Vector4d& change) const {
  const Eigen::MatrixXd& free = system_.unknowns().directions();
  Eigen::Vector4d strain = change;
  if (free.cols() > 0) {
    const Eigen::MatrixXd stiffness = free.transpose() * at_.condensed * free;
    const Eigen::VectorXd q = stiffness.ldlt().solve(-free.transpose() * at_.condensed * change);
    if (q.allFinite()) strain += free * q;
  }
  Eigen::VectorXd along(x().size());
  along.head(x().size() - 4) = system_.unknowns().expand_core(at_.response * strain);
  along.tail<4>() = strain;
  return along;
}

CellState CellScene::retracted(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const {
  const StageTimer timer(execution_.cost, CellState::motion);
  CellState state = model_.state(x);
  state.move(step);
  return state;
}

std::vector<Eigen::VectorXd> CellScene::predictions(double fraction) const {
  std::vector<Eigen::VectorXd> states;
  if (previous_) {
    const double before = previous_->load_change.norm();
    const double ahead = fraction * change_.norm();
    const double cosine = previous_->load_change.dot(change_) / (before * change_.norm());
    if (cosine > same_direction_cosine && ahead <= max_extrapolation * before) {
      // The cubic Hermite polynomial that has the last two equilibria and their tangents at u = 0 and u = 1.
      const double u = 1 + ahead / before;
      const double h00 = u * u * (2 * u - 3) + 1;
      const double h10 = u * (u - 1) * (u - 1);
      const double h11 = u * u * (u - 1);
      states.emplace_back(h00 * previous_->x + (1 - h00) * x() + h10 * previous_->tangent +
                          h11 * (before / change_.norm()) * step_tangent_);
    }
  }
  states.emplace_back(retracted(x(), fraction * step_tangent_).x);
  return states;
}

bool CellScene::predict(double fraction) {
  const Eigen::Vector4d strain_after = start_.tail<4>() + fraction * change_;
  std::optional<Eigen::VectorXd> best;
  double best_norm = std::numeric_limits<double>::infinity();
  for (Eigen::VectorXd& state : predictions(fraction)) {
    // The prescribed components of F are set exactly, the free ones as predicted.
    const Eigen::Vector4d predicted = state.tail<4>();
    state.tail<4>() = predicted + prescribed_part(strain_after - predicted);
    if (system_.look_ahead(model_.state(start_), model_.state(state)) < 1) continue;
    system_.set_state(model_.state(state));
    const double norm = system_.evaluate(1).gradient.norm();
    system_.set_state(model_.state(start_));
    if (norm < best_norm) {
      best_norm = norm;
      best = std::move(state);
    }
  }
  if (!best) return false;
  system_.set_state(model_.state(std::move(*best)));
  prepare_terms();
  return true;
}

void CellScene::finish_load_step(const numerics::LoadStepResult& arrival) {
  previous_.reset();
  if (arrival.same_branch) previous_ = Previous{arrival.fraction * change_, start_, arrival.fraction * step_tangent_};
}

double CellScene::gradient_tolerance() const {
  const ElasticEnergy& elastic = model_.elastic();
  return std::max(options_.tolerance * elastic.force_scale(x()), elastic.force_rounding());
}

bool CellScene::must_minimize_again(const numerics::MinimizerResult& result) {
  // The tolerance is in proportion to the forces at the predicted state, which can be larger than those at the
  // equilibrium.
  const bool above_tolerance = result.gradient_norm > gradient_tolerance() && result.iterations > 0;
  return raise_contact_stiffness() || above_tolerance;
}

bool CellScene::raise_contact_stiffness() {
  ContactBarrier* contact = model_.contact();
  if (!contact || !contact->active()) return false;
  const double suggested = contact->suggested_stiffness(x());
  if (suggested == contact->stiffness()) return false;
  contact->set_stiffness(suggested);
  system_.forget();
  previous_.reset();
  return true;
}

void CellScene::set_contact(const Contact& contact) {
  model_.contact()->set_stiffness(contact.stiffness);
  model_.contact()->set_range(contact.range);
  system_.forget();
}

int CellScene::contacts() const {
  const ContactBarrier* contact = std::as_const(model_).contact();
  return contact ? contact->status(x()).pairs : 0;
}

bool CellScene::finish(const numerics::MinimizerResult& result) {
  at_.residual = result.gradient_norm / model_.elastic().force_scale(x());
  const numerics::Evaluation evaluation = system_.evaluate(2);
  at_.energy = system_.energy();
  at_.strain_gradient = system_.full_gradient().tail<4>();
  const bool fresh = result.factorized_at >= 0 && result.history.back().regularization == 0;
  const bool stable =
      (fresh && solve_for_response()) || (cholesky().factorize(evaluation.hessian, 0) && solve_for_response());
  if (stable) condense();
  return stable;
}

bool CellScene::finish_unstable() {
  // K is indefinite, or even singular to rounding if the equilibrium is at a bifurcation.
  system_.evaluate(2);
  Eigen::SimplicialLDLT<numerics::SparseMatrix, Eigen::Lower> indefinite(system_.core());
  at_.response = indefinite.solve(-system_.border());
  condense();
  return at_.response.allFinite();
}

bool CellScene::solve_for_response() {
  const Eigen::MatrixXd& right = system_.border();
  const double max_residual = (options_.tangents ? max_tangent_residual : max_prediction_residual) * right.norm();
  at_.response = -cholesky().solve_core(right);
  for (int iteration = 0;; ++iteration) {
    const Eigen::MatrixXd residual = -right - product(system_.core(), at_.response);
    if (!(residual.norm() > max_residual)) return true;
    if (iteration == max_refinements) return residual.norm() < 1e3 * max_residual;
    at_.response += cholesky().solve_core(residual);
  }
}

void CellScene::condense() {
  // The response of soft cells can have a large error although its residual is small. With the term of the residual,
  // the error of the stiffness is quadratic in the error of the response.
  const Eigen::MatrixXd residual = -system_.border() - product(system_.core(), at_.response);
  const Eigen::Matrix4d condensed = system_.border().transpose() * at_.response - at_.response.transpose() * residual;
  at_.condensed = system_.corner() + 0.5 * (condensed + condensed.transpose());
}

Eigen::VectorXd CellScene::unit_mode(const Eigen::VectorXd& mode) const {
  const double largest = mode.head(mode.size() - 4).cwiseAbs().maxCoeff();
  return mode * (model_.mesh()->beam_width / std::max(largest, 1e-300));
}

bool CellScene::move_along(const State& from, const Eigen::VectorXd& mode, double amount) {
  CellState state = retracted(from.x, amount * mode);
  if (system_.look_ahead(model_.state(from.x), state) < 1) return false;
  system_.set_state(std::move(state));
  return true;
}

void CellScene::left_branch() {
  previous_.reset();
  prepare_terms();
}

CellPath::CellPath(CellModel& model, Eigen::VectorXd x, const FreeStrains& free, const SimulationOptions& options,
                   const Execution& execution)
    : scene_(model, std::move(x), free, options, execution), path_(scene_, path_options(options), execution) {}

Stop CellPath::stopped() const {
  switch (path_.stopped()) {
    case numerics::PathTermination::converged:
      return Stop::converged;
    case numerics::PathTermination::iteration_limit:
      return Stop::iteration_limit;
    case numerics::PathTermination::step_too_small:
      break;
  }
  return Stop::step_too_small;
}

void CellPath::restore(const SavedState& saved) {
  scene_.set_contact(saved.contact);
  path_.restore(saved.snapshot);
}

bool CellPath::find_equilibrium_with_range(double range) {
  scene_.set_contact({scene_.contact().stiffness, range});
  scene_.prepare_terms();
  const int branches = path_.counts().branches_left;
  const bool found = path_.find_equilibrium() && path_.stable() && path_.counts().branches_left == branches;
  path_.set_branches_left(branches);
  return found;
}

void CellPath::reduce_contact_range() {
  if (!path_.stable() || scene_.contacts() == 0) return;
  const SavedState first = save();
  const auto previous = scene_.previous();
  SavedState best = first;
  for (int k = 0; k < max_range_reductions && scene_.contacts() > 0; ++k) {
    const Eigen::Vector4d before = scene_.at().strain_gradient;
    if (!find_equilibrium_with_range(best.contact.range * range_factor)) {
      restore(best);
      break;
    }
    // If the path has ended at this strain, the reason why it ended must not be overwritten.
    best = save();
    best.snapshot.stopped = first.snapshot.stopped;
    const Eigen::Vector4d change = scene_.at().strain_gradient - before;
    if (change.norm() <= negligible_change * scene_.at().strain_gradient.norm()) break;
  }
  restore(best);
  scene_.set_previous(previous);
  before_reduction_ = first;
}

void CellPath::restore_contact_range() {
  if (before_reduction_) restore(*before_reduction_);
  before_reduction_.reset();
}

}  // namespace supple::microscale
