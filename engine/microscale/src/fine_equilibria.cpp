#include "fine_equilibria.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <utility>

namespace supple::microscale {
namespace {

/// Where the path's minimization has to find the state, it need not do so more exactly: a residual of this share
/// changes the stress by less than a thousandth of the mesh's error.
constexpr double loosest_tolerance = 1e-6;

/// How many Newton steps are made with one factorization at most, and when they have converged: once the square of a
/// step, measured by the energy, is this share of the first one's. What that step still changes is added to first
/// order.
struct Steps {
  int max_number;
  double converged_share;
};
constexpr Steps for_stresses{4, 1e-3};
/// Near a bifurcation the tangent changes so fast from state to state that it needs the state more exactly.
constexpr Steps for_tangents{10, 1e-6};

/// The response to strains is improved until what it still adds to the tangent is this share of it, in at most so many
/// rounds with the factorization of another state. After them the present state's own factorization is cheaper.
constexpr double unfelt_share = 1e-5;
constexpr int max_response_rounds = 10;
constexpr double smallest_positive = std::numeric_limits<double>::min();  ///< in place of 0 as a divisor

SimulationOptions options_for(const SimulationOptions& options) {
  SimulationOptions fine = options;
  fine.tolerance = std::max(options.tolerance, loosest_tolerance);
  return fine;
}

/// A step from a state by the factorization of another one, and what the energy is to first order after it.
struct Step {
  Eigen::VectorXd core;             ///< of the displacements
  Eigen::VectorXd free;             ///< along the free directions of F
  Eigen::Vector4d strain;           ///< of F
  Eigen::Vector4d strain_gradient;  ///< dE / dF after the step
  double decrease = 0;              ///< twice what the energy falls by
  double forces = 0;                ///< norm of those that do not balance before the step
};

/// The stiffness at the state from which Newton's steps start, and what follows from its factorization.
class Linearized {
 public:
  /// Null where it is not positive definite.
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

  /// The step to the equilibrium from the system's present state.
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

  /// d2 E / dF2 at the state of the factorization.
  const Eigen::Matrix4d& condensed() const { return condensed_; }
  /// d2 E / dF2 at the system's present state, whose Hessian was evaluated. The response is found by conjugate
  /// gradients, which begin with the response of the first state and are preconditioned by its factorization. None
  /// where they do not converge.
  std::optional<Eigen::Matrix4d> condensed_here() const {
    const auto stiffness = system_.core().selfadjointView<Eigen::Lower>();
    const Eigen::MatrixXd& border = system_.border();
    Eigen::MatrixXd response = response_;
    Eigen::MatrixXd stretched = stiffness * response;
    Eigen::MatrixXd residual = -border - stretched;
    Eigen::MatrixXd step;
    Eigen::Array4d remaining_before;
    for (int round = 0; round < max_response_rounds; ++round) {
      const Eigen::MatrixXd improvement = cholesky_.solve_core(residual);
      // What a response that errs by d adds to the tangent is d^T K d, which the residual's work measures.
      const Eigen::Array4d remaining = residual.cwiseProduct(improvement).colwise().sum().transpose().array();
      if (!remaining.allFinite()) return std::nullopt;
      if (round == 0)
        step = improvement;
      else
        step = improvement + step * (remaining / remaining_before.max(smallest_positive)).matrix().asDiagonal();
      remaining_before = remaining;
      const Eigen::MatrixXd stretched_step = stiffness * step;
      const Eigen::Array4d curvature = step.cwiseProduct(stretched_step).colwise().sum().transpose().array();
      if ((curvature < 0).any()) return std::nullopt;
      const Eigen::Vector4d length = (remaining / curvature.max(smallest_positive)).matrix();
      const Eigen::Array4d residual_before = residual.colwise().squaredNorm().transpose().array();
      response += step * length.asDiagonal();
      stretched += stretched_step * length.asDiagonal();
      residual -= stretched_step * length.asDiagonal();
      const Eigen::Matrix4d coupled = border.transpose() * response;
      const Eigen::Matrix4d condensed =
          system_.corner() + coupled + coupled.transpose() + response.transpose() * stretched;
      // To know what remains now takes another solution with the factorization. The squares of the residuals fall
      // about as fast.
      const Eigen::Array4d fall =
          residual.colwise().squaredNorm().transpose().array() / residual_before.max(smallest_positive);
      if ((remaining * fall).sum() <= unfelt_share * condensed.norm()) return condensed;
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
    : options_(options_for(options)),
      refined_(tiling::refine(*coarse.mesh())),
      model_(refined_.mesh, options.material, options.contact != Switch::off, CellModel::Motion::straight) {
  // A state takes one factorization, and a path has a few states.
  model_.workspace().cholesky.order_quickly();
}

std::optional<FineEquilibria::Found> FineEquilibria::find(const CellPath& coarse, const FreeStrains& free,
                                                          const Execution& execution) {
  Eigen::VectorXd x = prolonged(coarse.x());
  const CellScene::Contact contact = model_.contact() ? coarse.contact() : CellScene::Contact{};
  set_contact(contact);
  if (const auto response = correct(x, free, execution)) return Found{*response, true};
  return settle(std::move(x), free, contact, execution);
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

std::optional<PatchResponse> FineEquilibria::correct(const Eigen::VectorXd& x, const FreeStrains& free,
                                                     const Execution& execution) {
  CellSystem system = cell_system(model_, x, free, execution);
  system.look_around();
  numerics::ShiftedCholesky& cholesky = model_.workspace().cholesky;
  cholesky.stop_with(execution.cancellation);
  system.evaluate(2);
  if (!std::isfinite(system.energy())) return std::nullopt;
  const auto linearized = Linearized::at(system, cholesky);
  if (!linearized) return std::nullopt;
  Step step = linearized->step();
  const Steps& steps = options_.tangents ? for_tangents : for_stresses;
  const double first = step.decrease;
  double before = first;
  for (int k = 0; k < steps.max_number; ++k) {
    Eigen::VectorXd change(step.core.size() + step.free.size());
    change << step.core, step.free;
    const CellState from = system.state();
    const CellState to = model_.state(from.x + system.expand(change));
    if (system.look_ahead(from, to) < 1) return std::nullopt;
    system.set_state(to);
    system.look_around();
    system.evaluate(1);
    if (!std::isfinite(system.energy())) return std::nullopt;
    step = linearized->step();
    if (step.decrease <= steps.converged_share * first || step.forces <= model_.elastic().force_rounding()) {
      PatchResponse response;
      response.deformation_gradient =
          model_.coordinates().deformation_gradient(system.state().x) +
          (Eigen::Matrix2d() << step.strain[0], step.strain[1], step.strain[2], step.strain[3]).finished();
      response.strain_gradient = step.strain_gradient;
      response.energy = system.energy() - step.decrease / 2;
      if (options_.tangents) {
        system.evaluate(2);
        std::optional<Eigen::Matrix4d> condensed = linearized->condensed_here();
        if (!condensed) {
          const auto here = Linearized::at(system, cholesky);
          if (!here) return std::nullopt;
          condensed = here->condensed();
        }
        response.condensed = *condensed;
      }
      return response;
    }
    if (step.decrease > before) return std::nullopt;
    before = step.decrease;
  }
  return std::nullopt;
}

std::optional<FineEquilibria::Found> FineEquilibria::settle(Eigen::VectorXd x, const FreeStrains& free,
                                                            const CellScene::Contact& contact,
                                                            const Execution& execution) {
  model_.reset_contact();
  CellPath path(model_, std::move(x), free, options_, execution);
  if (model_.contact()) path.start_with_contact(contact);
  if (!path.settle() || !path.stable()) return std::nullopt;
  const CellEquilibrium& at = path.equilibrium();
  return Found{{model_.coordinates().deformation_gradient(path.x()), at.strain_gradient, at.condensed, at.energy},
               path.take_counts().branches_left == 0};
}

}  // namespace supple::microscale
