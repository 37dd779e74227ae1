#include "supple/neural/uniaxial.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <string>

#include "supple/base/error.h"

namespace supple::neural {
namespace {

/// Largest change of E_dd in one step; longer ones are divided, so that the branch that goes through rest is followed.
constexpr double longest_step = 0.1;
/// Largest change of a free strain in one Newton iteration.
constexpr double longest_correction = 0.2;
/// What suffices on the way to a state.
constexpr double tolerance_between = 1e-3;
/// Share of the decrease that the gradient promises which a step has to bring.
constexpr double sufficient_decrease = 1e-4;
/// The scale of forces is at least this share of stiffness times strain.
constexpr double least_force_share = 1e-3;

Eigen::Matrix3d symmetric(const Eigen::Matrix<double, 6, 1>& c) {
  Eigen::Matrix3d m;
  m << c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5];
  return m;
}

/// Energy, stress and tangent at one strain.
struct Local {
  double energy = 0;
  Eigen::Vector3d stress = Eigen::Vector3d::Zero();
  Eigen::Matrix3d tangent = Eigen::Matrix3d::Zero();
  bool finite() const { return std::isfinite(energy) && stress.allFinite() && tangent.allFinite(); }
};

template <class Real>
class Path {
 public:
  Path(const BasicEvaluator<Real>& evaluator, const typename BasicEvaluator<Real>::Design& design, double direction,
       const UniaxialOptions& options)
      : evaluator_(evaluator), design_(design), options_(options) {
    const double c = std::cos(direction);
    const double s = std::sin(direction);
    along_ << c * c, s * s, 2 * c * s;
    free_.col(0) << s * s, c * c, -2 * c * s;
    free_.col(1) << -c * s, c * s, c * c - s * s;
    local_ = at(strain());
  }

  UniaxialState advance(double target) {
    UniaxialState state;
    const int steps = std::max(1, static_cast<int>(std::ceil(std::abs(target - given_) / longest_step - 1e-9)));
    const double first = given_;
    bool reached = true;
    for (int step = 1; step <= steps && reached; ++step) {
      predict(first + (target - first) * step / steps);
      reached = correct(step == steps ? options_.tolerance : tolerance_between, state);
    }
    state.strain = strain();
    state.stress = local_.stress;
    state.directional_stress = directional(local_.stress);
    state.energy_density = local_.energy;
    state.converged = reached;
    return state;
  }

 private:
  Eigen::Vector3d strain() const { return along_ * given_ + free_ * x_; }
  /// d^T S d: in it S_xy counts twice, as 2 E_xy does in `along_`.
  double directional(const Eigen::Vector3d& stress) const { return along_.dot(stress); }

  Local at(const Eigen::Vector3d& e) {
    evaluator_.evaluate(design_, e, Order::tangent, workspace_, evaluation_);
    return {evaluation_.energy_density[0], evaluation_.stress.col(0), symmetric(evaluation_.tangent.col(0))};
  }

  /// Follows the tangent of the path to another given strain.
  void predict(double given) {
    const Eigen::Matrix2d h = free_.transpose() * local_.tangent * free_;
    const Eigen::Vector2d rate = -convex_solve(h, free_.transpose() * local_.tangent * along_);
    const double change = given - given_;
    Eigen::Vector2d step = rate * change;
    const double limit = longest_correction;
    if (step.norm() > limit) step *= limit / step.norm();
    given_ = given;
    x_ += step;
    local_ = at(strain());
  }

  /// |H|^-1 b: eigenvalues by their absolute value, none below a share of the largest.
  static Eigen::Vector2d convex_solve(const Eigen::Matrix2d& h, const Eigen::Vector2d& b) {
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(h);
    Eigen::Vector2d values = eigen.eigenvalues().cwiseAbs();
    values = values.cwiseMax(std::max(1e-8 * values.maxCoeff(), 1e-30));
    return eigen.eigenvectors() * (eigen.eigenvectors().transpose() * b).cwiseQuotient(values);
  }

  bool correct(double tolerance, UniaxialState& state) {
    for (int iteration = 0;; ++iteration) {
      const Eigen::Vector2d gradient = free_.transpose() * local_.stress;
      const double scale =
          std::max({local_.stress.norm(), least_force_share * local_.tangent.norm() * strain().norm(), 1e-300});
      state.residual = gradient.norm() / scale;
      if (!local_.finite()) return false;
      if (state.residual <= tolerance) return true;
      if (iteration == options_.max_iterations) return false;
      ++state.iterations;
      Eigen::Vector2d step = -convex_solve(free_.transpose() * local_.tangent * free_, gradient);
      if (step.norm() > longest_correction) step *= longest_correction / step.norm();
      if (!search(step, gradient)) return false;
    }
  }

  /// Halves the step until the energy, or near the end (where energies differ by rounding alone) the gradient, falls.
  bool search(Eigen::Vector2d step, const Eigen::Vector2d& gradient) {
    const Eigen::Vector2d start = x_;
    const Local before = local_;
    for (int halving = 0; halving < 40; ++halving, step /= 2) {
      x_ = start + step;
      local_ = at(strain());
      if (!local_.finite()) continue;
      const double rounding = 1e-14 * std::abs(before.energy);
      const bool energy_falls = local_.energy <= before.energy + sufficient_decrease * step.dot(gradient);
      const bool gradient_falls = local_.energy <= before.energy + rounding &&
                                  (free_.transpose() * local_.stress).norm() < 0.5 * gradient.norm();
      if (energy_falls || gradient_falls) return true;
    }
    x_ = start;
    local_ = before;
    return false;
  }

  const BasicEvaluator<Real>& evaluator_;
  const typename BasicEvaluator<Real>::Design& design_;
  UniaxialOptions options_;
  typename BasicEvaluator<Real>::Workspace workspace_;
  Evaluation evaluation_;
  Eigen::Vector3d along_;             ///< (E_xx, E_yy, 2 E_xy) of d d^T
  Eigen::Matrix<double, 3, 2> free_;  ///< of n n^T, and of the shear between d and n
  double given_ = 0;                  ///< E_dd
  Eigen::Vector2d x_ = Eigen::Vector2d::Zero();
  Local local_;
};

}  // namespace

template <class Real>
std::vector<UniaxialState> uniaxial_path(const BasicEvaluator<Real>& evaluator,
                                         const typename BasicEvaluator<Real>::Design& design, double direction,
                                         std::span<const double> green_strains, const UniaxialOptions& options,
                                         const Execution& execution) {
  for (std::size_t i = 0; i < green_strains.size(); ++i)
    if (!(green_strains[i] > -0.5) || !std::isfinite(green_strains[i]))
      throw Error("model.invalid_load", "A Green strain along the load must be above -0.5, where the length vanishes.",
                  {{"green_strains/" + std::to_string(i), "> -0.5, got " + std::to_string(green_strains[i])}});
  Path<Real> path(evaluator, design, direction, options);
  std::vector<UniaxialState> states;
  states.reserve(green_strains.size());
  for (const double strain : green_strains) {
    execution.checkpoint(static_cast<double>(states.size()) / static_cast<double>(green_strains.size()), "equilibrium");
    states.push_back(path.advance(strain));
  }
  return states;
}

template std::vector<UniaxialState> uniaxial_path(const BasicEvaluator<double>&, const BasicEvaluator<double>::Design&,
                                                  double, std::span<const double>, const UniaxialOptions&,
                                                  const Execution&);
template std::vector<UniaxialState> uniaxial_path(const BasicEvaluator<float>&, const BasicEvaluator<float>::Design&,
                                                  double, std::span<const double>, const UniaxialOptions&,
                                                  const Execution&);

}  // namespace supple::neural
