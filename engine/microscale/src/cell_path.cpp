#include "cell_path.h"

#include <Eigen/Dense>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <limits>
#include <utility>

namespace supple::microscale {
namespace {

/// A load step below this change of F (largest component) is not divided again.
constexpr double smallest_load_step = 1e-6;
/// Cubic extrapolation reaches no farther than this many times the step it is made from.
constexpr double longest_extrapolation = 2.5;
/// Two load steps go the same way if the cosine between them is above this.
constexpr double same_direction = 1 - 1e-9;

/// A Newton step that brings the gradient to this share keeps its factorization: a step with the old one costs about a
/// tenth of a new factorization.
constexpr double reuse_contraction = 0.25;

/// Buckling beams curve the energy some 1e8 times less than their elements do, relative to the matrix's scale: the
/// search for a regularization begins well below, and steps that leave an unstable state may be lengthened this often.
constexpr double first_regularization = 1e-10;
constexpr double longest_expansion = 64;

/// Iterative refinement of the response to strains: relative residual where it makes the tangent and where it only
/// predicts the next state, and rounds before the factorization is given up.
constexpr double refined = 1e-9;
constexpr double refined_for_prediction = 1e-5;
constexpr int refinement_rounds = 5;

/// While contact is tightened: the range's factor from one equilibrium to the next, how often, and the relative change
/// of dE/dF below which the range no longer matters.
constexpr double range_factor = 0.25;
constexpr int most_tightenings = 4;
constexpr double unfelt_change = 2e-4;

numerics::PathOptions path_options(const SimulationOptions& simulation) {
  numerics::PathOptions options;
  options.minimizer.reuse_contraction = reuse_contraction;
  options.minimizer.first_regularization = first_regularization;
  options.minimizer.longest_expansion = longest_expansion;
  options.max_iterations = simulation.max_iterations;
  options.largest_step = simulation.max_load_step;
  options.smallest_step = smallest_load_step;
  options.leave_unstable = simulation.buckling != Switch::off;
  // Beams bend so much more softly than elements deform that a curvature of 1e-13 of the matrix's scale may be
  // theirs: with a tolerance, paths of IH29 ended where they can be followed.
  options.zero_curvature = 0;
  return options;
}

/// K x for the lower triangle of K; all columns of x at once, so that K is read once.
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
  look_around();
}

void CellScene::set_state(State state) {
  system_.set_state(model_.state(std::move(state.x)));
  at_ = std::move(state.at);
  look_around();
}

double CellScene::announce(const Eigen::Matrix2d& target) {
  const Eigen::Vector4d wanted(target(0, 0) - 1, target(0, 1), target(1, 0), target(1, 1) - 1);
  change_ = prescribed_part(wanted - x().tail<4>());
  return change_.cwiseAbs().maxCoeff();
}

void CellScene::begin_step() {
  start_ = x();
  along_ = tangent(change_);
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

CellState CellScene::moved(const Eigen::VectorXd& x, const Eigen::VectorXd& step) const {
  const StageTimer timer(execution_.cost, CellState::motion);
  CellState state = model_.state(x);
  state.move(step);
  return state;
}

std::vector<Eigen::VectorXd> CellScene::predictions(double share) const {
  std::vector<Eigen::VectorXd> states;
  if (previous_) {
    const double before = previous_->travelled.norm();
    const double ahead = share * change_.norm();
    const double cosine = previous_->travelled.dot(change_) / (before * change_.norm());
    if (cosine > same_direction && ahead <= longest_extrapolation * before) {
      // Cubic Hermite polynomial through the last two equilibria and their tangents; u = 0 and 1 there.
      const double u = 1 + ahead / before;
      const double h00 = u * u * (2 * u - 3) + 1;
      const double h10 = u * (u - 1) * (u - 1);
      const double h11 = u * u * (u - 1);
      states.emplace_back(h00 * previous_->x + (1 - h00) * x() + h10 * previous_->tangent +
                          h11 * (before / change_.norm()) * along_);
    }
  }
  states.emplace_back(moved(x(), share * along_).x);
  return states;
}

bool CellScene::predict(double share) {
  const Eigen::Vector4d strain_after = start_.tail<4>() + share * change_;
  std::optional<Eigen::VectorXd> best;
  double best_norm = std::numeric_limits<double>::infinity();
  for (Eigen::VectorXd& state : predictions(share)) {
    // The prescribed components exactly; the free ones as predicted.
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
  look_around();
  return true;
}

void CellScene::arrived(const numerics::Arrival& arrival) {
  previous_.reset();
  if (arrival.same_branch) previous_ = Previous{arrival.share * change_, start_, arrival.share * along_};
}

double CellScene::gradient_tolerance() const {
  const ElasticEnergy& elastic = model_.elastic();
  return std::max(options_.tolerance * elastic.force_scale(x()), elastic.force_rounding());
}

bool CellScene::unsettled(const numerics::MinimizerResult& result) {
  // The forces of the prediction, by which the tolerance was measured, can be larger than those of the equilibrium.
  const bool loose = result.gradient_norm > gradient_tolerance() && result.iterations > 0;
  return raise_contact_stiffness() || loose;
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
      (fresh && solve_for_strains()) || (cholesky().factorize(evaluation.hessian, 0) && solve_for_strains());
  if (stable) condense();
  return stable;
}

bool CellScene::finish_unstable() {
  // Also for one at the very point where it loses stability.
  system_.evaluate(2);
  Eigen::SimplicialLDLT<numerics::SparseMatrix, Eigen::Lower> indefinite(system_.core());
  at_.response = indefinite.solve(-system_.border());
  condense();
  return at_.response.allFinite();
}

bool CellScene::solve_for_strains() {
  const Eigen::MatrixXd& right = system_.border();
  const double wanted = (options_.tangents ? refined : refined_for_prediction) * right.norm();
  at_.response = -cholesky().solve_core(right);
  for (int round = 0;; ++round) {
    const Eigen::MatrixXd residual = -right - product(system_.core(), at_.response);
    if (!(residual.norm() > wanted)) return true;
    if (round == refinement_rounds) return residual.norm() < 1e3 * wanted;
    at_.response += cholesky().solve_core(residual);
  }
}

void CellScene::condense() {
  // The response leaves a residual, in which soft cells hide much of it. With the residual's work the error of the
  // stiffness is quadratic in that of the response.
  const Eigen::MatrixXd residual = -system_.border() - product(system_.core(), at_.response);
  const Eigen::Matrix4d condensed = system_.border().transpose() * at_.response - at_.response.transpose() * residual;
  at_.condensed = system_.corner() + 0.5 * (condensed + condensed.transpose());
}

Eigen::VectorXd CellScene::unit_mode(const Eigen::VectorXd& mode) const {
  const double largest = mode.head(mode.size() - 4).cwiseAbs().maxCoeff();
  return mode * (model_.mesh()->beam_width / std::max(largest, 1e-300));
}

bool CellScene::move_along(const State& from, const Eigen::VectorXd& mode, double amount) {
  CellState state = moved(from.x, amount * mode);
  if (system_.look_ahead(model_.state(from.x), state) < 1) return false;
  system_.set_state(std::move(state));
  return true;
}

void CellScene::left_branch() {
  previous_.reset();
  look_around();
}

CellPath::CellPath(CellModel& model, Eigen::VectorXd x, const FreeStrains& free, const SimulationOptions& options,
                   const Execution& execution)
    : scene_(model, std::move(x), free, options, execution), path_(scene_, path_options(options), execution) {}

Stop CellPath::stopped() const {
  switch (path_.stopped()) {
    case numerics::PathStop::converged:
      return Stop::converged;
    case numerics::PathStop::iteration_limit:
      return Stop::iteration_limit;
    case numerics::PathStop::step_too_small:
      break;
  }
  return Stop::step_too_small;
}

void CellPath::restore(const Loose& loose) {
  scene_.set_contact(loose.contact);
  path_.restore(loose.snapshot);
}

bool CellPath::settle_with_range(double range) {
  scene_.set_contact({scene_.contact().stiffness, range});
  scene_.look_around();
  const int branches = path_.counts().branches_left;
  const bool settled = path_.settle() && path_.stable() && path_.counts().branches_left == branches;
  path_.set_branches_left(branches);
  return settled;
}

void CellPath::tighten_contact() {
  if (!path_.stable() || scene_.contacts() == 0) return;
  const Loose first = loose_now();
  const auto previous = scene_.previous();
  Loose best = first;
  for (int k = 0; k < most_tightenings && scene_.contacts() > 0; ++k) {
    const Eigen::Vector4d before = scene_.at().strain_gradient;
    if (!settle_with_range(best.contact.range * range_factor)) {
      restore(best);
      break;
    }
    // A path that ended at this strain has done so all the same.
    best = loose_now();
    best.snapshot.stopped = first.snapshot.stopped;
    const Eigen::Vector4d change = scene_.at().strain_gradient - before;
    if (change.norm() <= unfelt_change * scene_.at().strain_gradient.norm()) break;
  }
  restore(best);
  scene_.set_previous(previous);
  loose_ = first;
}

void CellPath::loosen_contact() {
  if (loose_) restore(*loose_);
  loose_.reset();
}

}  // namespace supple::microscale
