#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "supple/numerics/objective.h"
#include "supple/numerics/system.h"

namespace supple::numerics {

/// Both triangles of all parts.
inline Eigen::MatrixXd dense(const BorderedMatrix& matrix) {
  const Eigen::Index n = matrix.core.rows();
  const Eigen::Index m = matrix.corner.rows();
  Eigen::MatrixXd all(n + m, n + m);
  all << Eigen::MatrixXd(matrix.core).selfadjointView<Eigen::Lower>().toDenseMatrix(), matrix.border,
      matrix.border.transpose(), matrix.corner;
  if (matrix.low_rank.size() > 0) all += matrix.low_rank * matrix.low_rank.transpose();
  return all;
}

/// Functions of a vector, summed up.
using VectorSystem = System<VectorState>;
inline VectorSystem system_of(Eigen::VectorXd x, VectorSystem::Terms terms, CostLedger* cost = nullptr) {
  Unknowns all(x.size());
  return {VectorState{std::move(x)}, std::move(terms), std::move(all), {.execution = {.cost = cost}}};
}
template <class T>
VectorSystem system_of(Eigen::VectorXd x, CostLedger* cost = nullptr) {
  return system_of(std::move(x), {std::make_shared<T>()}, cost);
}

/// The check of one function at x. Inlined, it would have GCC 12 at -O1 warn of a vector without a value that has one.
template <class T>
[[gnu::noinline]] DerivativeCheck check_function(T function, const Eigen::VectorXd& x,
                                                 const DerivativeCheckOptions& options = {}) {
  return check_derivatives<VectorState>(function, VectorState{x}, options);
}

/// (1 - x0)^2 + 100 (x1 - x0^2)^2, minimum 0 at (1, 1).
class Rosenbrock : public Term<VectorState> {
 public:
  std::string_view name() const override { return "rosenbrock"; }
  void add(const VectorState& state, int order, EnergySum& sum) const override {
    const Eigen::VectorXd& x = state.x;
    const double a = 1 - x[0];
    const double b = x[1] - x[0] * x[0];
    sum.value += a * a + 100 * b * b;
    if (order >= 1) sum.gradient += Eigen::Vector2d(-2 * a - 400 * x[0] * b, 200 * b);
    if (order < 2) return;
    sum.hessian.add(0, 0, 2 - 400 * b + 800 * x[0] * x[0]);
    sum.hessian.add(0, 1, -400 * x[0]);
    sum.hessian.add(1, 1, 200);
  }
};

/// (x0^2 - 1)^2 + x1^2: two minima, and a negative curvature along x0 between them.
class DoubleWell : public Term<VectorState> {
 public:
  std::string_view name() const override { return "double_well"; }
  void add(const VectorState& state, int order, EnergySum& sum) const override {
    const Eigen::VectorXd& x = state.x;
    const double a = x[0] * x[0] - 1;
    sum.value += a * a + x[1] * x[1];
    if (order >= 1) sum.gradient += Eigen::Vector2d(4 * x[0] * a, 2 * x[1]);
    if (order < 2) return;
    sum.hessian.add(0, 0, 12 * x[0] * x[0] - 4);
    sum.hessian.add(1, 1, 2);
  }
};

/// -log x0 + x0, defined for x0 > 0 only, which it reports as its largest step.
class LogBarrier : public Term<VectorState> {
 public:
  std::string_view name() const override { return "log_barrier"; }
  void add(const VectorState& state, int order, EnergySum& sum) const override {
    const Eigen::VectorXd& x = state.x;
    sum.value += x[0] > 0 ? x[0] - std::log(x[0]) : std::numeric_limits<double>::infinity();
    if (order >= 1) sum.gradient[0] += 1 - 1 / x[0];
    if (order >= 2) sum.hessian.add(0, 0, 1 / (x[0] * x[0]));
  }
  double largest_step(const VectorState& state, const Eigen::VectorXd& step) const override {
    return step[0] < 0 ? -0.9 * state.x[0] / step[0] : std::numeric_limits<double>::infinity();
  }
};

/// A chain of springs of rest length 0 and unequal stiffness between neighbours, each node also tied to its own target:
/// a quadratic with a tridiagonal Hessian.
class SpringChain : public Term<VectorState> {
 public:
  std::string_view name() const override { return "spring_chain"; }
  void add(const VectorState& state, int order, EnergySum& sum) const override {
    const Eigen::VectorXd& x = state.x;
    const int n = static_cast<int>(x.size());
    for (int i = 0; i < n; ++i) {
      const double d = x[i] - std::sin(i);
      sum.value += 0.5 * d * d;
      if (order >= 1) sum.gradient[i] += d;
      if (order >= 2) sum.hessian.add(i, i, 1);
    }
    for (int i = 0; i + 1 < n; ++i) {
      const double k = 1 + i % 7;
      const double d = x[i + 1] - x[i];
      sum.value += 0.5 * k * d * d;
      if (order >= 1) {
        sum.gradient[i] -= k * d;
        sum.gradient[i + 1] += k * d;
      }
      if (order < 2) continue;
      sum.hessian.add(i, i, k);
      sum.hessian.add(i + 1, i + 1, k);
      sum.hessian.add(i, i + 1, -k);
    }
  }
};

/// x^T A x / 2 on the unit sphere in three dimensions; minima at the eigenvectors of A's least eigenvalue. The frame of
/// a state is carried along with it, so transport leaves coordinates as they are.
class RayleighQuotient : public Objective {
 public:
  RayleighQuotient(Eigen::Matrix3d a, const Eigen::Vector3d& x) : a_(std::move(a)) {
    x_.col(0) = x.normalized();
    x_.col(1) = x_.col(0).unitOrthogonal();
    x_.col(2) = Eigen::Vector3d(x_.col(0)).cross(Eigen::Vector3d(x_.col(1)));
    trial_ = x_;
  }

  Eigen::Vector3d x() const { return x_.col(0); }
  Eigen::Index dimension() const override { return 2; }

  Evaluation evaluate(int order) override {
    const Eigen::Vector3d p = trial_.col(0);
    const auto frame = trial_.rightCols<2>();
    Evaluation e;
    e.value = 0.5 * p.dot(a_ * p);
    if (order >= 1) e.gradient = frame.transpose() * a_ * p;
    if (order >= 2)
      e.hessian = Eigen::MatrixXd(frame.transpose() * a_ * frame - p.dot(a_ * p) * Eigen::Matrix2d::Identity());
    return e;
  }

  Eigen::VectorXd move(const Eigen::VectorXd& step) override {
    const Eigen::Vector3d tangent = x_.rightCols<2>() * step;
    const double length = tangent.norm();
    trial_ = length > 0
                 ? Eigen::Matrix3d(Eigen::AngleAxisd(length, Eigen::Vector3d(x_.col(0)).cross(tangent) / length) * x_)
                 : x_;
    return step;
  }
  void accept() override { x_ = trial_; }
  void reject() override { trial_ = x_; }

 private:
  Eigen::Matrix3d a_;
  Eigen::Matrix3d x_;  ///< column 0 the point, columns 1 and 2 the frame of its tangent plane
  Eigen::Matrix3d trial_;
};

}  // namespace supple::numerics
