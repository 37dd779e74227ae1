#include "fine_equilibria.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace supple::microscale {
namespace {

/// Smallest tolerance of the minimization. A residual of this size changes the stress by less than a thousandth of the
/// mesh's error.
constexpr double min_tolerance = 1e-6;

/// Limits of Newton steps with one factorization. They have converged if the next step would decrease the energy by at
/// most `convergence_ratio` times the decrease of the first step. That next step is added to the result to first order.
struct NewtonLimits {
  int max_steps;
  double convergence_ratio;
};
constexpr NewtonLimits limits_for_stresses{4, 1e-3};
/// The tangent requires a more accurate state, because it changes fast from state to state near a bifurcation.
constexpr NewtonLimits limits_for_tangents{10, 1e-6};

/// The response to strains is iterated until its error changes the tangent by less than this ratio. If that takes more
/// iterations than the limit, a factorization at the current state is cheaper.
constexpr double negligible_ratio = 1e-5;
constexpr int max_response_iterations = 10;
constexpr double smallest_positive = std::numeric_limits<double>::min();  ///< used instead of 0 as a divisor

SimulationOptions fine_options(const SimulationOptions& options) {
  SimulationOptions fine = options;
  fine.tolerance = std::max(options.tolerance, min_tolerance);
  return fine;
}

/// A Newton step from a state with the factorization at another state.
struct Step {
  Eigen::VectorXd core;             ///< change of the unknown displacements, mm
  Eigen::VectorXd free;             ///< change of F along its free directions
  Eigen::Vector4d strain;           ///< change of the components of F
  Eigen::Vector4d strain_gradient;  ///< dE / dF after the step, to first order
  double decrease = 0;              ///< twice the decrease of the energy that the step predicts, MPa mm^2
  double forces = 0;                ///< norm of the forces that do not balance before the step, MPa mm
};

/// The factorized stiffness at the state where the Newton steps start, and quantities that follow from it.
class Linearized {
 public:
  /// Factorizes the stiffness at the system's current state. Returns null if it is not positive definite.
  static std::unique_ptr<Linearized> at(CellSystem& system, numerics::ShiftedCholesky& cholesky) {
    auto result = std::unique_ptr<Linearized>(new Linearized(system, cholesky));
    auto matrix = std::make_shared<numerics::BorderedMatrix>();
    matrix->core = system.core();
    if (!cholesky.factorize(numerics::Hessian(std::shared_ptr<const numerics::BorderedMatrix>(std::move(matrix))), 0))
      return nullptr;
    result->response_ = -cholesky.solve_core(system.border());
    result->border_ = system.border();
    const Eigen::Matrix4d coupled = result->border_.transpose() * result->response_;
    result->condensed_ = system.corner() + 0.5 * (coupled + coupled.transpose());
    const Eigen::MatrixXd& directions = system.unknowns().directions();
    result->free_stiffness_.compute(directions.transpose() * result->condensed_ * directions);
    if (directions.cols() > 0 && result->free_stiffness_.info() != Eigen::Success) return nullptr;
    return result;
  }

  /// The Newton step from the system's current state.
  Step step() const {
    const Eigen::VectorXd& gradient = system_.full_gradient();
    const Eigen::VectorXd forces = system_.restrict(gradient).head(system_.unknowns().core());
    const Eigen::MatrixXd& directions = system_.unknowns().directions();
    Step step;
    step.core = -cholesky_.solve_core(forces);
    step.strain_gradient = gradient.tail<4>() + border_.transpose() * step.core;
    step.decrease = -forces.dot(step.core);
    step.forces = forces.norm();
    step.strain.setZero();
    step.free.resize(directions.cols());
    if (directions.cols() > 0) {
      const Eigen::VectorXd residual = directions.transpose() * step.strain_gradient;
      step.free = -free_stiffness_.solve(residual);
      step.decrease -= residual.dot(step.free);
      step.strain = directions * step.free;
      step.core += response_ * step.strain;
      step.strain_gradient += condensed_ * step.strain;
    }
    return step;
  }

  /// d2 E / dF2 of the minimized energy at the state of the factorization.
  const Eigen::Matrix4d& condensed() const { return condensed_; }
  /// The same at the system's current state, whose Hessian must have been evaluated. The response is found by conjugate
  /// gradients, which begin with the response at the state of the factorization and are preconditioned by the latter.
  /// None if they do not converge.
  std::optional<Eigen::Matrix4d> condensed_at_current_state() const {
    const auto stiffness = system_.core().selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd& border = system_.border();
    Eigen::MatrixXd response = response_;
    Eigen::MatrixXd stiffness_response = stiffness * response;
    Eigen::MatrixXd residual = -border - stiffness_response;
    Eigen::MatrixXd step;
    Eigen::Array4d previous_work;
    for (int iteration = 0; iteration < max_response_iterations; ++iteration) {
      const Eigen::MatrixXd preconditioned = cholesky_.solve_core(residual);
      // A response with the error d changes the tangent by d^T K d. The work of the residual approximates that.
      const Eigen::Array4d residual_work = residual.cwiseProduct(preconditioned).colwise().sum().transpose().array();
      if (!residual_work.allFinite()) return std::nullopt;
      if (iteration == 0)
        step = preconditioned;
      else
        step = preconditioned + step * (residual_work / previous_work.max(smallest_positive)).matrix().asDiagonal();
      previous_work = residual_work;
      const Eigen::MatrixXd stiffness_step = stiffness * step;
      const Eigen::Array4d curvature = step.cwiseProduct(stiffness_step).colwise().sum().transpose().array();
      if ((curvature < 0).any()) return std::nullopt;
      const Eigen::Vector4d length = (residual_work / curvature.max(smallest_positive)).matrix();
      const Eigen::Array4d residual_before = residual.colwise().squaredNorm().transpose().array();
      response += step * length.asDiagonal();
      stiffness_response += stiffness_step * length.asDiagonal();
      residual -= stiffness_step * length.asDiagonal();
      const Eigen::Matrix4d coupled = border.transpose() * response;
      const Eigen::Matrix4d condensed =
          system_.corner() + coupled + coupled.transpose() + response.transpose() * stiffness_response;
      // The new work of the residual would take another solve. It decreases about as fast as the residual's square.
      const Eigen::Array4d reduction =
          residual.colwise().squaredNorm().transpose().array() / residual_before.max(smallest_positive);
      if ((residual_work * reduction).sum() <= negligible_ratio * condensed.norm()) return condensed;
    }
    return std::nullopt;
  }

 private:
  Linearized(CellSystem& system, const numerics::ShiftedCholesky& cholesky) : system_(system), cholesky_(cholesky) {}

  CellSystem& system_;
  const numerics::ShiftedCholesky& cholesky_;
  Eigen::MatrixXd response_;  ///< dw / dF
  Eigen::MatrixXd border_;
  Eigen::Matrix4d condensed_ = Eigen::Matrix4d::Zero();
  Eigen::LLT<Eigen::MatrixXd> free_stiffness_;
};

}  // namespace

FineEquilibria::FineEquilibria(const CellModel& coarse, const SimulationOptions& options)
    : options_(fine_options(options)),
      refined_(tiling::refine(*coarse.mesh())),
      model_(refined_.mesh, options.material, options.contact != Switch::off, CellModel::Retraction::linear) {
  // A path has few states with one factorization each, so that a better ordering does not pay.
  model_.workspace().cholesky.use_fast_ordering();
}

std::optional<FineEquilibria::FineEquilibrium> FineEquilibria::find(const CellPath& coarse, const FreeStrains& free,
                                                                    const Execution& execution) {
  Eigen::VectorXd x = prolonged(coarse.x());
  const CellScene::Contact contact = model_.contact() ? coarse.contact() : CellScene::Contact{};
  set_contact(contact);
  if (const auto response = solve_by_newton(x, free, execution)) return FineEquilibrium{*response, true};
  return minimize(std::move(x), free, contact, execution);
}

Eigen::VectorXd FineEquilibria::prolonged(const Eigen::VectorXd& x) const {
  const CellCoordinates& coordinates = model_.coordinates();
  Eigen::VectorXd fine(coordinates.size());
  const Eigen::Matrix2Xd displacements =
      refined_.prolong(Eigen::Map<const Eigen::Matrix2Xd>(x.data(), 2, refined_.coarse_nodes));
  fine.head(coordinates.strain()) = Eigen::Map<const Eigen::VectorXd>(displacements.data(), displacements.size());
  fine.tail<CellCoordinates::strain_components>() = x.tail<CellCoordinates::strain_components>();
  return fine;
}

void FineEquilibria::set_contact(const CellScene::Contact& contact) {
  if (!model_.contact()) return;
  model_.contact()->set_stiffness(contact.stiffness);
  if (model_.contact()->range() != contact.range) model_.contact()->set_range(contact.range);
}

std::optional<PatchResponse> FineEquilibria::solve_by_newton(const Eigen::VectorXd& x, const FreeStrains& free,
                                                             const Execution& execution) {
  CellSystem system = cell_system(model_, x, free, execution);
  system.prepare_terms();
  numerics::ShiftedCholesky& cholesky = model_.workspace().cholesky;
  cholesky.stop_with(execution.cancellation);
  system.evaluate(2);
  if (!std::isfinite(system.energy())) return std::nullopt;
  const auto linearized = Linearized::at(system, cholesky);
  if (!linearized) return std::nullopt;
  Step step = linearized->step();
  const NewtonLimits& limits = options_.tangents ? limits_for_tangents : limits_for_stresses;
  const double first_decrease = step.decrease;
  double previous_decrease = first_decrease;
  for (int k = 0; k < limits.max_steps; ++k) {
    Eigen::VectorXd change(step.core.size() + step.free.size());
    change << step.core, step.free;
    const CellState from = system.state();
    const CellState to = model_.state(from.x + system.expand(change));
    if (system.look_ahead(from, to) < 1) return std::nullopt;
    system.set_state(to);
    system.prepare_terms();
    system.evaluate(1);
    if (!std::isfinite(system.energy())) return std::nullopt;
    step = linearized->step();
    if (step.decrease <= limits.convergence_ratio * first_decrease ||
        step.forces <= model_.elastic().force_rounding()) {
      PatchResponse response;
      response.deformation_gradient =
          model_.coordinates().deformation_gradient(system.state().x) +
          (Eigen::Matrix2d() << step.strain[0], step.strain[1], step.strain[2], step.strain[3]).finished();
      response.strain_gradient = step.strain_gradient;
      response.energy = system.energy() - step.decrease / 2;
      if (options_.tangents) {
        system.evaluate(2);
        std::optional<Eigen::Matrix4d> condensed = linearized->condensed_at_current_state();
        if (!condensed) {
          const auto here = Linearized::at(system, cholesky);
          if (!here) return std::nullopt;
          condensed = here->condensed();
        }
        response.condensed = *condensed;
      }
      return response;
    }
    if (step.decrease > previous_decrease) return std::nullopt;
    previous_decrease = step.decrease;
  }
  return std::nullopt;
}

std::optional<FineEquilibria::FineEquilibrium> FineEquilibria::minimize(Eigen::VectorXd x, const FreeStrains& free,
                                                                        const CellScene::Contact& contact,
                                                                        const Execution& execution) {
  model_.reset_contact();
  CellPath path(model_, std::move(x), free, options_, execution);
  if (model_.contact()) path.start_with_contact(contact);
  if (!path.find_equilibrium() || !path.stable()) return std::nullopt;
  const CellEquilibrium& at = path.equilibrium();
  return FineEquilibrium{
      {model_.coordinates().deformation_gradient(path.x()), at.strain_gradient, at.condensed, at.energy},
      path.take_counts().branches_left == 0};
}

}  // namespace supple::microscale
